"""A falsification's progress on a terminal: a bar with the least margin so far; nothing elsewhere."""

import sys
from types import TracebackType
from typing import TYPE_CHECKING, Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

if TYPE_CHECKING:
    from scenarios.falsify.trial import Outcome


class FalsifyProgress:
    """Shows progress on stderr while it is entered.

    Args:
        landings: of the search.
        reduction: landings of the reduction.
    """

    def __init__(self, landings: int, reduction: int) -> None:
        self._least: float | None = None
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[least]}"),
            TimeElapsedColumn(),
            console=Console(stderr=True),
            disable=not sys.stderr.isatty(),
            transient=True,
        )
        self._search = self._bar.add_task("search", total=landings, least="")
        self._reduction = self._bar.add_task("reduction", total=reduction, least="", start=False)

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()

    def update(self, part: str, outcome: "Outcome") -> None:
        """Show a landing that was flown for `part`."""
        if part != "search":
            self._bar.start_task(self._reduction)
            self._bar.update(self._reduction, advance=1, least=part)
            return
        margins = [one for one in (self._least, outcome.margin) if one is not None]
        self._least = min(margins, default=None)
        self._bar.update(
            self._search, advance=1, least="" if self._least is None else f"least margin {self._least:.3f}"
        )
