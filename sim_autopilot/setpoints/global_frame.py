"""SET_POSITION_TARGET_GLOBAL_INT, turned into the local setpoint that asks for the same."""

from math import hypot, radians

from link.frames import ned_from_enu
from link.geodesy import geodetic_from_enu
from link.local_frame import local_from_geodetic
from link.mavlink.dialect import Message, mavlink
from link.messages import Vector3
from sim_autopilot.core.local_frame import Origin

_ABOVE_SEA = frozenset({mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT})
_ABOVE_HOME = frozenset({mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT})
_ABOVE_TERRAIN = frozenset({mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT, mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT})
"""The ground is flat: as high as home."""
_NO_POSITION = 0b111
_REACH_M = 1e5


def local_setpoint(
    message: Message, origin: Origin, home_enu_m: Vector3, *, knows_terrain: bool = False
) -> Message | None:
    """Return the SET_POSITION_TARGET_LOCAL_NED of a global setpoint, None for a frame or a place that is not flown.

    Args:
        message: the setpoint.
        origin: the autopilot's local frame.
        home_enu_m: in W, what relative altitudes are above.
        knows_terrain: whether altitudes above the ground are flown.
    """
    above_ground = _ABOVE_HOME | _ABOVE_TERRAIN if knows_terrain else _ABOVE_HOME
    if message.coordinate_frame not in _ABOVE_SEA | above_ground:
        return None
    north = east = down = 0.0
    if message.type_mask & _NO_POSITION != _NO_POSITION:
        latitude_rad, longitude_rad = radians(message.lat_int * 1e-7), radians(message.lon_int * 1e-7)
        altitude_m = message.alt
        if message.coordinate_frame in above_ground:
            altitude_m += geodetic_from_enu(origin.world, home_enu_m)[2]
        north, east, down = ned_from_enu(local_from_geodetic(origin.frame, latitude_rad, longitude_rad, altitude_m))
        if hypot(north, east) > _REACH_M:
            return None
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
