"""Learns how steadily a vehicle is driven while nothing new begins: the noise of the filter's steady model; pure.

The steady model takes the acceleration along the track, and the one across it that turns the vehicle, for random walks.
How fast these walk differs by more than a hundred times from a ship or a motorway to a driver in town, and decides how
far the vehicle may be from where data that are some tenths of a second old have it. Over pairs that lie a lag apart the
sum of the squares by which each has changed fades with `MEMORY_S`; it is added to that of an ordinary driver who was
watched for `PRIOR_S`, which stays. The filter's mean changes with what it learns as well, by as much as its variance
falls: for a filter that is right the square of a change is q T + P(before) - P(now), as its changes are independent of
all before.
A pair counts with the probability that no manoeuvre, which has a model of its own, has begun in it.
Source: Mehra 1972 (adaptive filtering by covariance matching).
"""

import math
from typing import NamedTuple

from msgspec import Struct

from companion.config.estimation import ImmConfig
from companion.vehicle.imm_mixing import Modes
from link.records import replace

MEMORY_S = 60.0  # longer than a landing; a driver in town is another one on the road out
PRIOR_S = 10.0  # a curve or two
LAG_S = 1.0  # twice what a filter needs that fixes of 0.1 m ten times a second tell the acceleration
_SETTLED = 2.0  # times its variance now: before, a filter knew too little yet for a change of its mean to tell anything
_EASING, _BRAKING, _TURNING = 1, 2, 3  # among the modes


class Axis(Struct, frozen=True, kw_only=True):
    """What has been seen along the track, or across it.

    Attributes:
        squares_m2_s4: sum of the squared changes.
        seen_s: over how much time.
        mean: acceleration along, m/s^2, or curvature, 1/m, when the present pair began.
        variance: of it; infinite before the first.
        disturbed: probability that a pedal, or the wheel, was moved anew since then.
    """

    squares_m2_s4: float = 0.0
    seen_s: float = 0.0
    mean: float = 0.0
    variance: float = math.inf
    disturbed: float = 0.0

    def psd_m2_s5(self, ordinary_m2_s5: float) -> float:
        """Return how fast the acceleration walks, given how fast an ordinary driver's does."""
        # A few pairs of a vague filter whose doubt has shrunk may add up to less than nothing.
        return (PRIOR_S * ordinary_m2_s5 + max(self.squares_m2_s4, 0.0)) / (PRIOR_S + self.seen_s)


class SteadyDriving(Struct, frozen=True, kw_only=True):
    """What has been seen of a vehicle's driving.

    Attributes:
        along: the track.
        across: it.
        passed_s: since the present pair began.
    """

    along: Axis = Axis()
    across: Axis = Axis()
    passed_s: float = 0.0

    def psd_m2_s5(self, ordinary_m2_s5: tuple[float, float]) -> tuple[float, float]:
        """Return how fast the accelerations along the track and across it walk, given an ordinary driver's."""
        along_m2_s5, across_m2_s5 = ordinary_m2_s5
        return self.along.psd_m2_s5(along_m2_s5), self.across.psd_m2_s5(across_m2_s5)


def passed(driving: SteadyDriving, dt_s: float) -> SteadyDriving:
    """Return the driving `dt_s` later."""
    return replace(driving, passed_s=driving.passed_s + dt_s)


def learn(driving: SteadyDriving, modes: Modes, config: ImmConfig) -> SteadyDriving:
    """Return the driving after a fix or a velocity; only what the vehicle does while it drives tells anything.

    Args:
        driving: so far.
        modes: of the filter, the steady one first.
        config: of the filter.
    """
    means, covariances, weights = modes
    pedals, wheel = float(weights[_EASING] + weights[_BRAKING]), float(weights[_TURNING])
    x, P = means[0], covariances[0]
    speed_m_s, lag_s = math.hypot(x[2], x[3]), driving.passed_s
    if speed_m_s < config.heading.curvature_speed_min_m_s:
        return replace(driving, along=_without_pair(driving.along), across=_without_pair(driving.across))
    along, across = _disturbed(driving.along, pedals), _disturbed(driving.across, wheel)
    if lag_s < LAG_S:
        return replace(driving, along=along, across=across)
    if lag_s > 2.0 * LAG_S:  # what a vehicle has done in a silence nobody knows
        along, across = _without_pair(along), _without_pair(across)
    ux, uy = float(x[2]) / speed_m_s, float(x[3]) / speed_m_s
    left = math.exp(-lag_s / config.acceleration_decay_s)
    pulled = _Now(
        mean=ux * float(x[4]) + uy * float(x[5]),
        variance=ux * ux * float(P[4, 4]) + uy * uy * float(P[5, 5]) + 2.0 * ux * uy * float(P[4, 5]),
        left=left,
        walked_s=0.5 * config.acceleration_decay_s * (1.0 - left * left),  # what fades has walked less
        unit_m_s2=1.0,
        disturbed=pedals,
    )
    steered = _Now(float(x[6]), float(P[6, 6]), 1.0, lag_s, speed_m_s**2, wheel)
    keep = math.exp(-lag_s / MEMORY_S)
    return SteadyDriving(along=_changed(along, pulled, keep), across=_changed(across, steered, keep))


class _Now(NamedTuple):
    """What is known at the end of a pair.

    Attributes:
        mean: acceleration along the track, m/s^2, or curvature of it, 1/m.
        variance: of it.
        left: what would be left of the one at the beginning if nothing had walked.
        walked_s: for how long it has walked.
        unit_m_s2: the acceleration that 1 is.
        disturbed: probability that a pedal, or the wheel, is moved anew just now.
    """

    mean: float
    variance: float
    left: float
    walked_s: float
    unit_m_s2: float
    disturbed: float


def _without_pair(axis: Axis) -> Axis:
    return replace(axis, variance=math.inf)


def _disturbed(axis: Axis, probability: float) -> Axis:
    return replace(axis, disturbed=max(axis.disturbed, probability))


def _changed(axis: Axis, now: _Now, keep: float) -> Axis:
    """Return what has been seen with the present pair, at whose end the next one begins; `keep` is left of the rest."""
    before = now.left**2 * axis.variance
    squares_m2_s4, seen_s = keep * axis.squares_m2_s4, keep * axis.seen_s
    if before < _SETTLED * now.variance:
        counts = 1.0 - axis.disturbed
        squared = (now.mean - now.left * axis.mean) ** 2 + now.variance - before
        squares_m2_s4 += counts * squared * now.unit_m_s2**2
        seen_s += counts * now.walked_s
    return Axis(
        squares_m2_s4=squares_m2_s4,
        seen_s=seen_s,
        mean=now.mean,
        variance=now.variance,
        disturbed=now.disturbed,
    )
