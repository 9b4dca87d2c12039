"""Real receivers on a vehicle, each behind `receiver.Receiver`; imports nothing of the experiments."""
