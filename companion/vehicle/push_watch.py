"""Whether a unit's accelerometer feels ahead what the receiver's speed along the heading does.

Over windows of a second or so in which the speed changes, the forces ahead add up to as much. Axes that are turned
about the vertical by 90 degrees feel nothing of it, those of the other sign or turned by 180 the contrary: by these a
brake is a push forwards. A unit that does not tell its tilt also feels the grade, 1.2 m/s^2 on a steep street: there
the speed must both rise and fall. Velocities may be older than their stamps by as much as a receiver smooths.
"""

import math
from bisect import bisect_right
from collections.abc import Sequence
from operator import itemgetter
from typing import NamedTuple

from companion.core.data import STEP_MAX_S
from companion.vehicle.gravity_watch import FORCE_MAX_M_S2
from companion.vehicle.told_motion import Told

_WINDOW_S, _WINDOW_MAX_S = 1.0, 1.5
_LAGS_S = (0.0, 0.5, 1.0)
_KEPT_S = 4.0
_CHANGE_MIN_M_S = 1.0  # in a window, below which it shows nothing: a grade adds as much
_BRAKE_MAX_M_S2 = 12.0  # tyres grip dry asphalt with a friction of 1.2 at most: what changes faster is told wrong
_CHANGES_MIN_M_S = 3.0  # in all
_WINDOWS = 10
_FELT_MIN, _FELT_MAX = 0.3, 3.0  # of what the speed has changed; a grade and a cheap unit's offset are half of it
_STDS = 3.0


class _Felt(NamedTuple):
    """The forces ahead, m/s, that have added up by a time, and the heading then."""

    t_ns: int
    sum_m_s: float
    yaw_rad: float


class _Window(NamedTuple):
    """By how much the speed has changed, what was felt of it at each of the lags, and the former's variance, m/s."""

    change: float
    felt: tuple[float, ...]
    variance: float


class PushWatch:
    """Takes forces and velocities of a vehicle, each in the order in which they come.

    Attributes:
        doubt: what is told of forces that the speed contradicts; None of those that fit, and before that shows.
    """

    def __init__(self) -> None:
        self.doubt: str | None = None
        self._felt: list[_Felt] = []
        self._told: list[Told] = []
        self._windows: list[_Window] = []
        self._is_level = False

    @property
    def is_believed(self) -> bool:
        """Whether the speed does what the forces tell, as far as that shows."""
        return self.doubt is None

    def take_force(self, t_ns: int, ahead_m_s2: float, yaw_rad: float, *, is_level: bool) -> None:
        """Take a force along the heading, and that; `is_level` where the tilt is known, so that no grade is in it."""
        self._is_level = is_level
        newest = self._felt[-1] if self._felt else _Felt(t_ns, 0.0, yaw_rad)
        passed_s = (t_ns - newest.t_ns) * 1e-9
        if not 0.0 <= passed_s <= STEP_MAX_S:
            self._felt, passed_s = [], 0.0
        felt_m_s2 = min(max(ahead_m_s2, -FORCE_MAX_M_S2), FORCE_MAX_M_S2)
        self._felt.append(_Felt(t_ns, newest.sum_m_s + felt_m_s2 * passed_s, yaw_rad))
        _forget_old(self._felt)

    def take_velocity(self, t_ns: int, velocity_enu_m_s: Sequence[float], variance_m2_s2: float) -> None:
        """Take a velocity and the variance of one axis."""
        if self._told and not 0.0 < (t_ns - self._told[-1].t_ns) * 1e-9 <= _WINDOW_S:
            self._told = []
        self._told.append(Told(t_ns, float(velocity_enu_m_s[0]), float(velocity_enu_m_s[1]), variance_m2_s2))
        _forget_old(self._told)
        self._close()

    def _close(self) -> None:
        """Make a window of what has come, if it is long enough and forces were felt over it."""
        if not self._felt:
            return
        from_ns, until_ns = self._felt[0].t_ns + round(_LAGS_S[-1] * 1e9), self._felt[-1].t_ns
        covered = [one for one in self._told if from_ns <= one.t_ns <= until_ns]
        if not covered or (covered[-1].t_ns - covered[0].t_ns) * 1e-9 < _WINDOW_S:
            return
        begun, ended = covered[0], covered[-1]
        self._told = [one for one in self._told if one.t_ns >= ended.t_ns]
        lasted_s = (ended.t_ns - begun.t_ns) * 1e-9
        if lasted_s > _WINDOW_MAX_S:
            return
        change_m_s = self._ahead_m_s(ended) - self._ahead_m_s(begun)
        if not _CHANGE_MIN_M_S <= abs(change_m_s) <= _BRAKE_MAX_M_S2 * lasted_s:
            return
        felt_m_s = tuple(self._felt_by(ended.t_ns, lag_s) - self._felt_by(begun.t_ns, lag_s) for lag_s in _LAGS_S)
        self._windows = [
            *self._windows[-_WINDOWS + 1 :],
            _Window(change_m_s, felt_m_s, begun.variance + ended.variance),
        ]
        self.doubt = _doubt_of(self._windows, is_level=self._is_level)

    def _at(self, t_ns: int) -> _Felt:
        return self._felt[max(bisect_right(self._felt, t_ns, key=itemgetter(0)) - 1, 0)]

    def _felt_by(self, t_ns: int, lag_s: float) -> float:
        return self._at(t_ns - round(lag_s * 1e9)).sum_m_s

    def _ahead_m_s(self, told: Told) -> float:
        yaw_rad = self._at(told.t_ns).yaw_rad
        return math.cos(yaw_rad) * told.east + math.sin(yaw_rad) * told.north


def _forget_old(kept: list[_Felt] | list[Told]) -> None:
    """Leave the last seconds, though the other of the two kinds never comes and no window is ever complete."""
    oldest_ns = kept[-1].t_ns - round(_KEPT_S * 1e9)
    del kept[: bisect_right(kept, oldest_ns, key=itemgetter(0))]


def _doubt_of(windows: Sequence[_Window], *, is_level: bool) -> str | None:
    changes_m_s = sum(abs(one.change) for one in windows)
    has_both = any(one.change > 0.0 for one in windows) and any(one.change < 0.0 for one in windows)
    if changes_m_s < _CHANGES_MIN_M_S or not (is_level or has_both):
        return None
    shares = [
        sum(math.copysign(1.0, one.change) * one.felt[k] for one in windows) / changes_m_s for k in range(len(_LAGS_S))
    ]
    unsure = _STDS * math.sqrt(sum(one.variance for one in windows)) / changes_m_s
    if max(shares) >= _FELT_MIN - unsure and min(shares) <= _FELT_MAX + unsure:
        return None
    return "the receiver's speed changes otherwise: see axes (x is ahead) and sign, m/s^2"
