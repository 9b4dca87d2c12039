"""Where a run's processor time goes: the interpreter is looked at after each millisecond that it has computed.

A sample belongs to the innermost of this project's functions under way, and so to its package: what a library does is
counted to who called it. It costs the run about nothing; the shares are as good as the number of samples.
"""

import signal
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import FrameType

_PERIOD_S = 0.001  # of processor time; the system may look less often
_ROOT = Path(__file__).resolve().parents[2]
_PACKAGES = frozenset({"companion", "link", "scenarios", "sim_autopilot"})
_DIGITS = 3


@contextmanager
def sampled_parts() -> Iterator[Counter[str]]:
    """Count, inside the block, how often each package was at work; only a main thread can."""
    counts: Counter[str] = Counter()

    def look(_signal: int, frame: FrameType | None) -> None:
        counts[_part_of(frame)] += 1

    before = signal.signal(signal.SIGPROF, look)
    signal.setitimer(signal.ITIMER_PROF, _PERIOD_S, _PERIOD_S)
    try:
        yield counts
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)


def shares_of(counts: Counter[str]) -> dict[str, float]:
    """Return the share of each part, the largest first."""
    total = max(counts.total(), 1)
    return {part: round(count / total, _DIGITS) for part, count in counts.most_common()}


def _part_of(frame: FrameType | None) -> str:
    """Return the package of the innermost function of the project, as `companion.planning`."""
    while frame is not None:
        part = _package_of(frame.f_code.co_filename)
        if part is not None:
            return part
        frame = frame.f_back
    return "other"


@cache
def _package_of(file: str) -> str | None:
    path = Path(file)
    folder = path.relative_to(_ROOT).parts[:-1] if path.is_relative_to(_ROOT) else ()
    return ".".join(folder) if folder and folder[0] in _PACKAGES else None
