"""What each mode wants the flight controller to follow."""

from dataclasses import dataclass
from enum import Enum
from math import hypot

import numpy as np

from link.messages import Vector3
from link.records import replace
from sim_autopilot.core.data import Array, Reference
from sim_autopilot.core.modes import Mode, Modes
from sim_autopilot.core.settings import FlightSettings
from sim_autopilot.flight.follow import Chase
from sim_autopilot.flight.orbit import Orbit, carry_round
from sim_autopilot.flight.target_stages import TargetLanding
from sim_autopilot.flight.travel import Goal, Pace, move
from sim_autopilot.plant.snapshot import Snapshot
from sim_autopilot.setpoints.partial import with_own_motion
from sim_autopilot.setpoints.setpoints import Setpoints

_SINKING_M_S2 = 1.0
"""With which a descent begins."""
_PRESS_M = 1.0
"""How far the descending reference runs ahead of a drone that cannot sink."""
_REACHED_M = 0.5
_LOW_M = 0.3
"""Above home: no return is lower (ArduCopter RTL_ALT_MIN)."""
RETURNING = frozenset({Mode.RTL, Mode.SMART_RTL})


class Leg(Enum):
    """The stages of a landing or a return."""

    BRAKE = 0
    CLIMB = 1
    CROSS = 2
    STAY = 3
    DESCEND = 4


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ModeFlight:
    """What the present mode remembers.

    Attributes:
        began_ns: since boot; of the leg, where it stays over home.
        start_enu_m: (3,) where it began.
        velocity_enu_m_s: (3,) with which it began.
        stop_s: how long it brakes.
        anchor: what it keeps to after that: a place, zero velocity, and the heading it began with.
        leg: of LAND, RTL and a lost link.
        sinking_m: height of the descending reference.
        sink_m_s: its rate.
        goal: where the anchor is on its way to.
        orbit: the circle that it flies.
        chase: what it remembers of whom it follows.
        target_landing: the stages of a precision landing.
        speed_m_s: that was asked for, for every way of the mode; None is the parameters'.
        returns: whether a mission's mode flies home and lands.
    """

    began_ns: int
    start_enu_m: Array
    velocity_enu_m_s: Array
    stop_s: float
    anchor: Reference
    leg: Leg = Leg.BRAKE
    sinking_m: float = 0.0
    sink_m_s: float = 0.0
    goal: Goal | None = None
    orbit: Orbit | None = None
    chase: Chase | None = None
    target_landing: TargetLanding | None = None
    speed_m_s: float | None = None
    returns: bool = False


def begin(mode: Mode, now: Snapshot, home_enu_m: Vector3, settings: FlightSettings) -> ModeFlight:
    """Return the memory of a mode that begins."""
    start, velocity = np.array(now.position_enu_m), np.array(now.velocity_enu_m_s)
    stop_s = hypot(*now.velocity_enu_m_s) / settings.envelope.braking_m_s2
    place = start + 0.5 * stop_s * velocity
    leg = Leg.BRAKE
    if mode is Mode.TAKEOFF:
        place[2] = start[2] + settings.takeoff.height_m
    elif mode in RETURNING and _distance_m(now, home_enu_m) >= settings.returning.distance_m:
        place[2] = max(place[2], home_enu_m[2] + _return_height_m(now, home_enu_m, settings))
        leg = Leg.CLIMB
    anchor = Reference(
        position_enu_m=place,
        velocity_enu_m_s=np.zeros(3),
        acceleration_enu_m_s2=None,
        yaw_rad=now.yaw_rad,
        yaw_rate_rad_s=0.0,
    )
    return ModeFlight(
        began_ns=now.boot_ns, start_enu_m=start, velocity_enu_m_s=velocity, stop_s=stop_s, anchor=anchor, leg=leg
    )


def next_reference(
    flight: ModeFlight,
    modes: Modes,
    now: Snapshot,
    *,
    setpoints: Setpoints,
    home_enu_m: Vector3,
    settings: FlightSettings,
    elapsed_s: float,
) -> tuple[ModeFlight, Reference | None]:
    """Return the mode's memory and what to follow for the next `elapsed_s`."""
    mode = modes.mode
    if mode is Mode.OFFBOARD:
        return flight, None if setpoints.reference is None else with_own_motion(setpoints.reference, now)
    if mode in RETURNING or flight.returns:
        flight = _return(flight, now, home_enu_m, settings)
    if mode is Mode.ORBIT and flight.orbit is not None:
        orbit, reference = carry_round(flight.orbit, pace_of(settings), elapsed_s)
        return replace(flight, orbit=orbit), reference
    since_s = (now.boot_ns - flight.began_ns) * 1e-9
    if flight.goal is None and since_s < flight.stop_s:
        return flight, _brake(flight, since_s)
    if flight.leg is Leg.BRAKE and (mode is Mode.LAND or (mode is Mode.POSITION and modes.failsafe)):
        flight = descend_here(flight, now)
    if flight.leg is Leg.DESCEND:
        return descend(flight, now, home_enu_m, settings, elapsed_s)
    if flight.goal is not None:
        flight = replace(flight, anchor=move(flight.anchor, flight.goal, pace_of(settings), elapsed_s))
    return flight, flight.anchor


def pace_of(settings: FlightSettings) -> Pace:
    """Return how fast places are approached."""
    limits = settings.path
    return Pace(
        speed_m_s=settings.envelope.speed_max_m_s,
        climb_m_s=settings.envelope.climb_max_m_s if limits is None else limits.climb_m_s,
        descent_m_s=settings.envelope.descent_max_m_s if limits is None else limits.descent_m_s,
        acceleration_m_s2=settings.envelope.braking_m_s2,
    )


def go_to(flight: ModeFlight, goal: Goal, now: Snapshot) -> ModeFlight:
    """Return the memory of a flight on its way to `goal`, from where it is; one under way goes on from its anchor."""
    if flight.goal == goal and flight.leg is Leg.CROSS:
        return flight
    anchor = flight.anchor
    if flight.goal is None or flight.leg is not Leg.CROSS:
        anchor = replace(
            anchor, position_enu_m=np.array(now.position_enu_m), velocity_enu_m_s=np.array(now.velocity_enu_m_s)
        )
    return replace(flight, anchor=anchor, goal=goal, leg=Leg.CROSS)


def climb_to(flight: ModeFlight, height_m: float, now: Snapshot) -> ModeFlight:
    """Return the memory of a flight that climbs where it is, to `height_m` in W, off the ground too."""
    place = np.array((*now.position_enu_m[:2], max(height_m, now.position_enu_m[2])))
    anchor = replace(flight.anchor, position_enu_m=place, velocity_enu_m_s=np.zeros(3), yaw_rad=now.yaw_rad)
    return replace(flight, anchor=anchor, goal=None, stop_s=0.0, leg=Leg.CLIMB)


def descend_here(flight: ModeFlight, now: Snapshot) -> ModeFlight:
    """Return the memory of a flight that lands at its goal, or without one under its anchor."""
    anchor = flight.anchor
    if flight.goal is not None:
        anchor = replace(anchor, position_enu_m=np.array(flight.goal.position_enu_m))
    return replace(
        flight, leg=Leg.DESCEND, anchor=anchor, goal=None, stop_s=0.0, sinking_m=now.position_enu_m[2], sink_m_s=0.0
    )


def is_takeoff_complete(flight: ModeFlight, now: Snapshot, settings: FlightSettings) -> bool:
    """Return whether a drone in the take-off mode has come near its height, to which the hold after it goes on."""
    target = flight.anchor.position_enu_m
    return target is not None and now.position_enu_m[2] > float(target[2]) - settings.travel.reached_height_m


def _brake(flight: ModeFlight, since_s: float) -> Reference:
    deceleration = flight.velocity_enu_m_s / flight.stop_s
    return replace(
        flight.anchor,
        position_enu_m=flight.start_enu_m + since_s * flight.velocity_enu_m_s - 0.5 * since_s**2 * deceleration,
        velocity_enu_m_s=flight.velocity_enu_m_s - since_s * deceleration,
        acceleration_enu_m_s2=-deceleration,
    )


def _return(flight: ModeFlight, now: Snapshot, home_enu_m: Vector3, settings: FlightSettings) -> ModeFlight:
    height_m = float(_position(flight.anchor)[2])
    if flight.leg is Leg.BRAKE or (flight.leg is Leg.CLIMB and now.position_enu_m[2] > height_m - _REACHED_M):
        home = (home_enu_m[0], home_enu_m[1], height_m)
        return go_to(
            flight, Goal(position_enu_m=home, speed_m_s=settings.returning.speed_m_s or settings.travel.cruise_m_s), now
        )
    if flight.leg is Leg.CROSS and _distance_m(now, home_enu_m) < _REACHED_M:
        return replace(flight, leg=Leg.STAY, began_ns=now.boot_ns)
    if flight.leg is Leg.STAY and (now.boot_ns - flight.began_ns) * 1e-9 >= settings.returning.stay_s:
        return descend_here(flight, now)
    return flight


def _return_height_m(now: Snapshot, home_enu_m: Vector3, settings: FlightSettings) -> float:
    """Above home; within the cone it climbs less."""
    least_m = max(_LOW_M, now.position_enu_m[2] - home_enu_m[2] + settings.returning.climb_m)
    height_m = max(settings.returning.height_m, least_m)
    if settings.returning.slope <= 0.0:
        return height_m
    return min(height_m, max(settings.returning.slope * _distance_m(now, home_enu_m), least_m))


def descend(
    flight: ModeFlight, now: Snapshot, home_enu_m: Vector3, settings: FlightSettings, elapsed_s: float
) -> tuple[ModeFlight, Reference]:
    """Return the memory of a landing and what to follow for the next `elapsed_s`: sinking at its anchor."""
    low = now.position_enu_m[2] - home_enu_m[2] < settings.land.slow_below_m
    rate_m_s = settings.land.descent_m_s if low else settings.land.approach_m_s
    change_m_s = _SINKING_M_S2 * elapsed_s
    sink_m_s = flight.sink_m_s + max(-change_m_s, min(change_m_s, rate_m_s - flight.sink_m_s))
    sinking_m = max(flight.sinking_m - sink_m_s * elapsed_s, now.position_enu_m[2] - _PRESS_M)
    x, y, _ = _position(flight.anchor)
    reference = replace(
        flight.anchor,
        position_enu_m=np.array((x, y, sinking_m)),
        velocity_enu_m_s=np.array((0.0, 0.0, -sink_m_s)),
    )
    return replace(flight, sinking_m=sinking_m, sink_m_s=sink_m_s), reference


def _position(anchor: Reference) -> Array:
    if anchor.position_enu_m is None:
        raise ValueError("an anchor has a position")
    return anchor.position_enu_m


def _distance_m(now: Snapshot, home_enu_m: Vector3) -> float:
    return hypot(now.position_enu_m[0] - home_enu_m[0], now.position_enu_m[1] - home_enu_m[1])
