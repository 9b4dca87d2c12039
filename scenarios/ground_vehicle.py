"""Starts `ground-vehicle`."""

from link.program.start import start


def main() -> None:
    """Run the command."""
    start("ground-vehicle", "scenarios.commands.ground_vehicle")


if __name__ == "__main__":
    main()
