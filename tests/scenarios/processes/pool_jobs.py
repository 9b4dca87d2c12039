"""Jobs for the pool's processes, which import them from here."""

import os
import signal
from dataclasses import dataclass
from pathlib import Path
from threading import Event
from typing import Any

from link.errors import UserError


@dataclass(frozen=True, slots=True, kw_only=True)
class Doubling:
    """Doubles a number; some numbers end the process, `once` only the first time."""

    deadly: frozenset[int] = frozenset()
    once: Path | None = None
    refused: int | None = None

    def __call__(self, number: int) -> int:
        if number == self.refused:
            raise UserError(f"{number} is refused")
        if number in self.deadly and not self._has_died(number):
            os.kill(os.getpid(), signal.SIGKILL)
        return 2 * number

    def _has_died(self, number: int) -> bool:
        if self.once is None:
            return False
        marker = self.once / str(number)
        has_died = marker.exists()
        marker.touch()
        return has_died


def threads_and_signals(_: int) -> tuple[str | None, bool]:
    """Return how many threads the process calculates on and whether Ctrl-C is kept from it."""
    return os.environ.get("OPENBLAS_NUM_THREADS"), signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, ())


def interrupt_and_stay(_: int) -> int:
    """Interrupt the process that waits for this one, and never be done."""
    os.kill(os.getppid(), signal.SIGINT)
    Event().wait()
    return 0


class Unloadable:
    """A job that a process cannot load."""

    def __call__(self, number: int) -> int:
        return number

    def __reduce__(self) -> tuple[Any, ...]:
        return os._exit, (3,)
