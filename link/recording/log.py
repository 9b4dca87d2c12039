"""The log of a program that flies: lines go to standard output from a thread of their own.

A terminal that is stopped, a pipe that nobody reads and a full disk cost lines, and never time or an error of the loop.
"""

import sys
from typing import TextIO

import structlog

from link.program.text import printable
from link.recording.recorder import BackgroundRecorder

_CAPACITY = 1000  # lines


class Log:
    """Writes lines as structlog lays them out; close it to have the last of them written.

    Args:
        name: of the program.
        file: where to, standard output by default.
    """

    def __init__(self, name: str, file: TextIO | None = None) -> None:
        self._recorder = BackgroundRecorder(_Lines(sys.stdout if file is None else file), capacity=_CAPACITY)
        self._log = structlog.wrap_logger(_Printer(self._recorder), logger_name=name)

    @property
    def lost(self) -> int:
        """How many lines were not written."""
        return self._recorder.dropped

    def info(self, event: str, **values: object) -> None:
        """Say what happens."""
        self._log.info(event, **_shown(values))

    def warning(self, event: str, **values: object) -> None:
        """Say what is not as it should be."""
        self._log.warning(event, **_shown(values))

    def close(self) -> None:
        """Write what waits, as far as it is taken soon."""
        self._recorder.close()


def _shown(values: dict[str, object]) -> dict[str, object]:
    return {name: printable(value) if isinstance(value, str) else value for name, value in values.items()}


class _Printer:
    """What structlog hands its lines to."""

    def __init__(self, recorder: BackgroundRecorder) -> None:
        self.info = self.warning = recorder.put


class _Lines:
    def __init__(self, file: TextIO) -> None:
        self._file = file

    def write(self, record: str) -> None:
        """Write a line."""
        self._file.write(f"{record}\n")
        self._file.flush()

    def close(self) -> None:
        """Leave the file open: it is the program's."""
