"""The start of every program: how it ends by Ctrl-C is settled before anything is imported that takes time."""

import sys
from importlib import import_module

from link.program.interrupts import EndingAtOnce, take_interrupts


def start(name: str, module: str) -> None:
    """Run a program and end this process with its exit code.

    Args:
        name: the program's.
        module: holds its `app`.
    """
    take_interrupts(name)
    with EndingAtOnce():
        from link.program.cli import run_app  # noqa: PLC0415 (after it is settled)

        app = import_module(module).app
    sys.exit(run_app(name, app))
