"""What the phases of a sortie wait for and fly."""
