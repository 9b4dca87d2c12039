"""The landing: which phase follows, what each waits for, and what it flies."""
