"""PX4: modes, parameters, streams, events, texts, and how it flies setpoints."""
