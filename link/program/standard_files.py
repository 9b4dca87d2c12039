"""The three files that every program is started with, opened where whoever started it has closed them."""

import os
import sys

_NAMES = ("stdin", "stdout", "stderr")


def open_standard_files() -> None:
    """Open those that are closed as the null device.

    Otherwise the next device or socket that is opened becomes one of them, and what a library writes to its stderr goes
    to the autopilot.
    """
    for number, name in enumerate(_NAMES):
        if getattr(sys, name) is None:
            opened = os.open(os.devnull, os.O_RDWR)
            if opened != number:
                os.dup2(opened, number)
                os.close(opened)
            setattr(sys, name, os.fdopen(number, "w" if number else "r", encoding="utf-8"))
