"""The start of every program: how it ends by Ctrl-C is settled before anything is imported that takes time.

So is on how many threads its matrices are calculated, which the libraries read as they are loaded. Matrices as small as
ours gain nothing by a second one, and wait for it where the cores are busy: the plan's matrices, which a gain that the
autopilot changes has made anew, took 0.02 to 0.3 s on two busy cores, and 5 to 60 ms on one thread.
"""

import atexit
import os
import sys
from importlib import import_module

from link.program.exit_codes import EXIT_INTERRUPTED
from link.program.interrupts import EndingAtOnce, take_interrupts
from link.program.standard_files import open_standard_files

ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Environment of a process that calculates its matrices on one thread."""


def start(name: str, module: str) -> None:
    """Run a program and end this process with its exit code.

    Args:
        name: the program's.
        module: holds its `app`.
    """
    open_standard_files()
    take_interrupts(name)
    for variable, count in ONE_THREAD.items():
        os.environ.setdefault(variable, count)
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
