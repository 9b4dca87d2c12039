"""A campaign's progress on a terminal: a bar with the estimated time left and the tiers so far; nothing elsewhere."""

import sys
from collections import Counter
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from scenarios.campaigns.landing_task import Flown
from scenarios.scoring.score import Tier

_ESTIMATED_OVER_S = 120.0


class CampaignProgress:
    """Shows progress on stderr while it is entered."""

    def __init__(self) -> None:
        self._tiers: Counter[str] = Counter()
        self._bar = Progress(
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[tiers]}"),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            console=Console(stderr=True),
            speed_estimate_period=_ESTIMATED_OVER_S,
            disable=not sys.stderr.isatty(),
            transient=True,
        )
        self._task = self._bar.add_task("landings", total=None, tiers="")

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()

    def update(self, flown: Flown | None, done: int, total: int) -> None:
        """Show that `done` of `total` landings are done, `flown` the newest."""
        if flown is None:
            self._bar.reset(self._task, total=total, completed=done)
            return
        self._tiers[flown.row.get("tier") or "error"] += 1
        tiers = " ".join(f"{name} {self._tiers[name]}" for name in _ORDER if self._tiers[name])
        self._bar.update(self._task, completed=done, tiers=tiers)


_ORDER = (*(tier.value for tier in Tier), "error")
