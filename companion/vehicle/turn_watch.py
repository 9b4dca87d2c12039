"""Whether a unit's yaw rate is in rad/s and counter-clockwise, as the heading shows that the same unit tells.

Over windows of a second in which the rate tells of a turn, the heading turns by as much. One that tells degrees a
second, or counts clockwise, tells of another turn, and a filter that believes both swings between them. One window
counts for no more than a radian: a rate that runs away for a moment is another fault, which the filter rejects.
"""

import math
from collections.abc import Sequence

from companion.core.data import STEP_MAX_S
from link.frames.rotations import wrap_angle

_WINDOW_S = 1.0
_TURN_MIN_RAD = 0.1  # in a window, below which it shows nothing: a rate's own offset is 0.02 rad/s
_TURN_MAX_RAD = 1.0
_WINDOWS, _WINDOWS_MIN = 10, 4
_OFF_MAX = 0.5  # of what the rate tells: a heading that is smoothed lags behind it
_STDS = 3.0


class TurnWatch:
    """Takes headings and yaw rates of a vehicle's unit, in the order in which they come.

    Attributes:
        doubt: what is told of a rate by which the heading does not turn; None of one that fits, and before that shows.
    """

    def __init__(self) -> None:
        self.doubt: str | None = None
        self._newest: tuple[int, float] | None = None
        self._lasted_s = 0.0
        self._told_rad = 0.0  # in the present window, by the rate
        self._turned_rad = 0.0  # in the present window, by the heading
        self._windows: list[tuple[float, float, float]] = []  # both, counted as the rate's, and the latter's variance

    def take(self, t_ns: int, yaw_rad: float, variance_rad2: float, rate_rad_s: float) -> None:
        """Take a heading, its variance, and the yaw rate that was told with it."""
        before, self._newest = self._newest, (t_ns, yaw_rad)
        passed_s = 0.0 if before is None else (t_ns - before[0]) * 1e-9
        if before is None or not 0.0 < passed_s <= STEP_MAX_S:
            self._lasted_s = self._told_rad = self._turned_rad = 0.0
            return
        self._lasted_s += passed_s
        self._told_rad += rate_rad_s * passed_s
        self._turned_rad += wrap_angle(yaw_rad - before[1])
        if self._lasted_s >= _WINDOW_S:
            self._close(variance_rad2)

    def _close(self, variance_rad2: float) -> None:
        told_rad, turned_rad = abs(self._told_rad), math.copysign(1.0, self._told_rad) * self._turned_rad
        self._lasted_s = self._told_rad = self._turned_rad = 0.0
        if told_rad >= _TURN_MIN_RAD:
            window = (min(told_rad, _TURN_MAX_RAD), turned_rad, 2.0 * variance_rad2)
            self._windows = [*self._windows[-_WINDOWS + 1 :], window]
            self.doubt = _doubt_of(self._windows)

    @property
    def is_believed(self) -> bool:
        """Whether the heading turns by what the rate tells, as far as that shows."""
        return self.doubt is None


def _doubt_of(windows: Sequence[tuple[float, float, float]]) -> str | None:
    if len(windows) < _WINDOWS_MIN:
        return None
    told_rad, turned_rad, variance_rad2 = map(sum, zip(*windows, strict=True))
    if abs(turned_rad / told_rad - 1.0) <= _OFF_MAX + _STDS * math.sqrt(variance_rad2) / told_rad:
        return None
    return "the heading of the same unit turns otherwise: see rad/s, sign (counter-clockwise)"
