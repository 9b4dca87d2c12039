"""The sensors of the simulated vehicle and drone, with their noise, loss and delay."""
