"""Learns by how much a receiver's velocities are older than its places, and dates them so; pure.

Many receivers smooth velocities and none of the places, or stamp both alike. A velocity that is older by `lag` than its
stamp differs from how the places change by the acceleration times the lag. Over windows of a second that is a straight
line through zero: least squares, weighted by what receivers state, and by more where the windows scatter more. Only
changes of the speed count. In a bend a velocity that is told of another point than the antenna would look the same.
A velocity that seems younger than its place tells of places that are old, and nobody knows since when: it stays.
"""

import math
from collections.abc import Sequence

from msgspec import Struct

from companion.core.data import Measurement, Quantity
from companion.vehicle.told_motion import COURSE_SPEED_MIN_M_S, ToldMotion, Window, take_told
from link.records import replace

_MEMORY_S = 300.0  # a receiver's filter does not change, but who drives may tell more
_LAG_MAX_S = 1.0  # no receiver smooths for longer: what contradicts more is a step
_LAG_MIN_S = 0.05  # of half a period at 10 Hz; a brake of 6 m/s^2 is told wrong by 0.3 m/s, a receiver's own error
_STDS = 4.0


class VelocityLag(Struct, frozen=True, kw_only=True):
    """What is known of the lag.

    Attributes:
        motion: what was told lately.
        information_per_s2: sum of the squared accelerations over the variances.
        product_per_s: sum of acceleration times difference over the variances.
        squares: sum of the squared differences over the variances.
        windows: how many differences these sums are of.
        is_known: it was above its least and its error once; then it counts as it is.
    """

    motion: ToldMotion = ToldMotion()
    information_per_s2: float = 0.0
    product_per_s: float = 0.0
    squares: float = 0.0
    windows: float = 0.0
    is_known: bool = False

    @property
    def lag_s(self) -> float:
        """By which velocities are older than their stamps; 0 before that is known."""
        return min(max(self.product_per_s / self.information_per_s2, 0.0), _LAG_MAX_S) if self.is_known else 0.0

    @property
    def error_s(self) -> float:
        """By which dated velocities may be older or younger than the places, at most."""
        if (estimate := self._estimate()) is None:
            return _LAG_MAX_S
        lag_s, error_s = estimate
        return min(error_s if self.is_known else abs(lag_s) + error_s, _LAG_MAX_S)

    @property
    def is_significant(self) -> bool:
        """Whether it is large enough to matter, and too large for an error."""
        estimate = self._estimate()
        return estimate is not None and estimate[0] > max(_LAG_MIN_S, estimate[1])

    def _estimate(self) -> tuple[float, float] | None:
        """Return the lag by least squares, and by how much that may err; None while nothing tells it."""
        if self.windows < 2.0 or self.information_per_s2 == 0.0:
            return None
        lag_s = self.product_per_s / self.information_per_s2
        scatter = max((self.squares - self.product_per_s * lag_s) / (self.windows - 1.0), 1.0)
        return lag_s, _STDS * math.sqrt(scatter / self.information_per_s2)


def dated_velocities(lag: VelocityLag, measurements: Sequence[Measurement]) -> tuple[Measurement, ...]:
    """Return `measurements` with the velocities at the times at which they were true."""
    lag_ns = round(lag.lag_s * 1e9)
    if not lag_ns:
        return tuple(measurements)
    return tuple(
        replace(one, t_ns=one.t_ns - lag_ns) if one.quantity is Quantity.VELOCITY else one for one in measurements
    )


def learn_lag(lag: VelocityLag, measurements: Sequence[Measurement]) -> VelocityLag:
    """Return the lag after `measurements`, whose stamps are the receiver's own."""
    motion, window = take_told(lag.motion, measurements)
    if motion is not lag.motion:
        lag = replace(lag, motion=motion)
    return lag if window is None else _with_window(lag, window)


def _with_window(lag: VelocityLag, window: Window) -> VelocityLag:
    begun, ended, velocities = window.begun, window.ended, window.velocities
    first, last, lasted_s = velocities[0], velocities[-1], window.lasted_s
    east_m_s, north_m_s = window.mean_m_s
    speed_m_s = math.hypot(east_m_s, north_m_s)
    if speed_m_s < COURSE_SPEED_MIN_M_S:
        return lag
    ux, uy = east_m_s / speed_m_s, north_m_s / speed_m_s
    moved_m = ux * (ended.east - begun.east) + uy * (ended.north - begun.north)
    slower_m_s = moved_m / lasted_s - speed_m_s
    change_m_s2 = (ux * (last.east - first.east) + uy * (last.north - first.north)) / lasted_s
    variance = (begun.variance + ended.variance) / lasted_s**2 + first.variance / len(velocities)
    if abs(slower_m_s) > _LAG_MAX_S * abs(change_m_s2) + _STDS * math.sqrt(variance):
        return lag
    keep = math.exp(-lasted_s / _MEMORY_S)
    learnt = replace(
        lag,
        information_per_s2=keep * lag.information_per_s2 + change_m_s2**2 / variance,
        product_per_s=keep * lag.product_per_s + change_m_s2 * slower_m_s / variance,
        squares=keep * lag.squares + slower_m_s**2 / variance,
        windows=keep * lag.windows + 1.0,
    )
    return replace(learnt, is_known=lag.is_known or learnt.is_significant)
