"""The places and velocities that a receiver has told lately, window by window; pure.

What differs between the way that its velocities tell and that between its places shows how late velocities are
(`velocity_lag`), of which point they are told (`velocity_point`), and whether places slide (`integrity/slide`). A
velocity between two stamps is on the straight line between its neighbours.
"""

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

from msgspec import Struct

from companion.core.data import Measurement, Quantity

COURSE_SPEED_MIN_M_S = 1.0
"""From which on the direction of a velocity is a course."""

_WINDOW_NS, _WINDOW_MAX_NS = 1_000_000_000, 1_500_000_000  # a brake lasts as long, and fixes tell its speed by then
_KEPT_NS = 2_500_000_000
_GAP_MAX_NS = 250_000_000  # between two velocities, over which the speed is a straight line; they come at 5 Hz or more


class Told(NamedTuple):
    """A place, m, or a velocity, m/s, horizontal, with the mean variance of its axes."""

    t_ns: int
    east: float
    north: float
    variance: float


class Window(NamedTuple):
    """A second or so of what was told.

    Attributes:
        begun: the place at which it begins.
        ended: the place at which it ends.
        places: from the one to the other, with both.
        velocities: from the one to the other, at both ends, too.
    """

    begun: Told
    ended: Told
    places: tuple[Told, ...]
    velocities: tuple[Told, ...]

    @property
    def lasted_s(self) -> float:
        """From its beginning to its end."""
        return (self.ended.t_ns - self.begun.t_ns) * 1e-9

    @property
    def mean_m_s(self) -> tuple[float, float]:
        """The mean velocity over time, east and north."""
        return self._mean("east"), self._mean("north")

    def _mean(self, axis: str) -> float:
        area = sum(
            0.5 * (getattr(before, axis) + getattr(after, axis)) * (after.t_ns - before.t_ns)
            for before, after in pairwise(self.velocities)
        )
        return float(area / (self.velocities[-1].t_ns - self.velocities[0].t_ns))


class ToldMotion(Struct, frozen=True, kw_only=True):
    """What was told in the last seconds.

    Attributes:
        places: since the last window ended, oldest first.
        velocities: of the last seconds, oldest first.
    """

    places: tuple[Told, ...] = ()
    velocities: tuple[Told, ...] = ()


def take_told(motion: ToldMotion, measurements: Sequence[Measurement]) -> tuple[ToldMotion, Window | None]:
    """Return the motion after `measurements`, and the window that they complete, if they do and it has no gap."""
    places, velocities = _told_of(measurements, Quantity.POSITION), _told_of(measurements, Quantity.VELOCITY)
    if not places and not velocities:
        return motion, None
    places, velocities = _recent((*motion.places, *places)), _recent((*motion.velocities, *velocities))
    ends = _ends_of_window(places, velocities)
    if ends is None:
        return ToldMotion(places=places, velocities=velocities), None
    begun, ended = ends
    inside = (one for one in velocities if begun.t_ns < one.t_ns < ended.t_ns)
    window = Window(
        begun=begun,
        ended=ended,
        places=tuple(one for one in places if begun.t_ns <= one.t_ns <= ended.t_ns),
        velocities=(_at(velocities, begun.t_ns), *inside, _at(velocities, ended.t_ns)),
    )
    rest = tuple(one for one in places if one.t_ns >= ended.t_ns)
    return ToldMotion(places=rest, velocities=velocities), None if _has_gap(window.velocities) else window


def _told_of(measurements: Sequence[Measurement], quantity: Quantity) -> tuple[Told, ...]:
    """Return the places or the velocities among `measurements`."""
    return tuple(
        Told(one.t_ns, float(one.value[0]), float(one.value[1]), 0.5 * float(one.covariance.diagonal()[:2].sum()))
        for one in measurements
        if one.quantity is quantity
    )


def _recent(told: tuple[Told, ...]) -> tuple[Told, ...]:
    """Return them in order, each time once, without those that are old."""
    if not told:
        return told
    newest_ns = max(one.t_ns for one in told)
    return tuple(sorted({one.t_ns: one for one in told if one.t_ns > newest_ns - _KEPT_NS}.values()))


def _ends_of_window(places: tuple[Told, ...], velocities: tuple[Told, ...]) -> tuple[Told, Told] | None:
    """Return the places at which the next window begins and ends, None while there is none."""
    if not velocities:
        return None
    covered = [one for one in places if velocities[0].t_ns <= one.t_ns <= velocities[-1].t_ns]
    if not covered or covered[-1].t_ns - covered[0].t_ns < _WINDOW_NS:
        return None
    begun = next(one for one in reversed(covered) if covered[-1].t_ns - one.t_ns >= _WINDOW_NS)
    return (begun, covered[-1]) if covered[-1].t_ns - begun.t_ns <= _WINDOW_MAX_NS else None


def _has_gap(within: Sequence[Told]) -> bool:
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
