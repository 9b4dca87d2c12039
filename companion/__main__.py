"""Starts `companion`."""

from link.program.start import start


def main() -> None:
    """Run the command."""
    start("companion", "companion.app")


if __name__ == "__main__":
    main()
