"""How the vehicle has driven lately; pure.

A driver who changes speed time and again goes on doing so. That shows in the velocities that were driven. A departure
that is over says nothing of the driver: everybody departs.
"""

import math

from msgspec import Struct

from companion.core.data import Array
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
    """

    driven: tuple[Driven, ...] = ()
    changes: tuple[float | None, ...] = ()
    unevenness_m_s2: float = 0.0
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
    if departs_for is not None and not creeps and change is not None and change < _DEPARTED_M_S2:
        changes, departs_for = _without_departure(changes, min(departs_for, len(changes))), None
    return Driving(
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
