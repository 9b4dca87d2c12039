"""What only answers a ground station: files, logs, plans, calibration, shell. The stand-in flies without it, too."""
