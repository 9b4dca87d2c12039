"""Starts `pad-detector`."""

from link.program.start import start


def main() -> None:
    """Run the command."""
    start("pad-detector", "companion.eyes.app")


if __name__ == "__main__":
    main()
