"""ArduCopter: modes, parameters, streams, failsafes, texts, and how it flies setpoints."""
