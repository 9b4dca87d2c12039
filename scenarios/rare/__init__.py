"""How probable an unsafe outcome is, where plain campaigns would have to fly too long to see one."""
