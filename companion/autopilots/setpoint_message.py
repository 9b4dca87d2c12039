"""SET_POSITION_TARGET_LOCAL_NED from a setpoint in ENU; shared by all drivers."""

from companion.core.data import Setpoint
from link.frames.rotations import ned_from_enu, yaw_ned_from_enu
from link.mavlink.dialect import Message, mavlink

_IGNORE_PLACE = 0b0000_0000_0000_0011
_IGNORE_VELOCITY = 0b0000_0000_0011_1000
_IGNORE_ACCELERATION = 0b0000_0001_1100_0000
_IGNORE_YAW_RATE = 0b0000_1000_0000_0000
_ZERO = (0.0, 0.0, 0.0)
_VALUE_MAX = 1e7  # more than any place or motion; single precision holds it


def local_ned_setpoint(setpoint: Setpoint, boot_ms: int, target_system: int) -> Message:
    """Return the message that asks for `setpoint` in the autopilot's local frame.

    Args:
        setpoint: position, velocity and acceleration in ENU; a None group is masked out.
        boot_ms: the autopilot's boot time at which it is sent; no autopilot goes by it.
        target_system: the autopilot's system id.

    Raises:
        ValueError: a value is not finite, or absurd.

    Source: MAVLink common, POSITION_TARGET_TYPEMASK.
    """
    mask = _IGNORE_YAW_RATE
    mask |= _IGNORE_PLACE if setpoint.is_place_free else 0
    mask |= _IGNORE_VELOCITY if setpoint.velocity_enu_m_s is None else 0
    mask |= _IGNORE_ACCELERATION if setpoint.acceleration_enu_m_s2 is None else 0
    position = ned_from_enu(setpoint.position_enu_m)
    velocity = ned_from_enu(setpoint.velocity_enu_m_s or _ZERO)
    acceleration = ned_from_enu(setpoint.acceleration_enu_m_s2 or _ZERO)
    yaw_rad = yaw_ned_from_enu(setpoint.yaw_rad)
    values = (*position, *velocity, *acceleration, yaw_rad)
    if not all(abs(value) < _VALUE_MAX for value in values):
        raise ValueError(f"setpoint is not finite or absurd: {setpoint}")
    return mavlink.MAVLink_set_position_target_local_ned_message(
        boot_ms & 0xFFFFFFFF,
        target_system,
        mavlink.MAV_COMP_ID_AUTOPILOT1,
        mavlink.MAV_FRAME_LOCAL_NED,
        mask,
        *values,
        0.0,
    )
