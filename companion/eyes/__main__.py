"""Starts `pad-detector`."""

import os

from companion.eyes.sources import PIXELS_MAX
from link.program.start import start


def main() -> None:
    """Run the command."""
    os.environ.setdefault("OPENCV_IO_MAX_IMAGE_PIXELS", str(PIXELS_MAX))  # it is read as OpenCV is loaded
    start("pad-detector", "companion.eyes.app")


if __name__ == "__main__":
    main()
