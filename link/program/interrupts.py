"""Ctrl-C as a program takes it: as a KeyboardInterrupt, or as the end at once where one would not get through.

Imports and numba's compiler catch what is raised within them, so that a KeyboardInterrupt is lost there or becomes
another error; so does machine code whose result numba makes a Python value. There the process ends instead: whatever
it has written can be read however far it came.

This is what a program imports first, so it imports nothing that takes time itself.
"""

import os
import signal
import sys
from types import FrameType, TracebackType

from link.program.exit_codes import EXIT_INTERRUPTED

COMPILING = "compiling the numerics, as after an installation or an update; this takes a minute or two"
_BOXING = "_numba_unpickle"  # of numba.core.serialize


class _Process:
    """What this process is in.

    Attributes:
        blocks: that no KeyboardInterrupt gets through.
        program: its name, until it has told that it compiles; empty in what is no program, such as a notebook.
    """

    blocks = 0
    program = ""


class EndingAtOnce:
    """A `with` block in which Ctrl-C ends the process."""

    def __enter__(self) -> None:
        _Process.blocks += 1

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        _Process.blocks -= 1


def take_interrupts(program: str) -> None:
    """Let Ctrl-C act as described above from now on, unless who started this process lets it ignore that.

    Args:
        program: its name, which begins the line that says that the numerics are compiled; empty for none.
    """
    _Process.program = program
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, interrupt)


def interrupt(_number: int, frame: FrameType | None) -> None:
    """Handle a signal as described above.

    Raises:
        KeyboardInterrupt: where one gets through.
    """
    if _Process.blocks or _is_boxing(frame):
        os._exit(EXIT_INTERRUPTED)
    raise KeyboardInterrupt


def _is_boxing(frame: FrameType | None) -> bool:
    """Return whether numba makes a Python value of a kernel's result, and would not notice that this raised."""
    while frame is not None and frame.f_code.co_name != _BOXING:
        frame = frame.f_back
    return frame is not None


def begin_compiling() -> None:
    """Let Ctrl-C end the process until `end_compiling`, and tell once on stderr what a program's user waits for."""
    _Process.blocks += 1
    program, _Process.program = _Process.program, ""
    if program and sys.stderr is not None:
        try:
            sys.stderr.write(f"{program}: {COMPILING}\n")
        except OSError:  # whoever listened has gone
            return


def end_compiling() -> None:
    """Take Ctrl-C as before the last `begin_compiling`."""
    _Process.blocks -= 1
