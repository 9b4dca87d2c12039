"""What each mode wants the flight controller to follow."""

from dataclasses import dataclass, replace
from enum import Enum
from math import hypot

import numpy as np

from link.messages import Vector3
from sim_autopilot.data import Array, Reference
from sim_autopilot.modes import Mode, Modes
from sim_autopilot.setpoints import Setpoints
from sim_autopilot.settings import FlightSettings
from sim_autopilot.snapshot import Snapshot

_BRAKING_M_S2 = 3.0
"""Deceleration to a stop (PX4 MPC_ACC_HOR)."""
_SINKING_M_S2 = 1.0
"""With which a descent begins."""
_LOW_M = 5.0
"""Below this height above home a landing goes at its final rate (PX4 MPC_LAND_ALT2)."""
_PRESS_M = 1.0
"""How far the descending reference runs ahead of a drone that cannot sink."""
_REACHED_M = 0.5


class Leg(Enum):
    """The stages of a landing or a return."""

    BRAKE = 0
    CLIMB = 1
    CROSS = 2
    DESCEND = 3


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ModeFlight:
    """What the present mode remembers.

    Attributes:
        began_ns: since boot.
        start_enu_m: (3,) where it began.
        velocity_enu_m_s: (3,) with which it began.
        stop_s: how long it brakes.
        anchor: what it keeps to after that: a place, zero velocity, and the heading it began with.
        leg: of LAND, RTL and a lost link.
        sinking_m: height of the descending reference.
        sink_m_s: its rate.
    """

    began_ns: int
    start_enu_m: Array
    velocity_enu_m_s: Array
    stop_s: float
    anchor: Reference
    leg: Leg = Leg.BRAKE
    sinking_m: float = 0.0
    sink_m_s: float = 0.0


def begin(mode: Mode, now: Snapshot, home_enu_m: Vector3, settings: FlightSettings) -> ModeFlight:
    """Return the memory of a mode that begins."""
    start, velocity = np.array(now.position_enu_m), np.array(now.velocity_enu_m_s)
    stop_s = hypot(*now.velocity_enu_m_s) / _BRAKING_M_S2
    place = start + 0.5 * stop_s * velocity
    leg = Leg.BRAKE
    if mode is Mode.TAKEOFF:
        place[2] = max(place[2], home_enu_m[2] + settings.takeoff_height_m)
    elif mode is Mode.RTL and _distance_m(now, home_enu_m) >= settings.return_distance_m:
        place[2] = max(place[2], home_enu_m[2] + settings.return_height_m)
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
        return flight, setpoints.reference
    since_s = (now.boot_ns - flight.began_ns) * 1e-9
    if since_s < flight.stop_s:
        return flight, _braking(flight, since_s)
    if mode is Mode.RTL:
        flight = _return(flight, now, home_enu_m)
    elif flight.leg is Leg.BRAKE and (mode is Mode.LAND or (mode is Mode.POSITION and modes.failsafe)):
        flight = _start_descent(flight, now)
    if flight.leg is Leg.DESCEND:
        low = now.position_enu_m[2] - home_enu_m[2] < _LOW_M
        rate_m_s = settings.land_descent_m_s if low else settings.descent_max_m_s
        return _descend(flight, now, rate_m_s, elapsed_s)
    return flight, flight.anchor


def is_takeoff_complete(flight: ModeFlight, now: Snapshot) -> bool:
    """Return whether a drone in the take-off mode has come to its height."""
    target = flight.anchor.position_enu_m
    return target is not None and now.position_enu_m[2] > float(target[2]) - _REACHED_M / 2.0


def _braking(flight: ModeFlight, since_s: float) -> Reference:
    deceleration = flight.velocity_enu_m_s / flight.stop_s
    return replace(
        flight.anchor,
        position_enu_m=flight.start_enu_m + since_s * flight.velocity_enu_m_s - 0.5 * since_s**2 * deceleration,
        velocity_enu_m_s=flight.velocity_enu_m_s - since_s * deceleration,
        acceleration_enu_m_s2=-deceleration,
    )


def _start_descent(flight: ModeFlight, now: Snapshot) -> ModeFlight:
    return replace(flight, leg=Leg.DESCEND, sinking_m=now.position_enu_m[2], sink_m_s=0.0)


def _return(flight: ModeFlight, now: Snapshot, home_enu_m: Vector3) -> ModeFlight:
    height_m = float(_position(flight.anchor)[2])
    if flight.leg is Leg.BRAKE or (flight.leg is Leg.CLIMB and now.position_enu_m[2] > height_m - _REACHED_M):
        home = np.array((home_enu_m[0], home_enu_m[1], height_m))
        flight = replace(flight, leg=Leg.CROSS, anchor=replace(flight.anchor, position_enu_m=home))
    if flight.leg is Leg.CROSS and _distance_m(now, home_enu_m) < _REACHED_M:
        return _start_descent(flight, now)
    return flight


def _descend(flight: ModeFlight, now: Snapshot, rate_m_s: float, elapsed_s: float) -> tuple[ModeFlight, Reference]:
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
