"""SET_POSITION_TARGET_GLOBAL_INT, turned into the local setpoint that asks for the same."""

from math import hypot, radians

from link.geodesy import Datum, enu_from_geodetic
from link.mavlink.dialect import Message, mavlink
from link.messages import Vector3

_ABOVE_SEA = frozenset({mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT})
_ABOVE_HOME = frozenset({mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT})
_ABOVE_TERRAIN = frozenset({mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT, mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT})
"""The ground is flat: as high as home."""
_NO_POSITION = 0b111
_REACH_M = 1e5


def local_setpoint(
    message: Message, datum: Datum, origin_enu_m: Vector3, home_enu_m: Vector3, *, knows_terrain: bool = False
) -> Message | None:
    """Return the SET_POSITION_TARGET_LOCAL_NED of a global setpoint, None for a frame or a place that is not flown.

    Args:
        message: the setpoint.
        datum: of W.
        origin_enu_m: of the autopilot's local frame in W.
        home_enu_m: what relative altitudes are above.
        knows_terrain: whether altitudes above the ground are flown.
    """
    above_ground = _ABOVE_HOME | _ABOVE_TERRAIN if knows_terrain else _ABOVE_HOME
    if message.coordinate_frame not in _ABOVE_SEA | above_ground:
        return None
    north = east = down = 0.0
    if message.type_mask & _NO_POSITION != _NO_POSITION:
        latitude_rad, longitude_rad = radians(message.lat_int * 1e-7), radians(message.lon_int * 1e-7)
        try:
            x, y, _ = enu_from_geodetic(datum, latitude_rad, longitude_rad, datum.altitude_m)
        except ValueError:
            return None
        if hypot(x, y) > _REACH_M:
            return None
        base_m = home_enu_m[2] if message.coordinate_frame in above_ground else -datum.altitude_m
        north, east, down = y - origin_enu_m[1], x - origin_enu_m[0], origin_enu_m[2] - (message.alt + base_m)
    return mavlink.MAVLink_set_position_target_local_ned_message(
        message.time_boot_ms,
        message.target_system,
        message.target_component,
        mavlink.MAV_FRAME_LOCAL_NED,
        message.type_mask,
        north,
        east,
        down,
        *(message.vx, message.vy, message.vz, message.afx, message.afy, message.afz, message.yaw, message.yaw_rate),
    )
