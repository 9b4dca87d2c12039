"""Learns by how much a receiver's velocities are older than its places, and dates them so; pure.

Many receivers smooth velocities and none of the places, or stamp both alike. A velocity that is older by `lag` than its
stamp differs from how the places change by the acceleration times the lag. Over windows of a second that is a straight
line through zero: least squares, weighted by what receivers state, and by more where the windows scatter more. Only
changes of the speed count. In a bend a velocity that is told of another point than the antenna would look the same.
A velocity that seems younger than its place tells of places that are old, and nobody knows since when: it stays.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from msgspec import Struct

from companion.core.data import Measurement, Quantity
from link.records import replace

_WINDOW_NS, _WINDOW_MAX_NS = 1_000_000_000, 1_500_000_000  # a brake lasts as long, and fixes tell its speed by then
_KEPT_NS = 2_500_000_000
_GAP_MAX_NS = 250_000_000  # between two velocities, over which the speed is a straight line; they come at 5 Hz or more
_MEMORY_S = 300.0  # a receiver's filter does not change, but who drives may tell more
_LAG_MAX_S = 1.0  # no receiver smooths for longer: what contradicts more is a step
_LAG_MIN_S = 0.05  # of half a period at 10 Hz; a brake of 6 m/s^2 is told wrong by 0.3 m/s, a receiver's own error
_STDS = 4.0
_SPEED_MIN_M_S = 1.0  # from which on a course is one


class Told(NamedTuple):
    """A place, m, or a velocity, m/s, horizontal, with the mean variance of its axes."""

    t_ns: int
    east: float
    north: float
    variance: float


class VelocityLag(Struct, frozen=True, kw_only=True):
    """What is known of the lag.

    Attributes:
        places: of the last seconds, oldest first.
        velocities: of the last seconds, oldest first.
        information_per_s2: sum of the squared accelerations over the variances.
        product_per_s: sum of acceleration times difference over the variances.
        squares: sum of the squared differences over the variances.
        windows: how many differences these sums are of.
        is_known: it was above its least and its error once; then it counts as it is.
    """

    places: tuple[Told, ...] = ()
    velocities: tuple[Told, ...] = ()
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
    def is_significant(self) -> bool:
        """Whether it is large enough to matter, and too large for an error."""
        if self.windows < 2.0 or self.information_per_s2 == 0.0:
            return False
        lag_s = self.product_per_s / self.information_per_s2
        scatter = max((self.squares - self.product_per_s * lag_s) / (self.windows - 1.0), 1.0)
        return lag_s > max(_LAG_MIN_S, _STDS * math.sqrt(scatter / self.information_per_s2))


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
    places = told_of(measurements, Quantity.POSITION)
    velocities = told_of(measurements, Quantity.VELOCITY)
    if not places and not velocities:
        return lag
    places, velocities = recent((*lag.places, *places)), recent((*lag.velocities, *velocities))
    lag = replace(lag, places=places, velocities=velocities)
    window = next_window(places, velocities)
    if window is None:
        return lag
    within = velocities_within(velocities, window)
    lag = replace(lag, places=tuple(one for one in places if one.t_ns >= window[1].t_ns))
    return lag if has_gap(within) else _with_window(lag, window, within)


def told_of(measurements: Sequence[Measurement], quantity: Quantity) -> tuple[Told, ...]:
    """Return the places or the velocities among `measurements`."""
    return tuple(
        Told(one.t_ns, float(one.value[0]), float(one.value[1]), 0.5 * float(one.covariance.diagonal()[:2].sum()))
        for one in measurements
        if one.quantity is quantity
    )


def recent(told: tuple[Told, ...]) -> tuple[Told, ...]:
    """Return them in order, each time once, without those that are old."""
    if not told:
        return told
    newest_ns = max(one.t_ns for one in told)
    return tuple(sorted({one.t_ns: one for one in told if one.t_ns > newest_ns - _KEPT_NS}.values()))


def next_window(places: tuple[Told, ...], velocities: tuple[Told, ...]) -> tuple[Told, Told] | None:
    """Return the places at which the next window begins and ends, None while there is none."""
    if not velocities:
        return None
    covered = [one for one in places if velocities[0].t_ns <= one.t_ns <= velocities[-1].t_ns]
    if not covered or covered[-1].t_ns - covered[0].t_ns < _WINDOW_NS:
        return None
    begun = next(one for one in reversed(covered) if covered[-1].t_ns - one.t_ns >= _WINDOW_NS)
    return (begun, covered[-1]) if covered[-1].t_ns - begun.t_ns <= _WINDOW_MAX_NS else None


def velocities_within(velocities: tuple[Told, ...], window: tuple[Told, Told]) -> list[Told]:
    """Return the velocities from the place at which a window begins to that at which it ends, these included."""
    begun, ended = window
    inside = (one for one in velocities if begun.t_ns < one.t_ns < ended.t_ns)
    return [_at(velocities, begun.t_ns), *inside, _at(velocities, ended.t_ns)]


def has_gap(within: Sequence[Told]) -> bool:
    """Return whether two of the velocities are too far apart for a straight line between them."""
    return any(after.t_ns - before.t_ns > _GAP_MAX_NS for before, after in pairwise(within))


def _at(velocities: tuple[Told, ...], t_ns: int) -> Told:
    """Return the velocity on the straight line between its neighbours."""
    before = [one for one in velocities if one.t_ns <= t_ns][-1]
    after = next(one for one in velocities if one.t_ns >= t_ns)
    share = 0.0 if after.t_ns == before.t_ns else (t_ns - before.t_ns) / (after.t_ns - before.t_ns)
    return Told(
        t_ns,
        before.east + share * (after.east - before.east),
        before.north + share * (after.north - before.north),
        before.variance,
    )


def _with_window(lag: VelocityLag, window: tuple[Told, Told], within: Sequence[Told]) -> VelocityLag:
    """Return the lag after a window: its first and last place, and the velocities from one to the other."""
    (begun, ended), first, last = window, within[0], within[-1]
    lasted_s = (ended.t_ns - begun.t_ns) * 1e-9
    east_m_s, north_m_s = (mean_of(within, axis) for axis in ("east", "north"))
    speed_m_s = math.hypot(east_m_s, north_m_s)
    if speed_m_s < _SPEED_MIN_M_S:
        return lag
    ux, uy = east_m_s / speed_m_s, north_m_s / speed_m_s
    moved_m = ux * (ended.east - begun.east) + uy * (ended.north - begun.north)
    slower_m_s = moved_m / lasted_s - speed_m_s
    change_m_s2 = (ux * (last.east - first.east) + uy * (last.north - first.north)) / lasted_s
    variance = (begun.variance + ended.variance) / lasted_s**2 + first.variance / len(within)
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


def mean_of(within: Sequence[Told], axis: str) -> float:
    """Return the mean over time of one axis of velocities that are straight lines between their stamps."""
    area = sum(
        0.5 * (getattr(before, axis) + getattr(after, axis)) * (after.t_ns - before.t_ns)
        for before, after in pairwise(within)
    )
    return float(area / (within[-1].t_ns - within[0].t_ns))
