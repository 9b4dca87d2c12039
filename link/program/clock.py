"""The clocks that loops run on: the system's, the simulator's own, and one that follows the simulator's ticks.

All give UTC in nanoseconds, and all but `DateClock` never go back. Numerics do not see clocks; they get `t_ns` as an
argument.
"""

import gc
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from link.units import NS_PER_S

MonotonicNs = Callable[[], int]

EXTRAPOLATION_MAX_S = 0.05
"""How far in wall time a `SimulatedClock` runs on without a tick; a few periods of a 100 Hz clock."""

_RATE_WINDOW_NS = 500_000_000
_RATE_SPAN_MIN_NS = 20_000_000  # ticks that were queued arrive at once and tell no rate
_RATE_MIN = 0.05
_TICK_GAP_MAX_NS = 5_000_000_000  # a simulator at 50 times real time that is held up for 0.1 s
_STRAYS_CONFIRM = 5


@dataclass(frozen=True, slots=True, kw_only=True)
class ClockTick:
    """What `{ns}/clock` carries: the simulator's UTC time in nanoseconds."""

    t_ns: int


class TickFilter:
    """Tells the simulator's ticks from strays: a tick far from the last one counts when others go on from there.

    So a broken payload does not move the time, and a simulator that is restarted does.
    """

    def __init__(self) -> None:
        self._last_ns: int | None = None
        self._stray_ns = 0
        self._strays = 0

    def accepts(self, t_ns: int) -> bool:
        """Return whether to believe the tick `t_ns`."""
        if self._last_ns is not None and not _follows(t_ns, self._last_ns):
            self._strays = self._strays + 1 if self._strays and _follows(t_ns, self._stray_ns) else 1
            self._stray_ns = t_ns
            if self._strays < _STRAYS_CONFIRM:
                return False
        self._last_ns, self._strays = t_ns, 0
        return True


def _follows(t_ns: int, before_ns: int) -> bool:
    return abs(t_ns - before_ns) <= _TICK_GAP_MAX_NS


class Clock(Protocol):
    """A source of UTC time that may run faster or slower than the wall."""

    def now_ns(self) -> int:
        """Return the present UTC time in nanoseconds."""

    def wall_s(self, duration_s: float) -> float:
        """Return how many seconds of wall time `duration_s` of this clock take."""


class ScaledClock:
    """The simulator's own clock: `epoch_ns` at construction, from then on `speed` times as fast as the wall."""

    def __init__(self, *, speed: float, epoch_ns: int, monotonic_ns: MonotonicNs = time.monotonic_ns) -> None:
        if not 0.0 < speed < float("inf"):
            raise ValueError(f"speed must be finite and above 0, got {speed}")
        self._speed = speed
        self._epoch_ns = epoch_ns
        self._monotonic_ns = monotonic_ns
        self._start_ns = monotonic_ns()

    def now_ns(self) -> int:
        """Return the present UTC time in nanoseconds."""
        return self._epoch_ns + round(self._speed * (self._monotonic_ns() - self._start_ns))

    def wall_s(self, duration_s: float) -> float:
        """Return how many seconds of wall time `duration_s` of this clock take."""
        return duration_s / self._speed


class SystemClock(ScaledClock):
    """The computer's UTC, read once at construction and carried on by the monotonic clock.

    A step of the system time (NTP, an operator) therefore does not reach a flight under way.
    """

    def __init__(
        self, *, utc_ns: Callable[[], int] = time.time_ns, monotonic_ns: MonotonicNs = time.monotonic_ns
    ) -> None:
        super().__init__(speed=1.0, epoch_ns=utc_ns(), monotonic_ns=monotonic_ns)


class DateClock:
    """The computer's UTC as it is now, for stamps that others compare with their own: it steps when the date is set."""

    def now_ns(self) -> int:
        """Return the present UTC time in nanoseconds."""
        return time.time_ns()

    def wall_s(self, duration_s: float) -> float:
        """Return how many seconds of wall time `duration_s` of this clock take."""
        return duration_s


class SimulatedClock:
    """The simulator's time as its ticks tell it, run on between them at the rate measured over the last ticks.

    It never goes back: when it has run ahead of the simulator it stands until the simulator has caught up, and when
    the simulator is restarted, at whatever time, it runs on from where it was; it is no UTC from then on.
    Without ticks it stops `EXTRAPOLATION_MAX_S` of wall time after the last one. For use from one thread.
    """

    def __init__(self, *, monotonic_ns: MonotonicNs = time.monotonic_ns) -> None:
        self._monotonic_ns = monotonic_ns
        self._filter = TickFilter()
        self._ticks: deque[tuple[int, int]] = deque()  # (wall, shown), ns, oldest first
        self._ahead_ns = 0  # of the simulator
        self._shown_ns = 0

    @property
    def ready(self) -> bool:
        """Whether a tick has come, so that the time is known."""
        return bool(self._ticks)

    @property
    def rate(self) -> float:
        """Simulated seconds per wall second over the last ticks; 1 until they tell."""
        if not self._ticks:
            return 1.0
        (wall_first_ns, first_ns), (wall_last_ns, last_ns) = self._ticks[0], self._ticks[-1]
        span_ns = wall_last_ns - wall_first_ns
        return (last_ns - first_ns) / span_ns if span_ns >= _RATE_SPAN_MIN_NS else 1.0

    def tick(self, t_ns: int) -> bool:
        """Take the simulator's time `t_ns`, which was just received, and return whether it is believed.

        A believed one that is older than the last changes nothing.
        """
        if not self._filter.accepts(t_ns):
            return False
        wall_ns = self._monotonic_ns()
        if self._ticks and not _follows(t_ns + self._ahead_ns, self._ticks[-1][1]):
            self._ahead_ns = self._shown_ns - t_ns
            self._ticks.clear()
        shown_ns = t_ns + self._ahead_ns
        if self._ticks and shown_ns < self._ticks[-1][1]:
            return True
        self._ticks.append((wall_ns, shown_ns))
        while len(self._ticks) > 2 and wall_ns - self._ticks[0][0] > _RATE_WINDOW_NS:
            self._ticks.popleft()
        return True

    def now_ns(self) -> int:
        """Return the present simulated UTC time in nanoseconds.

        Raises:
            RuntimeError: Before the first tick.
        """
        if not self._ticks:
            raise RuntimeError("the simulated clock has not ticked yet")
        wall_ns, t_ns = self._ticks[-1]
        age_ns = min(self._monotonic_ns() - wall_ns, round(EXTRAPOLATION_MAX_S * NS_PER_S))
        self._shown_ns = max(self._shown_ns, t_ns + round(self.rate * age_ns))
        return self._shown_ns

    def wall_s(self, duration_s: float) -> float:
        """Return how many seconds of wall time `duration_s` take at the measured rate, a standstill taken as 0.05x."""
        return duration_s / max(self.rate, _RATE_MIN)


_USUALLY = gc.get_threshold()
_COLLECTED_AFTER = (50_000, 20, 20)
"""Objects and collections after which a program that starts looks for garbage; Python's own 700 cost a fifth of it."""


def collect_rarely() -> None:
    """Look for garbage rarely while a program starts: what its modules make stays, and each look goes through it anew.

    Source: `gc.set_threshold` in the Python library reference.
    """
    gc.set_threshold(*_COLLECTED_AFTER)


def spare_present_objects() -> None:
    """Take all objects that there are now out of every later collection of garbage.

    A full collection looks at everything that is alive: with numba's compiler loaded that is 140 to 200 ms, ten control
    periods, at an instant that nobody chooses. What starting a program made is hardly ever garbage: 37 of a companion's
    180,000 objects, for which no start looks 0.1 s long. What is made from now on is still looked after, and as often
    as is usual. Source: `gc.freeze` in the Python library reference.
    """
    gc.freeze()
    gc.set_threshold(*_USUALLY)
