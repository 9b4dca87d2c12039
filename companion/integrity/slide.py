"""Whether fixes slide away from the way that the same receiver's velocities tell; pure.

Fixed phases err by centimetres, so the places change by what the velocities add up to, and where they do not, nobody
knows where the antenna is: somebody leads the receiver astray, or it has fixed its phases wrongly. A velocity that is
older than its place by `lag` adds up wrong by the lag times the change of speed, and one of a point `arm` away from the
antenna by the turn of that arm, as which a lag shows in a bend. What is not known of either may do so, and as much as
the arm squared times the curvature, for in a bend such a point's course is off the antenna's by the arm times that.
One place that is off slides nowhere: the median of a second's places tells where that second began.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from msgspec import Struct

from companion.core.data import FIXED_STD_MAX_M, Measurement
from companion.vehicle.told_motion import COURSE_SPEED_MIN_M_S, Told, ToldMotion, Window, take_told
from companion.vehicle.velocity_lag import VelocityLag
from companion.vehicle.velocity_point import VelocityPoint
from link.records import replace

_KEPT = 11  # ways of 10 s: over longer ones what velocities err by steadily, a centimetre a second, adds up
_STDS = 4.0
_OF_MEDIAN = 0.5 * math.pi  # variance of a median over that of a mean
_TURN_MIN_M = 3.0  # nothing on wheels turns about a point that is nearer, but where it stands


class _Second(NamedTuple):
    """What was told in a second or so.

    Attributes:
        begun_ns: when it began.
        ended_ns: when it ended.
        place_m: where it began, as its places and velocities say together, east and north.
        place_variance_m2: of that.
        way_m: by its velocities, east and north.
        way_variance_m2: of that.
        curvature_per_m: of its way; 0 of one that stands.
    """

    begun_ns: int
    ended_ns: int
    place_m: tuple[float, float]
    place_variance_m2: float
    way_m: tuple[float, float]
    way_variance_m2: float
    curvature_per_m: float

    @property
    def mean_m_s(self) -> tuple[float, float]:
        """Its mean velocity, east and north."""
        lasted_s = (self.ended_ns - self.begun_ns) * 1e-9
        return self.way_m[0] / lasted_s, self.way_m[1] / lasted_s


class FixSlide(Struct, frozen=True, kw_only=True):
    """What places and velocities told lately.

    Attributes:
        motion: what was told since the last second that was judged.
        seconds: without a gap, oldest first.
        has_slid: the places have slid in these seconds.
    """

    motion: ToldMotion = ToldMotion()
    seconds: tuple[_Second, ...] = ()
    has_slid: bool = False


def update_slide(
    before: FixSlide, measurements: Sequence[Measurement], lag: VelocityLag, point: VelocityPoint
) -> FixSlide:
    """Return what is known after `measurements`, whose velocities are those of `point`, at their times.

    Args:
        before: by the step before.
        measurements: of the vehicle since then.
        lag: how well it is known when the velocities were true.
        point: of which point they are, and how well that is known.
    """
    motion, window = take_told(before.motion, measurements)
    if window is None:
        return before if motion is before.motion else replace(before, motion=motion)
    if max(one.variance for one in window.places) > FIXED_STD_MAX_M**2:
        return FixSlide(motion=motion)
    newest = _second_of(window)
    follows = before.seconds and before.seconds[-1].ended_ns == newest.begun_ns
    seconds = (*before.seconds[1 - _KEPT :], newest) if follows else (newest,)
    bends_per_m = [one.curvature_per_m for one in seconds]
    bent_m = point.reach_m**2 * (max(bends_per_m) - min(bends_per_m))
    has_slid = any(_slides(seconds[first:], lag, point, bent_m) for first in range(len(seconds) - 1))
    return FixSlide(motion=motion, seconds=seconds, has_slid=has_slid)


def _second_of(window: Window) -> _Second:
    t_s = np.array([(one.t_ns - window.begun.t_ns) * 1e-9 for one in window.velocities])
    velocity_m_s = np.array([(one.east, one.north) for one in window.velocities])
    steps_m = 0.5 * (velocity_m_s[1:] + velocity_m_s[:-1]) * np.diff(t_s)[:, None]
    way_m = np.vstack([np.zeros(2), np.cumsum(steps_m, axis=0)])
    at_s = np.array([(one.t_ns - window.begun.t_ns) * 1e-9 for one in window.places])
    place_m = np.array([(one.east, one.north) for one in window.places])
    begun_m = [np.median(place_m[:, axis] - np.interp(at_s, t_s, way_m[:, axis])) for axis in range(2)]
    return _Second(
        begun_ns=window.begun.t_ns,
        ended_ns=window.ended.t_ns,
        place_m=(float(begun_m[0]), float(begun_m[1])),
        place_variance_m2=_OF_MEDIAN * window.begun.variance / len(window.places),
        way_m=(float(way_m[-1, 0]), float(way_m[-1, 1])),
        way_variance_m2=window.lasted_s**2 * window.velocities[0].variance / len(window.velocities),
        curvature_per_m=_curvature_per_m(window.velocities[0], window.velocities[-1], float(np.hypot(*way_m[-1]))),
    )


def _curvature_per_m(first: Told, last: Told, way_m: float) -> float:
    """Return the curvature of a second's way by the courses at its ends, 0 where that may be an error."""
    product_m2_s2 = math.hypot(first.east, first.north) * math.hypot(last.east, last.north)
    if min(product_m2_s2, way_m**2) < COURSE_SPEED_MIN_M_S**2:
        return 0.0
    sine = (first.east * last.north - first.north * last.east) / product_m2_s2
    turned_rad = math.asin(max(-1.0, min(sine, 1.0)))
    error_rad = _STDS * math.sqrt((first.variance + last.variance) / product_m2_s2)
    return turned_rad / way_m if abs(turned_rad) > error_rad else 0.0


def _slides(seconds: Sequence[_Second], lag: VelocityLag, point: VelocityPoint, bent_m: float) -> bool:
    """Return whether the place at the newest second's beginning is elsewhere than the way from the first one says."""
    first, newest, between = seconds[0], seconds[-1], seconds[:-1]
    turn = _turn(seconds)
    off_m = [
        newest.place_m[k] - first.place_m[k] - sum(one.way_m[k] for one in between) + by_arm_m
        for k, by_arm_m in enumerate(turn.moved_m(point.arm_m))
    ]
    variance_m2 = first.place_variance_m2 + newest.place_variance_m2 + _way_variance_m2(between)
    change_m_s = abs(math.hypot(*newest.mean_m_s) - math.hypot(*first.mean_m_s))
    unsure_m = lag.error_s * change_m_s + point.error_m * turn.most + bent_m
    return math.hypot(*off_m) > 2.0 * FIXED_STD_MAX_M + _STDS * math.sqrt(variance_m2) + unsure_m


def _way_variance_m2(seconds: Sequence[_Second]) -> float:
    """Return the variance of the sum of their ways: what is stated, or as much more as it wavers from one to the next.

    A slide is no waver: it goes on.
    """
    stated_m2 = sum(one.way_variance_m2 for one in seconds)
    if len(seconds) < 3:
        return stated_m2
    slides_m = [
        (after.place_m[0] - one.place_m[0] - one.way_m[0], after.place_m[1] - one.place_m[1] - one.way_m[1])
        for one, after in pairwise(seconds)
    ]
    wavers_m2 = float(np.var(np.array(slides_m), axis=0, ddof=1).mean())
    return max(stated_m2, len(seconds) * wavers_m2)


class _Turn(NamedTuple):
    """How the vehicle's course has changed.

    Attributes:
        east: of the unit vector along it.
        north: of that.
        most: by so much that may have changed.
    """

    east: float
    north: float
    most: float

    def moved_m(self, arm_m: tuple[float, float]) -> tuple[float, float]:
        """Return by how much the end of an arm, ahead and to the left, has moved against its beginning."""
        ahead_m, left_m = arm_m
        return self.east * ahead_m - self.north * left_m, self.east * left_m + self.north * ahead_m


def _turn(seconds: Sequence[_Second]) -> _Turn:
    """Return the turn from the first to the newest second; one that stands has turned by no more than it has driven."""
    most = min(2.0, sum(map(_driven_m, seconds)) / _TURN_MIN_M)
    (east_0, north_0), (east_1, north_1) = seconds[0].mean_m_s, seconds[-1].mean_m_s
    begun_m_s, ended_m_s = math.hypot(east_0, north_0), math.hypot(east_1, north_1)
    if min(begun_m_s, ended_m_s) < COURSE_SPEED_MIN_M_S:
        return _Turn(0.0, 0.0, most)
    east, north = east_1 / ended_m_s - east_0 / begun_m_s, north_1 / ended_m_s - north_0 / begun_m_s
    return _Turn(east, north, min(most, math.hypot(east, north)))


def _driven_m(second: _Second) -> float:
    """Return its way, nothing where that may be an error."""
    way_m = math.hypot(*second.way_m)
    return way_m if way_m > _STDS * math.sqrt(second.way_variance_m2) else 0.0
