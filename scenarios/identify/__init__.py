"""How an autopilot follows setpoints: manoeuvres flown, measured, and fitted by a model."""
