"""What every program needs around its loop: options, configuration, clocks, a terminal, a service manager."""
