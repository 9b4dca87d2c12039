"""Two checkouts flown in turn: how many times as fast this one is as another, and whether they fly the same.

What counts is processor time, of landings with the same seed, one right after the other. Which is first changes from
pair to pair. How a process lies in memory makes up to a tenth, so each has new processes after a few pairs.
"""

import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any, Final

from link.errors import UserError

HERE: Final = Path(__file__).parents[2]
_TIMER = Path(__file__).with_name("flight_timer.py")
_PAIRS_A_PROCESS = 3
_PAIRS_MIN = 6
"""Fewer have no 95 % interval of their median."""
_LEVEL = 0.95


@dataclass(frozen=True, slots=True, kw_only=True)
class Pair:
    """One seed flown on both.

    Attributes:
        seed: of everything random.
        cpu_s: processor time there and here.
        simulated_s: how long the runs were, there and here.
        is_same: whether the drone flew the same way to the last bit.
    """

    seed: int
    cpu_s: tuple[float, float]
    simulated_s: tuple[float, float]
    is_same: bool

    @property
    def ratio(self) -> float:
        """How many times as fast a simulated second is here as there."""
        there, here = (cpu_s / max(run_s, 1e-9) for cpu_s, run_s in zip(self.cpu_s, self.simulated_s, strict=True))
        return there / here


def check_pairs(there: Path, pairs: int) -> None:
    """Find out whether `there` can be flown against, so many times.

    Raises:
        UserError: it is no checkout, or the pairs are too few.
    """
    if not (there / "scenarios" / "lockstep" / "lockstep.py").is_file():
        raise UserError(f"--against {there} is no checkout of decklander: name the folder that has scenarios/ in it")
    if pairs < _PAIRS_MIN:
        raise UserError(f"--pairs {pairs} tells nothing: give {_PAIRS_MIN} or more")


def fly_pairs(there: Path, name: str, seeds: Sequence[int], announce: Callable[[str], None]) -> list[Pair]:
    """Fly the scenario with each seed on `there` and here.

    Args:
        there: the other checkout; this program's Python and libraries run both.
        name: of a scenario, or its file.
        seeds: of the pairs.
        announce: told before each pair.

    Raises:
        UserError: one of the two cannot fly it.
    """
    if Path(name).is_file():
        name = str(Path(name).resolve())
    found: list[Pair] = []
    for first in range(0, len(seeds), _PAIRS_A_PROCESS):
        with _timer(there.resolve(), name) as old, _timer(HERE, name) as new:
            for seed in seeds[first : first + _PAIRS_A_PROCESS]:
                announce(f"pair {len(found) + 1} of {len(seeds)}")
                found.append(_pair(old, new, seed, new_first=len(found) % 2 == 1))
    return found


def _pair(old: "_Timer", new: "_Timer", seed: int, *, new_first: bool) -> Pair:
    if new_first:
        here, before = new.fly(seed), old.fly(seed)
    else:
        before, here = old.fly(seed), new.fly(seed)
    return Pair(
        seed=seed,
        cpu_s=(before["cpu_s"], here["cpu_s"]),
        simulated_s=(before["simulated_s"], here["simulated_s"]),
        is_same=before["digest"] == here["digest"],
    )


class _Timer:
    """A process that flies on the sources of one checkout."""

    def __init__(self, process: "subprocess.Popen[str]", tree: Path) -> None:
        self._process, self._tree = process, tree

    def fly(self, seed: int) -> dict[str, Any]:
        """Return what a landing took, as `flight_timer` tells it."""
        if self._process.stdin is None or self._process.stdout is None:
            raise ValueError("the process has no pipes")
        try:
            self._process.stdin.write(f"{seed}\n")
            self._process.stdin.flush()
        except BrokenPipeError:
            raise self._failed() from None
        line = self._process.stdout.readline()
        if not line:
            raise self._failed()
        return dict(json.loads(line))

    def _failed(self) -> UserError:
        said = self._process.communicate()[1].strip().splitlines()
        return UserError(f"{self._tree} cannot fly it: {said[-1] if said else 'its process ended'}")


@contextmanager
def _timer(tree: Path, name: str) -> Iterator[_Timer]:
    environment = {**os.environ, "PYTHONPATH": str(tree), "PYTHONHASHSEED": "0"}
    command = (sys.executable, "-P", str(_TIMER), name)
    pipe = subprocess.PIPE
    with subprocess.Popen(command, cwd=tree, env=environment, stdin=pipe, stdout=pipe, stderr=pipe, text=True) as one:
        try:
            yield _Timer(one, tree)
        finally:
            one.kill()


def against_table(there: Path, name: str, pairs: Sequence[Pair]) -> dict[str, Any]:
    """Return the pairs as `scenarios bench --against --json` prints them, with the median's interval.

    Source of the interval: order statistics, David and Nagaraja 2003, 7.1.
    """
    from scipy import stats  # noqa: PLC0415 (0.5 s, which the bench's other figures need not wait for)

    ratios = sorted(pair.ratio for pair in pairs)
    rank = int(
        stats.binom.ppf(0.5 * (1.0 - _LEVEL), len(ratios), 0.5)
    )  # below it, from either end, the median seldom is
    return {
        "scenario": name,
        "against": str(there),
        "times_as_fast": round(median(ratios), 4),
        "interval_95": [round(ratios[rank - 1], 4), round(ratios[-rank], 4)],
        "cpu_s": [round(median(pair.cpu_s[side] for pair in pairs), 3) for side in (0, 1)],
        "pairs": len(pairs),
        "same_flights": sum(pair.is_same for pair in pairs),
    }


def against_lines(table: dict[str, Any]) -> list[str]:
    """Return the table as lines for people."""
    low, high = table["interval_95"]
    before_s, now_s = table["cpu_s"]
    return [
        f"{table['scenario']}, {table['pairs']} pairs against {table['against']}",
        f"  {table['times_as_fast']:.3f} times as fast ({low:.3f} to {high:.3f}), by processor time a simulated second",
        f"  {before_s:.2f} s there, {now_s:.2f} s here, median of a landing",
        f"  the same flight to the last bit: {table['same_flights']} of {table['pairs']}",
    ]
