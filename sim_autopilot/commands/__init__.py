"""What each incoming message changes, and how it is answered."""
