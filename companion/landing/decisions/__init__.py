"""What each phase waits for, and what it breaks off on."""
