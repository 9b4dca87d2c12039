"""The subcommands of `scenarios`."""
