"""Learns of which point a vehicle's velocities are told, and makes them those of the antenna; pure.

An inertial system mostly tells the velocity of its own place, and in a bend that is another one than the antenna's: by
1.3 m and 0.27 rad/s it differs by 0.35 m/s, and its course by 2.5 degrees. With `a` from the antenna to that point and
the course `c`, both in the frame of the course, the antenna moves by the way of the point less (R(c1) - R(c0)) a. Over
windows of a second least squares tell `a`, weighted as those of `velocity_lag`. Straights tell nothing of it.
A velocity that is old looks alike in a bend, and is mended alike; once the lag is known, the point is learnt anew.
"""

import math
from collections.abc import Sequence

import numpy as np
from msgspec import Struct

from companion.core.data import Measurement, Quantity
from companion.vehicle.told_motion import COURSE_SPEED_MIN_M_S, Told, ToldMotion, Window, take_told
from link.records import replace

_MEMORY_S = 300.0  # the point does not change, but who drives may tell more
_ARM_MIN_M = 0.3  # less is off by 0.1 m/s in a tight bend, 0.3 rad/s: little more than a receiver's own error
_ARM_MAX_M = 15.0  # half a coach, and what a velocity that is a second late looks like at 10 m/s in a bend
_STDS = 4.0
_TURN_OVER_NS = 450_000_000  # over which the course tells how the vehicle turns, five velocities at 10 Hz


class VelocityPoint(Struct, frozen=True, kw_only=True):
    """What is known of the point.

    Attributes:
        motion: what was told lately.
        information_per_m2: sum of the squared turns over the variances.
        ahead_per_m: sum of the turns times the differences over the variances, along the course.
        left_per_m: sum of the turns times the differences over the variances, to the left of the course.
        squares: sum of the squared differences over the variances.
        windows: how many differences these sums are of.
        is_known: it was farther from the antenna than its least and its error once; then it counts as it is.
    """

    motion: ToldMotion = ToldMotion()
    information_per_m2: float = 0.0
    ahead_per_m: float = 0.0
    left_per_m: float = 0.0
    squares: float = 0.0
    windows: float = 0.0
    is_known: bool = False

    @property
    def arm_m(self) -> tuple[float, float]:
        """From the antenna to the point, along the course and to its left; nothing before it is known."""
        if not self.is_known:
            return 0.0, 0.0
        return self.ahead_per_m / self.information_per_m2, self.left_per_m / self.information_per_m2

    @property
    def error_m(self) -> float:
        """By which the point may be elsewhere, at most."""
        estimate = self._estimate()
        return self.reach_m if estimate is None or not self.is_known else min(estimate[1], _ARM_MAX_M)

    @property
    def reach_m(self) -> float:
        """How far from the antenna the point may be, at most, whether or not that is known."""
        estimate = self._estimate()
        return _ARM_MAX_M if estimate is None else min(sum(estimate), _ARM_MAX_M)

    @property
    def is_significant(self) -> bool:
        """Whether it is far enough from the antenna to matter, and too far for an error."""
        estimate = self._estimate()
        return estimate is not None and estimate[0] > max(_ARM_MIN_M, estimate[1])

    def _estimate(self) -> tuple[float, float] | None:
        """Return how far the point is by least squares, and by how much that may err; None while nothing tells it."""
        if self.windows < 2.0 or self.information_per_m2 == 0.0:
            return None
        product = math.hypot(self.ahead_per_m, self.left_per_m)
        arm_m = product / self.information_per_m2
        scatter = max(0.5 * (self.squares - product * arm_m) / (self.windows - 1.0), 1.0)
        return arm_m, _STDS * math.sqrt(scatter / self.information_per_m2)


def learn_point(point: VelocityPoint, measurements: Sequence[Measurement]) -> VelocityPoint:
    """Return the point after `measurements`, whose velocities are true at their times."""
    motion, window = take_told(point.motion, measurements)
    if motion is not point.motion:
        point = replace(point, motion=motion)
    if window is None or min(map(_speed_m_s, (window.velocities[0], window.velocities[-1]))) < COURSE_SPEED_MIN_M_S:
        return point
    return _with_window(point, window)


def velocities_of_antenna(point: VelocityPoint, measurements: Sequence[Measurement]) -> tuple[Measurement, ...]:
    """Return `measurements` with the velocities of the antenna, as uncertain as the vehicle's turn makes them."""
    if not point.is_known:
        return tuple(measurements)
    return tuple(_of_antenna(point, one) if one.quantity is Quantity.VELOCITY else one for one in measurements)


def _of_antenna(point: VelocityPoint, velocity: Measurement) -> Measurement:
    lately = [one for one in point.motion.velocities if -_TURN_OVER_NS <= one.t_ns - velocity.t_ns <= 0]
    if len(lately) < 2 or min(map(_speed_m_s, (lately[0], lately[-1]))) < COURSE_SPEED_MIN_M_S:
        return velocity
    first, last = lately[0], lately[-1]
    over_s = (last.t_ns - first.t_ns) * 1e-9
    rate_rad_s = _turned_rad(first, last) / over_s
    ux, uy = _course(last)
    ahead_m, left_m = point.arm_m
    swing_m_s = rate_rad_s * np.array([-ux * left_m - uy * ahead_m, ux * ahead_m - uy * left_m, 0.0])
    rate_variance = 2.0 * last.variance / (_speed_m_s(last) * over_s) ** 2
    unsure = rate_variance * (ahead_m**2 + left_m**2) + rate_rad_s**2 / point.information_per_m2
    return replace(
        velocity,
        value=velocity.value - swing_m_s,
        covariance=velocity.covariance + np.diag([unsure, unsure, 0.0]),
    )


def _with_window(point: VelocityPoint, window: Window) -> VelocityPoint:
    begun, ended, velocities = window.begun, window.ended, window.velocities
    lasted_s, (east_m_s, north_m_s) = window.lasted_s, window.mean_m_s
    (ux_0, uy_0), (ux_1, uy_1) = _course(velocities[0]), _course(velocities[-1])
    dx, dy = ux_1 - ux_0, uy_1 - uy_0
    east_m = lasted_s * east_m_s - (ended.east - begun.east)
    north_m = lasted_s * north_m_s - (ended.north - begun.north)
    variance = begun.variance + ended.variance + lasted_s**2 * velocities[0].variance / len(velocities)
    keep = math.exp(-lasted_s / _MEMORY_S)
    learnt = replace(
        point,
        information_per_m2=keep * point.information_per_m2 + (dx**2 + dy**2) / variance,
        ahead_per_m=keep * point.ahead_per_m + (dx * east_m + dy * north_m) / variance,
        left_per_m=keep * point.left_per_m + (dx * north_m - dy * east_m) / variance,
        squares=keep * point.squares + (east_m**2 + north_m**2) / variance,
        windows=keep * point.windows + 1.0,
    )
    return replace(learnt, is_known=point.is_known or learnt.is_significant)


def _turned_rad(first: Told, last: Told) -> float:
    return math.atan2(
        first.east * last.north - first.north * last.east, first.east * last.east + first.north * last.north
    )


def _speed_m_s(velocity: Told) -> float:
    return math.hypot(velocity.east, velocity.north)


def _course(velocity: Told) -> tuple[float, float]:
    speed_m_s = _speed_m_s(velocity)
    return velocity.east / speed_m_s, velocity.north / speed_m_s
