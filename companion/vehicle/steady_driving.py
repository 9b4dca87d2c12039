"""Learns how unsteadily a vehicle is driven while nothing new begins: the noise of the filter's steady model; pure.

The steady model takes the acceleration along the track, and the one across it that turns the vehicle, for random walks.
An ordinary driver's are those that are likeliest for drawn worlds; one whose accelerations change more is told from how
they changed in the last minute. Over pairs of instants that lie a lag apart the squares of the changes are summed, and
the sums fade. The filter's mean also changes with what it comes to know, in the mean of many by as much as its variance
falls, so that this is taken off. A pair counts with the probability that no manoeuvre, which has a model of its own,
has begun in it. Nobody is taken to be steadier than ordinary: who drives straight on may be about to weave.
"""

import math
from typing import NamedTuple

import numpy as np
from msgspec import Struct

from companion.config.estimation import HeadingConfig, ImmConfig
from companion.core.data import Measurement, Quantity
from companion.vehicle.imm_mixing import Modes
from companion.vehicle.imm_numbers import BRAKING, EASING, STEADY, TURNING, Bounds
from link.records import replace

MEMORY_S = 60.0  # longer than a landing; a driver in town is another one on the road out
PRIOR_S = 10.0  # for which an ordinary driver counts as watched: a curve or two
LAG_S = 1.0  # twice what a filter needs that fixes of 0.1 m ten times a second tell the acceleration
_LAG_MAX_S = 2.5 * LAG_S  # two periods of a receiver at 1 Hz; what a vehicle has done in a longer silence nobody knows
_SETTLED = 2.0  # times its variance now: before, a filter knew too little yet for a change of its mean to tell anything


class Watched(Struct, frozen=True, kw_only=True):
    """How an acceleration has changed: sum of the squared changes, and over how much time."""

    squares_m2_s4: float = 0.0
    seen_s: float = 0.0

    def psd_m2_s5(self, bounds: Bounds) -> float:
        """Return how fast the acceleration walks, given how fast an ordinary driver's does and any steady one's may."""
        ordinary_m2_s5, most_m2_s5 = bounds
        mean_m2_s5 = (PRIOR_S * ordinary_m2_s5 + self.squares_m2_s4) / (PRIOR_S + self.seen_s)
        return min(max(mean_m2_s5, ordinary_m2_s5), most_m2_s5)


class Known(NamedTuple):
    """What a filter knows of a number: acceleration, m/s^2, or curvature, rad/m."""

    mean: float
    variance: float


class Begun(Struct, frozen=True, kw_only=True):
    """What was known when a pair began.

    Attributes:
        along: acceleration along the track.
        curvature: of the track.
        speed_m_s: horizontal.
        pedals: probability that a pedal was moved anew then or since.
        wheel: that the wheel was.
    """

    along: Known
    curvature: Known
    speed_m_s: float
    pedals: float
    wheel: float


class SteadyDriving(Struct, frozen=True, kw_only=True):
    """What has been seen of a vehicle's driving, and the present pair.

    Attributes:
        along: the track.
        across: it.
        begun: None while there is no pair.
        passed_s: since the last one began.
    """

    along: Watched = Watched()
    across: Watched = Watched()
    begun: Begun | None = None
    passed_s: float = 0.0

    def psd_m2_s5(self, bounds: tuple[Bounds, Bounds]) -> tuple[float, float]:
        """Return how fast the accelerations along the track and across it walk, each within its bounds."""
        return self.along.psd_m2_s5(bounds[0]), self.across.psd_m2_s5(bounds[1])


def passed(driving: SteadyDriving, dt_s: float) -> SteadyDriving:
    """Return the driving `dt_s` later."""
    return replace(driving, passed_s=driving.passed_s + dt_s)


def without_pair(driving: SteadyDriving) -> SteadyDriving:
    """Return the driving without the present pair, where the filter's mean has changed for another reason."""
    return replace(driving, begun=None)


def learn(driving: SteadyDriving, modes: Modes, config: ImmConfig) -> SteadyDriving:
    """Return the driving after a reading of place or velocity; only a vehicle that drives tells anything.

    Args:
        driving: so far.
        modes: of the filter.
        config: of the filter.
    """
    now = _known(modes)
    if now.speed_m_s < config.heading.curvature_speed_min_m_s:
        return without_pair(driving)
    begun, lag_s = driving.begun, driving.passed_s
    pedals, wheel = (0.0, 0.0) if begun is None else (max(begun.pedals, now.pedals), max(begun.wheel, now.wheel))
    if begun is not None and lag_s < LAG_S:
        return replace(driving, begun=replace(begun, pedals=pedals, wheel=wheel))
    keep = math.exp(-lag_s / MEMORY_S)
    along, across = _faded(driving.along, keep), _faded(driving.across, keep)
    if begun is not None and lag_s < _LAG_MAX_S:
        along = _with_change(along, begun.along, now.along, (1.0 - pedals, lag_s, 1.0))
        turned = (1.0 - wheel, lag_s, begun.speed_m_s * now.speed_m_s)
        across = _with_change(across, begun.curvature, now.curvature, turned)
    return SteadyDriving(along=along, across=across, begun=now)


def _known(modes: Modes) -> Begun:
    """Return what the steady model knows; at rest nothing is along the track."""
    means, covariances, weights = modes
    x, P = means[STEADY], covariances[STEADY]
    speed_m_s = math.hypot(x[2], x[3])
    ux, uy = (float(x[2]) / speed_m_s, float(x[3]) / speed_m_s) if speed_m_s > 0.0 else (0.0, 0.0)
    variance = ux * ux * float(P[4, 4]) + uy * uy * float(P[5, 5]) + 2.0 * ux * uy * float(P[4, 5])
    return Begun(
        along=Known(ux * float(x[4]) + uy * float(x[5]), variance),
        curvature=Known(float(x[6]), float(P[6, 6])),
        speed_m_s=speed_m_s,
        pedals=float(weights[EASING] + weights[BRAKING]),
        wheel=float(weights[TURNING]),
    )


def _faded(watched: Watched, keep: float) -> Watched:
    return Watched(squares_m2_s4=keep * watched.squares_m2_s4, seen_s=keep * watched.seen_s)


def _with_change(watched: Watched, before: Known, now: Known, pair: tuple[float, float, float]) -> Watched:
    """Return what has been seen with another pair.

    Args:
        watched: so far.
        before: at its beginning.
        now: at its end.
        pair: probability that it counts, its length, s, and the acceleration, m/s^2, that 1 of what is known makes.
    """
    if before.variance > _SETTLED * now.variance:
        return watched
    counts, lag_s, unit_m_s2 = pair
    square = ((now.mean - before.mean) ** 2 + now.variance - before.variance) * unit_m_s2**2
    return Watched(
        squares_m2_s4=max(watched.squares_m2_s4 + counts * square, 0.0), seen_s=watched.seen_s + counts * lag_s
    )


def driven_straight(modes: Modes, t_ns: int, heading: HeadingConfig) -> Measurement:
    """Return what is known of any driver as a yaw rate that is told: how hard he turns at this speed."""
    means, _, weights = modes
    speed_m_s = max(math.hypot(*(weights @ means)[2:4].tolist()), heading.course_speed_min_m_s)
    return Measurement(
        t_ns=t_ns,
        quantity=Quantity.YAW_RATE,
        value=np.zeros(1),
        covariance=np.array([[(heading.turning_std_m_s2 / speed_m_s) ** 2]]),
    )
