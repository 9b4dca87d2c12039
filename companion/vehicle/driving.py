"""How the vehicle has driven lately, and whether it has done what its data did not let expect, told in hindsight; pure.

**Surprise.** What is known of a vehicle is as old as its data: 0.1 s over a good link, 0.6 s over a poor one. What it
does meanwhile is a guess, which can be checked once the data of that moment are there. A guess that was off by nearly
the speed that a contact may have against the pad means that a contact at that moment would have been too fast. A
vehicle that has braked or started like that will again (a bus, a queue of cars), so it is landed on only while it
stands, or has driven for some time as expected. Over late data it has to stand for some time, too, or it drives again
before that is told. Only its speed is asked about. With fresh data even an emergency brake surprises by little, but
it takes the drone half a second to brake as hard: a vehicle that is seen to brake hard counts as one that has
surprised.

**Driving.** A driver who changes speed time and again surprises by less each time than one who brakes, but goes on
doing so: by 0.3 m/s in the half second that poor data are late for one of 0.8 m/s^2, of which the tails do the harm.
So does a road that bends one way and the other: a curve that is known may last, but where the next one begins, with a
radius of 16 m at 7 m/s, the vehicle is 1.6 m/s off to the side when that is told; and in the sharpest curves a drone
leans so far that it has to come level at the right tenth of a second. All of these show in the velocities that were
driven, long before a belief of the vehicle's speed is found to be wrong. A departure that is over says nothing of the
driver: everybody departs.
"""

import math

from msgspec import Struct, field

from companion.config.descent import UnevenConfig
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

Change = tuple[float, float]
"""The mean acceleration along and to the left from one such velocity to one 2 s later, m/s^2."""


class Driving(Struct, frozen=True, kw_only=True):
    """How a vehicle has driven in the last 15 s.

    Attributes:
        driven: its velocities, ten a second, oldest first.
        changes: up to each of them that has one 2 s before it, oldest first; None over an outage.
        unevenness_m_s2: root mean square of the accelerations along, without a departure that is over.
        winding_m_s2: likewise, of how the acceleration to the left differs from the one 2 s before.
        departs_for: changes since it has left from rest, None once its speed has grown no more.
    """

    driven: tuple[Driven, ...] = ()
    changes: tuple[Change | None, ...] = ()
    unevenness_m_s2: float = 0.0
    winding_m_s2: float = 0.0
    departs_for: int | None = None


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
    if departs_for is not None and not creeps and change is not None and change[0] < _DEPARTED_M_S2:
        changes, departs_for = _without_departure(changes, min(departs_for, len(changes))), None
    along_m_s2 = [change[0] for change in changes if change is not None]
    bends_m_s2 = [
        later[1] - before[1]
        for before, later in zip(changes, changes[_APART:], strict=False)
        if before is not None and later is not None
    ]
    return Driving(
        driven=driven,
        changes=changes,
        unevenness_m_s2=_root_mean_square(along_m_s2),
        winding_m_s2=_root_mean_square(bends_m_s2),
        departs_for=departs_for,
    )


def _without_departure(changes: tuple[Change | None, ...], count: int) -> tuple[Change | None, ...]:
    """Return the changes without those of the last `count` that speed up."""
    kept, departing = changes[: len(changes) - count], changes[len(changes) - count :]
    return kept + tuple(None if change is not None and change[0] > 0.0 else change for change in departing)


def brakes_hard(driving: Driving, config: UnevenConfig) -> bool:
    """Return whether the vehicle has just braked as hard as the drone, above the pad, follows too late."""
    newest = driving.changes[-1] if driving.changes else None
    return newest is not None and newest[0] < -config.hard_brake_m_s2


def _speeds_up_hard(driving: Driving, config: UnevenConfig) -> bool:
    """Return whether the vehicle has just sped up as hard as it would have to brake to be waited above."""
    newest = driving.changes[-1] if driving.changes else None
    return newest is not None and newest[0] > config.hard_brake_m_s2


def drives_unevenly(driving: Driving, lateness_s: float | None, config: UnevenConfig) -> bool:
    """Return whether a vehicle, whose fixes are `lateness_s` old, will have changed its speed by when that is told.

    Over fresh data it does not matter.
    """
    return _is_late(lateness_s, config) and driving.unevenness_m_s2 > config.acceleration_m_s2


def winds(driving: Driving, lateness_s: float | None, config: UnevenConfig) -> bool:
    """Return whether the road of such a vehicle will have bent by when that is told, likewise."""
    return _is_late(lateness_s, config) and driving.winding_m_s2 > config.winding_acceleration_m_s2


def turns_hard(driving: Driving, lateness_s: float | None, config: UnevenConfig) -> bool:
    """Return whether such a vehicle turns harder than the drone, over such links, comes level in time to touch it."""
    newest = driving.changes[-1] if driving.changes else None
    is_hard = newest is not None and abs(newest[1]) > config.turning_acceleration_m_s2
    return is_hard and _is_late(lateness_s, config)


def may_depart(driving: Driving, lateness_s: float | None, config: UnevenConfig) -> bool:
    """Return whether such a vehicle, which has just stopped, will have departed by when that is told, likewise."""
    return _is_late(lateness_s, config) and _stood_s(driving) < config.stop_s


def _stood_s(driving: Driving) -> float:
    """Return for how long the data show the vehicle standing, infinite where they show nothing else."""
    if not driving.driven:
        return math.inf
    moved_ns = next((t_ns for t_ns, *v_m_s in reversed(driving.driven) if math.hypot(*v_m_s) > _CREEPS_M_S), None)
    return math.inf if moved_ns is None else (driving.driven[-1][0] - moved_ns) * 1e-9


def _is_late(lateness_s: float | None, config: UnevenConfig) -> bool:
    return lateness_s is not None and lateness_s > config.age_s


def _change_m_s2(before: Driven, then: Driven) -> Change | None:
    passed_s = (then[0] - before[0]) * 1e-9
    if passed_s > _APART_MAX_S:
        return None
    speed_m_s, later_m_s = math.hypot(*before[1:]), math.hypot(*then[1:])
    turned_rad = math.atan2(before[1] * then[2] - before[2] * then[1], before[1] * then[1] + before[2] * then[2])
    # By the lower speed: a vehicle that departs has had no direction before.
    return (later_m_s - speed_m_s) / passed_s, min(speed_m_s, later_m_s) * turned_rad / passed_s


def _root_mean_square(values: list[float]) -> float:
    return math.sqrt(sum([value * value for value in values]) / len(values)) if values else 0.0


_BELIEF_PERIOD_NS = 100_000_000
_KNOWN_STD_MAX_M_S = 1.0  # of a velocity that is a belief: in its first second an estimate knows no acceleration
_SURPRISE_STDS = 2.5  # less was said to be possible: through an outage of 2 s a belief is off by 1 m/s
_LATENESS_MEAN_S = 1.0  # five periods of the slowest receiver
_KEPT = 30  # beliefs: of 3 s, longer than any data are awaited
_SURE_STD_MAX_M_S = 0.3  # of a velocity that was driven; one fix's is 0.1

Belief = tuple[int, float, float]
"""UTC ns, the horizontal speed that was believed then, m/s, and its standard deviation, m/s."""


class Surprise(Struct, frozen=True, kw_only=True):
    """What has been believed of the vehicle's speed, and when that was last found to be wrong.

    Attributes:
        beliefs: not checked yet, oldest first.
        speed_std_m_s: of the newest of all; infinite while the speed is not known.
        lateness_s: age of the newest fix, a mean of the last second, for between two fixes of a receiver at 5 Hz it
            grows by 0.2 s; None before the first.
        aged_ns: when that was last so, monotonic.
        surprised_ns: when the newest wrong one was held, monotonic; None when none was.
        driving: how it has driven up to the times of the beliefs that have been checked.
    """

    beliefs: tuple[Belief, ...] = ()
    speed_std_m_s: float = math.inf
    lateness_s: float | None = None
    aged_ns: int = 0
    surprised_ns: int | None = None
    driving: Driving = field(default_factory=Driving)


def update_surprise(
    surprise: Surprise,
    estimator: Estimator,
    memory: EstimatorMemory | None,
    t_ns: int,
    *,
    monotonic_ns: int,
    config: UnevenConfig,
) -> Surprise:
    """Return the surprise at `t_ns`: beliefs are checked whose time the vehicle's data have reached, and one is added.

    Args:
        surprise: so far.
        estimator: of the vehicle.
        memory: the estimator's own, after all that has arrived.
        t_ns: now, UTC.
        monotonic_ns: now, on the clock that is never set.
        config: what counts as wrong.
    """
    newest_ns = estimator.newest_fix_ns(memory)
    if newest_ns is None:
        return replace(surprise, beliefs=(), speed_std_m_s=math.inf)
    surprise = _with_age(surprise, (t_ns - newest_ns) * 1e-9, monotonic_ns)
    while surprise.beliefs and surprise.beliefs[0][0] <= newest_ns:
        (then_ns, speed_m_s, std_m_s), *later = surprise.beliefs
        surprise = replace(surprise, beliefs=tuple(later))
        known = estimator.estimate(memory, then_ns)
        if known is None or not _is_known(known):
            continue
        faster_m_s = _speed_m_s(known) - speed_m_s
        is_sure = _std_m_s(known) < _SURE_STD_MAX_M_S
        if is_sure:
            surprise = replace(surprise, driving=with_velocity(surprise.driving, then_ns, known.velocity_enu_m_s))
        # To depart so once more it has to stop first, and over fresh data that surprises by itself if it is as hard.
        departs = faster_m_s > 0.0 or _speeds_up_hard(surprise.driving, config)
        counts = not departs or _is_late(surprise.lateness_s, config)
        is_wrong = counts and abs(faster_m_s) > max(config.surprise_speed_m_s, _SURPRISE_STDS * std_m_s)
        if is_wrong or (is_sure and brakes_hard(surprise.driving, config)):
            wrong_ns, before_ns = then_ns - t_ns + monotonic_ns, surprise.surprised_ns
            surprise = replace(surprise, surprised_ns=wrong_ns if before_ns is None else max(wrong_ns, before_ns))
    if surprise.beliefs and t_ns - surprise.beliefs[-1][0] < _BELIEF_PERIOD_NS:
        return surprise
    now = estimator.estimate(memory, t_ns)
    if now is None or not _is_known(now):
        return replace(surprise, speed_std_m_s=math.inf)
    std_m_s = _std_m_s(now)
    beliefs = (*surprise.beliefs, (t_ns, _speed_m_s(now), std_m_s))[-_KEPT:]
    return replace(surprise, beliefs=beliefs, speed_std_m_s=std_m_s)


def _with_age(surprise: Surprise, age_s: float, monotonic_ns: int) -> Surprise:
    before_s = surprise.lateness_s
    if before_s is None:
        return replace(surprise, lateness_s=age_s, aged_ns=monotonic_ns)
    share = -math.expm1(-(monotonic_ns - surprise.aged_ns) * 1e-9 / _LATENESS_MEAN_S)
    return replace(surprise, lateness_s=before_s + share * (age_s - before_s), aged_ns=monotonic_ns)


def forget_beliefs(surprise: Surprise) -> Surprise:
    """Return the surprise after UTC was set: what was believed has lost its time."""
    return replace(surprise, beliefs=(), driving=replace(surprise.driving, driven=(), changes=()))


def may_surprise(surprise: Surprise, monotonic_ns: int, config: UnevenConfig) -> bool:
    """Return whether a driving vehicle is to be expected to do at `monotonic_ns` what it has done."""
    since_ns = surprise.surprised_ns
    return since_ns is not None and (monotonic_ns - since_ns) * 1e-9 < config.hold_s


def _speed_m_s(estimate: VehicleEstimate) -> float:
    return math.hypot(*estimate.velocity_enu_m_s[:2].tolist())


def _is_known(estimate: VehicleEstimate) -> bool:
    return _std_m_s(estimate) < _KNOWN_STD_MAX_M_S


def _std_m_s(estimate: VehicleEstimate) -> float:
    return math.sqrt(max(float(estimate.covariance[3, 3] + estimate.covariance[4, 4]), 0.0))  # rounding
