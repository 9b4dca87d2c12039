"""Starts `pad-detector`."""

import os

from link.program.start import start

PIXELS_MAX = 1 << 26
"""Of a picture that comes as a file, as many as a raw one may have: OpenCV itself makes a gigabyte of one of 1 MB."""


def main() -> None:
    """Run the command."""
    os.environ.setdefault("OPENCV_IO_MAX_IMAGE_PIXELS", str(PIXELS_MAX))  # it is read as OpenCV is loaded
    start("pad-detector", "companion.eyes.app")


if __name__ == "__main__":
    main()
