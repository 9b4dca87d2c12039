"""The autopilot firmwares that can be stood in for, each as data."""
