"""Starts `scenarios`."""

import signal

from link.program.interrupts import interrupt
from link.program.start import start


def main() -> None:
    """Run the command; SIGTERM ends it as Ctrl-C does, with all that it has started."""
    signal.signal(signal.SIGTERM, interrupt)
    start("scenarios", "scenarios.app")


if __name__ == "__main__":
    main()
