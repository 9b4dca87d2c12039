"""The autopilot firmwares that can be stood in for, a folder each."""
