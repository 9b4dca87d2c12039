"""ArduPilot's simulated ship deck as a scenario's vehicle: where its reports, 5 a second, say that it is.

Model: from the newest report on it speeds up to the ordered speed on its circle, which is how the simulation moves it.
The deck is at the height of the drone's home. Frames: W is ENU about the datum; V is the ship's body with its origin in
the deck's middle.
"""

import math
from dataclasses import dataclass

from link.frames.geodesy import Datum, enu_from_geodetic
from link.frames.rotations import quaternion_from_yaw, wrap_angle, yaw_enu_from_ned
from link.mavlink.dialect import Message
from scenarios.simulation.vehicle import VehicleState

SHIP_SYSTEM_ID = 17  # SIM_SHIP_SYSID
PATH_RADIUS_M = 500.0
"""Of the circle that it sails, first to the north."""
ASTERN_M = (-1.5, -40.0)
"""East and north of the drone the deck's middle begins here for a landing, on a circle that leads by the drone."""
UNDER_DRONE_M = (0.0, 0.0)
"""For a sortie."""

SPEEDS_UP_M_S2 = 3.0  # ArduPilot, libraries/SITL/SIM_Ship.cpp
_DEGREES_1E7 = math.radians(1e-7)


@dataclass(frozen=True, slots=True, kw_only=True)
class ShipReport:
    """Where the deck was at `boot_ns` of the autopilot's clock."""

    boot_ns: int
    latitude_rad: float
    longitude_rad: float
    speed_m_s: float
    yaw_rad: float


def ship_report(message: Message) -> ShipReport | None:
    """Return the ship's report, None when `message` is none."""
    if message.get_srcSystem() != SHIP_SYSTEM_ID or message.get_type() != "GLOBAL_POSITION_INT":
        return None
    return ShipReport(
        boot_ns=message.time_boot_ms * 1_000_000,
        latitude_rad=message.lat * _DEGREES_1E7,
        longitude_rad=message.lon * _DEGREES_1E7,
        speed_m_s=math.hypot(message.vx, message.vy) * 0.01,
        yaw_rad=wrap_angle(yaw_enu_from_ned(math.radians(message.hdg * 0.01))),
    )


def ship_parameters(begins_m: tuple[float, float]) -> dict[str, float]:
    """Return the parameters of a ship that lies there, east and north of the drone, and reports."""
    east_m, north_m = begins_m
    return {
        "SIM_SHIP_PSIZE": 2.0 * PATH_RADIUS_M,
        "SIM_SHIP_OFS_X": north_m,
        "SIM_SHIP_OFS_Y": east_m,
        "SIM_SHIP_SPEED": 0.0,
        "SIM_SHIP_ENABLE": 1.0,
    }


def ship_at_rest(t_ns: int, begins_m: tuple[float, float]) -> VehicleState:
    """Return the ship at `t_ns` before it sails: where it begins, bow to the north; no vehicle leaps there later."""
    yaw_rad = 0.5 * math.pi
    return VehicleState(
        t_ns=t_ns,
        position_enu_m=(*begins_m, 0.0),
        velocity_enu_m_s=(0.0, 0.0, 0.0),
        acceleration_enu_m_s2=(0.0, 0.0, 0.0),
        orientation_wxyz=quaternion_from_yaw(yaw_rad),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
        yaw_rad=yaw_rad,
        yaw_rate_rad_s=0.0,
    )


def ship_at(
    report: ShipReport, reported_ns: int, t_ns: int, datum: Datum, *, turn_radius_m: float, ordered_m_s: float
) -> VehicleState:
    """Return the ship at `t_ns`.

    Args:
        report: its newest.
        reported_ns: of the report, by the clock of `t_ns`.
        t_ns: now.
        datum: origin of W, at the deck's height.
        turn_radius_m: of its circle, clockwise.
        ordered_m_s: speed that it makes for once it moves, not below the report's.
    """
    way_m, speed_m_s, acceleration_m_s2 = _sailed(report.speed_m_s, ordered_m_s, (t_ns - reported_ns) * 1e-9)
    yaw_rate_rad_s = -speed_m_s / turn_radius_m
    turned_rad = -way_m / turn_radius_m
    yaw_rad = report.yaw_rad + turned_rad
    x_m, y_m, _ = enu_from_geodetic(datum, report.latitude_rad, report.longitude_rad, datum.altitude_m)
    # Along the chord, which is as long as the arc for as short a way as this.
    middle_rad = report.yaw_rad + 0.5 * turned_rad
    cosine, sine = math.cos(yaw_rad), math.sin(yaw_rad)
    inward_m_s2 = speed_m_s * yaw_rate_rad_s
    return VehicleState(
        t_ns=t_ns,
        position_enu_m=(x_m + way_m * math.cos(middle_rad), y_m + way_m * math.sin(middle_rad), 0.0),
        velocity_enu_m_s=(speed_m_s * cosine, speed_m_s * sine, 0.0),
        acceleration_enu_m_s2=(
            acceleration_m_s2 * cosine - inward_m_s2 * sine,
            acceleration_m_s2 * sine + inward_m_s2 * cosine,
            0.0,
        ),
        orientation_wxyz=quaternion_from_yaw(wrap_angle(yaw_rad)),
        angular_velocity_flu_rad_s=(0.0, 0.0, yaw_rate_rad_s),
        yaw_rad=wrap_angle(yaw_rad),
        yaw_rate_rad_s=yaw_rate_rad_s,
    )


def _sailed(speed_m_s: float, ordered_m_s: float, dt_s: float) -> tuple[float, float, float]:
    """Return the way since the report, the speed after it, and the acceleration along it."""
    if speed_m_s == 0.0 or speed_m_s >= ordered_m_s:  # one that lies tells by its next report that it sails
        return speed_m_s * dt_s, speed_m_s, 0.0
    speeding_up_s = min(dt_s, (ordered_m_s - speed_m_s) / SPEEDS_UP_M_S2)
    reached_m_s = speed_m_s + SPEEDS_UP_M_S2 * speeding_up_s
    way_m = 0.5 * (speed_m_s + reached_m_s) * speeding_up_s + reached_m_s * (dt_s - speeding_up_s)
    return way_m, reached_m_s, SPEEDS_UP_M_S2 if dt_s <= speeding_up_s else 0.0
