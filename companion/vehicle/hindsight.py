"""How the vehicle has driven, as its data show in hindsight, and how well its speed is known meanwhile; pure.

What is known of a vehicle is as old as its data: 0.1 s over a good link, 0.6 s over a poor one. Each tenth of a second
is therefore looked back at once the data of that moment are there. A driver who changes speed time and again goes on
doing so; a departure says nothing of the driver: everybody departs. A road that has risen and fallen otherwise than
forecast goes on doing so.
"""

import math

from msgspec import Struct, field

from companion.core.data import Array, VehicleEstimate
from companion.vehicle.estimator import Estimator, EstimatorMemory
from link.records import replace

_DRIVEN_KEPT = 150  # velocities: of 15 s, five times as long as an uneven driver keeps an acceleration
_APART = 20  # velocities that are compared: 2 s, over which a fix's error counts little
_APART_MAX_S = 4.0  # farther apart there was an outage
_DEPARTED_M_S2 = 0.1  # an even driver's
_CREEPS_M_S = 0.5  # over poor data a parked vehicle seems to move by 0.3 m/s now and then

Driven = tuple[int, float, float]
"""UTC ns, and the velocity east and north at that time, m/s."""


class Driving(Struct, frozen=True, kw_only=True):
    """How a vehicle has driven in the last 15 s.

    Attributes:
        driven: its velocities, ten a second, oldest first.
        changes: mean accelerations along, m/s^2, over the 2 s before each of them, oldest first; None over an outage.
        unevenness_m_s2: root mean square of the accelerations along, without a departure that is over.
        departs_for: changes since it has left from rest, None once its speed has grown no more.
        climbs: squares of how far its velocities upwards were off what had been forecast of them `CLIMB_AHEAD_S`
            before, in standard deviations of that, oldest first; 1 on the average where these are right.
    """

    driven: tuple[Driven, ...] = ()
    changes: tuple[float | None, ...] = ()
    unevenness_m_s2: float = 0.0
    departs_for: int | None = None
    climbs: tuple[float, ...] = ()


def with_velocity(driving: Driving, t_ns: int, velocity_enu_m_s: Array) -> Driving:
    """Return the driving with the velocity (3,) in W, m/s, at `t_ns`, newest of all."""
    east_m_s, north_m_s = velocity_enu_m_s[:2].tolist()
    newest = (t_ns, east_m_s, north_m_s)
    driven = (*driving.driven, newest)[-_DRIVEN_KEPT:]
    creeps = math.hypot(east_m_s, north_m_s) < _CREEPS_M_S
    if len(driven) <= _APART:
        return replace(driving, driven=driven, departs_for=0 if creeps else driving.departs_for)
    change = _change_m_s2(driven[-1 - _APART], newest)
    changes = (*driving.changes, change)[_APART - _DRIVEN_KEPT :]
    departs_for = 0 if creeps else None if driving.departs_for is None else driving.departs_for + 1
    if departs_for is not None and not creeps and change is not None and change < _DEPARTED_M_S2:
        changes, departs_for = _without_departure(changes, min(departs_for, len(changes))), None
    return replace(
        driving,
        driven=driven,
        changes=changes,
        unevenness_m_s2=_root_mean_square([change for change in changes if change is not None]),
        departs_for=departs_for,
    )


def _without_departure(changes: tuple[float | None, ...], count: int) -> tuple[float | None, ...]:
    """Return the changes without those of the last `count` that speed up."""
    kept, departing = changes[: len(changes) - count], changes[len(changes) - count :]
    return kept + tuple(None if change is not None and change > 0.0 else change for change in departing)


def _change_m_s2(before: Driven, then: Driven) -> float | None:
    passed_s = (then[0] - before[0]) * 1e-9
    if passed_s > _APART_MAX_S:
        return None
    return (math.hypot(*then[1:]) - math.hypot(*before[1:])) / passed_s


def _root_mean_square(values: list[float]) -> float:
    return math.sqrt(sum([value * value for value in values]) / len(values)) if values else 0.0


# A drone follows the pad's climb as it was known so long ago: setpoints and data are late by 0.15 s over a good link,
# and half of the vertical acceleration is there after another 0.15 s.
CLIMB_AHEAD_S = 0.5
_PERIOD_NS = 100_000_000
_KNOWN_STD_MAX_M_S = 1.0  # of a velocity that is known: in its first second an estimate knows no acceleration
_LATENESS_MEAN_S = 1.0  # five periods of the slowest receiver
_AWAITED = 35  # instants: of 3.5 s, longer than any data are awaited
_SURE_STD_MAX_M_S = 0.3  # of a velocity that was driven; one fix's is 0.1


class Awaited(Struct, frozen=True, kw_only=True):
    """What was forecast of an instant that the vehicle's data have not reached yet.

    Attributes:
        t_ns: the instant, UTC.
        climb_m_s: the vehicle's velocity upwards.
        climb_std_m_s: its standard deviation.
    """

    t_ns: int
    climb_m_s: float
    climb_std_m_s: float


class Hindsight(Struct, frozen=True, kw_only=True):
    """What is looked back at, and what that has shown.

    Attributes:
        awaited: instants up to `CLIMB_AHEAD_S` ahead, oldest first.
        speed_std_m_s: of the newest of all; infinite while the speed is not known.
        lateness_s: age of the newest fix, a mean of the last second, for between two fixes of a receiver at 5 Hz it
            grows by 0.2 s; None before the first.
        aged_ns: when that was last so, monotonic.
        driving: how the vehicle has driven up to the instants that have been looked back at.
    """

    awaited: tuple[Awaited, ...] = ()
    speed_std_m_s: float = math.inf
    lateness_s: float | None = None
    aged_ns: int = 0
    driving: Driving = field(default_factory=Driving)


def update_hindsight(
    hindsight: Hindsight, estimator: Estimator, memory: EstimatorMemory | None, t_ns: int, *, monotonic_ns: int
) -> Hindsight:
    """Return the hindsight at `t_ns`: instants that the vehicle's data have reached are looked back at, one is added.

    Args:
        hindsight: so far.
        estimator: of the vehicle.
        memory: the estimator's own, after all that has arrived.
        t_ns: now, UTC.
        monotonic_ns: now, on the clock that is never set.
    """
    newest_ns = estimator.newest_fix_ns(memory)
    if newest_ns is None:
        return replace(hindsight, awaited=(), speed_std_m_s=math.inf)
    hindsight = _with_age(hindsight, (t_ns - newest_ns) * 1e-9, monotonic_ns)
    while hindsight.awaited and hindsight.awaited[0].t_ns <= newest_ns:
        then, *later = hindsight.awaited
        hindsight = replace(hindsight, awaited=tuple(later))
        known = estimator.estimate(memory, then.t_ns)
        if known is not None and _std_m_s(known) < _SURE_STD_MAX_M_S:
            hindsight = replace(hindsight, driving=_with_instant(hindsight.driving, then, known))
    ahead_ns = t_ns + round(CLIMB_AHEAD_S * 1e9)
    if hindsight.awaited and ahead_ns - hindsight.awaited[-1].t_ns < _PERIOD_NS:
        return hindsight
    now, ahead = estimator.estimate(memory, t_ns), estimator.estimate(memory, ahead_ns)
    std_m_s = math.inf if now is None else _std_m_s(now)
    if ahead is None or std_m_s >= _KNOWN_STD_MAX_M_S:
        return replace(hindsight, speed_std_m_s=math.inf)
    awaited = Awaited(t_ns=ahead_ns, climb_m_s=float(ahead.velocity_enu_m_s[2]), climb_std_m_s=climb_std_m_s(ahead))
    return replace(hindsight, awaited=(*hindsight.awaited, awaited)[-_AWAITED:], speed_std_m_s=std_m_s)


def _with_instant(driving: Driving, then: Awaited, known: VehicleEstimate) -> Driving:
    """Return the driving with an instant that the vehicle's data have reached, newest of all."""
    off = (float(known.velocity_enu_m_s[2]) - then.climb_m_s) / then.climb_std_m_s
    driving = replace(driving, climbs=(*driving.climbs, off * off)[-_DRIVEN_KEPT:])
    return with_velocity(driving, then.t_ns, known.velocity_enu_m_s)


def climb_std_m_s(estimate: VehicleEstimate) -> float:
    """Return the standard deviation of the velocity upwards, which no receiver tells to a millimetre a second."""
    return math.sqrt(max(float(estimate.covariance[5, 5]), 1e-6))


def _with_age(hindsight: Hindsight, age_s: float, monotonic_ns: int) -> Hindsight:
    before_s = hindsight.lateness_s
    if before_s is None:
        return replace(hindsight, lateness_s=age_s, aged_ns=monotonic_ns)
    share = -math.expm1(-(monotonic_ns - hindsight.aged_ns) * 1e-9 / _LATENESS_MEAN_S)
    return replace(hindsight, lateness_s=before_s + share * (age_s - before_s), aged_ns=monotonic_ns)


def forget_instants(hindsight: Hindsight) -> Hindsight:
    """Return the hindsight after UTC was set: the instants have lost their time."""
    return replace(hindsight, awaited=(), driving=replace(hindsight.driving, driven=(), changes=()))


def _std_m_s(estimate: VehicleEstimate) -> float:
    return math.sqrt(max(float(estimate.covariance[3, 3] + estimate.covariance[4, 4]), 0.0))  # rounding
