"""The start of every program: how it ends by Ctrl-C is settled before anything is imported that takes time."""

import atexit
import os
import sys
from importlib import import_module

from link.program.exit_codes import EXIT_INTERRUPTED
from link.program.interrupts import EndingAtOnce, take_interrupts
from link.program.standard_files import open_standard_files


def start(name: str, module: str) -> None:
    """Run a program and end this process with its exit code.

    Args:
        name: the program's.
        module: holds its `app`.
    """
    open_standard_files()
    take_interrupts(name)
    codes: list[int] = []
    atexit.register(_keep_interrupted, codes)  # the first, so it is called last
    with EndingAtOnce():
        from link.program.cli import run_app  # noqa: PLC0415 (after it is settled)

        app = import_module(module).app
    codes.append(run_app(name, app))
    sys.exit(codes[0])


def _keep_interrupted(codes: list[int]) -> None:
    """End with the code of Ctrl-C: CPython ends by the signal instead when it met `exec`, though that was handled."""
    if codes == [EXIT_INTERRUPTED]:
        try:
            sys.stdout.flush()
        finally:
            os._exit(EXIT_INTERRUPTED)
