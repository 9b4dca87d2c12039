"""A word to the user where a start takes long."""

import sys
import threading
from types import TracebackType
from typing import Self

_AFTER_S = 3.0
PATIENCE = (
    "loading the numerics; after an installation or an update they are compiled first, which takes a minute or two"
)


class Patience:
    """Says on stderr what a program does, when a block takes longer than some seconds.

    Args:
        program: its name.
        doing: what it does.
        after_s: from the beginning of the block.
    """

    def __init__(self, program: str, doing: str = PATIENCE, after_s: float = _AFTER_S) -> None:
        self._timer = threading.Timer(after_s, lambda: sys.stderr.write(f"{program}: {doing}\n"))
        self._timer.daemon = True

    def __enter__(self) -> Self:
        self._timer.start()
        return self

    def end(self) -> None:
        """Say nothing from now on."""
        self._timer.cancel()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.end()
