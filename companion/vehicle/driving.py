"""How the vehicle has driven lately; pure.

A driver who changes speed time and again surprises by less each time than one who brakes, but goes on
doing so: by 0.3 m/s in the half second that poor data are late for one of 0.8 m/s^2, of which the tails do the harm.
So does a road that bends one way and the other: a curve that is known may last, but where the next one begins, with a
radius of 16 m at 7 m/s, the vehicle is 1.6 m/s off to the side when that is told; and in the sharpest curves a drone
leans so far that it has to come level at the right tenth of a second. All of these show in the velocities that were
driven, long before a belief of the vehicle's speed is found to be wrong. A departure that is over says nothing of the
driver: everybody departs.
"""

import math

from msgspec import Struct

from companion.config.descent import UnevenConfig
from companion.core.data import Array
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


def speeds_up_hard(driving: Driving, config: UnevenConfig) -> bool:
    """Return whether the vehicle has just sped up as hard as it would have to brake to be waited above."""
    newest = driving.changes[-1] if driving.changes else None
    return newest is not None and newest[0] > config.hard_brake_m_s2


def drives_unevenly(driving: Driving, lateness_s: float | None, config: UnevenConfig) -> bool:
    """Return whether a vehicle, whose fixes are `lateness_s` old, will have changed its speed by when that is told.

    Over fresh data it does not matter.
    """
    return is_late(lateness_s, config) and driving.unevenness_m_s2 > config.acceleration_m_s2


def winds(driving: Driving, lateness_s: float | None, config: UnevenConfig) -> bool:
    """Return whether the road of such a vehicle will have bent by when that is told, likewise."""
    return is_late(lateness_s, config) and driving.winding_m_s2 > config.winding_acceleration_m_s2


def turns_hard(driving: Driving, lateness_s: float | None, config: UnevenConfig) -> bool:
    """Return whether such a vehicle turns harder than the drone, over such links, comes level in time to touch it."""
    newest = driving.changes[-1] if driving.changes else None
    is_hard = newest is not None and abs(newest[1]) > config.turning_acceleration_m_s2
    return is_hard and is_late(lateness_s, config)


def may_depart(driving: Driving, lateness_s: float | None, config: UnevenConfig) -> bool:
    """Return whether such a vehicle, which has just stopped, will have departed by when that is told, likewise."""
    return is_late(lateness_s, config) and _stood_s(driving) < config.stop_s


def _stood_s(driving: Driving) -> float:
    """Return for how long the data show the vehicle standing, infinite where they show nothing else."""
    if not driving.driven:
        return math.inf
    moved_ns = next((t_ns for t_ns, *v_m_s in reversed(driving.driven) if math.hypot(*v_m_s) > _CREEPS_M_S), None)
    return math.inf if moved_ns is None else (driving.driven[-1][0] - moved_ns) * 1e-9


def is_late(lateness_s: float | None, config: UnevenConfig) -> bool:
    """Return whether data whose fixes are `lateness_s` old tell too late what the vehicle does."""
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
