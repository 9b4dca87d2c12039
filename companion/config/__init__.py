"""What can be set: the keys of the configuration file, each with its unit, bounds and source."""
