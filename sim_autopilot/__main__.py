"""Starts `sim-autopilot`."""

from link.program.start import start


def main() -> None:
    """Run the command."""
    start("sim-autopilot", "sim_autopilot.app")


if __name__ == "__main__":
    main()
