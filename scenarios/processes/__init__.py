"""Programs and workers as processes, none of which is left behind."""
