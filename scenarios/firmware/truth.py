"""The truth of a firmware's own simulation, as it tells it over MAVLink beside what its estimator believes.

ArduPilot's simulation sends SIM_STATE, PX4's HIL_STATE_QUATERNION; neither bears a time. ArduPilot sends messages of
one rate together, in a fixed order: an ATTITUDE just before dates SIM_STATE. PX4's is dated by its arrival, about 2 ms
late on a machine that keeps up; at 8 m/s each 10 ms would put the drone 8 cm behind where it was.
"""

import math
from dataclasses import dataclass
from typing import Literal

from link.frames.geodesy import Datum, enu_from_geodetic
from link.frames.rotations import (
    conjugate,
    enu_from_ned,
    flu_from_frd,
    normalized,
    quaternion_enu_flu_from_ned_frd,
    rotate,
)
from link.mavlink.dialect import Message, mavlink
from link.messages import BodyTruth, Quaternion, RotorTruth, Vector3
from scenarios.config import FirmwareName

TRUTH_STREAMS_HZ = {
    mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA: {
        mavlink.MAVLINK_MSG_ID_ATTITUDE: 100.0,
        mavlink.MAVLINK_MSG_ID_SIM_STATE: 100.0,
        mavlink.MAVLINK_MSG_ID_HEARTBEAT: 20.0,
    },
    mavlink.MAV_AUTOPILOT_PX4: {
        mavlink.MAVLINK_MSG_ID_HIL_STATE_QUATERNION: 100.0,
        mavlink.MAVLINK_MSG_ID_HIL_ACTUATOR_CONTROLS: 20.0,
    },
}
"""What to ask each firmware for, by MAV_AUTOPILOT."""

NAMES: dict[int, FirmwareName] = {
    mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA: "ardupilot",
    mavlink.MAV_AUTOPILOT_PX4: "px4",
}
"""What a scenario calls the firmwares that tell their truth, by MAV_AUTOPILOT."""

DATED_BY = {"SIM_STATE": "ATTITUDE"}
"""Messages without a time, and the one that is sent together with them, just before, at the same rate."""

AIRFRAMES: dict[str, Literal["arducopter", "px4"]] = {"px4": "px4", "ardupilot": "arducopter"}
"""The drone that each firmware simulates."""

_DEGREES_1E7 = math.radians(1e-7)
_TURNING_RAD_S = 700.0  # told of each rotor while the motors are armed; the score wants to know only whether they turn


@dataclass(frozen=True, slots=True, kw_only=True)
class TruePose:
    """Where the simulated drone is, altitude above mean sea level."""

    latitude_rad: float
    longitude_rad: float
    altitude_m: float
    orientation_wxyz: Quaternion
    velocity_enu_m_s: Vector3
    rates_flu_rad_s: Vector3


def true_pose(message: Message) -> TruePose | None:
    """Return the truth that `message` tells, None when it tells none."""
    match message.get_type():
        case "SIM_STATE":
            return _ardupilot(message)
        case "HIL_STATE_QUATERNION":
            return _px4(message)
        case _:
            return None


def motors_armed(message: Message) -> bool | None:
    """Return whether motors turn, None when `message` does not say."""
    match message.get_type():
        case "HEARTBEAT":
            return bool(message.base_mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)
        case "HIL_ACTUATOR_CONTROLS":
            return bool(message.mode & mavlink.MAV_MODE_FLAG_SAFETY_ARMED)
        case _:
            return None


def body_truth(pose: TruePose, datum: Datum, t_ns: int, gear_height_m: float) -> BodyTruth:
    """Return the pose about `datum`.

    Args:
        pose: of the point that is at the ground's height when the drone stands.
        datum: with its altitude above mean sea level.
        t_ns: when it was so.
        gear_height_m: of the centre of mass above that point.
    """
    x, y, z = enu_from_geodetic(datum, pose.latitude_rad, pose.longitude_rad, pose.altitude_m)
    return BodyTruth(
        t_ns=t_ns,
        position_enu_m=(x, y, z + gear_height_m),
        orientation_wxyz=pose.orientation_wxyz,
        velocity_flu_m_s=rotate(conjugate(pose.orientation_wxyz), pose.velocity_enu_m_s),
        angular_velocity_flu_rad_s=pose.rates_flu_rad_s,
    )


def rotor_truth(t_ns: int, *, armed: bool) -> RotorTruth:
    """Return rotors that turn while the motors are armed."""
    speed_rad_s = _TURNING_RAD_S if armed else 0.0
    return RotorTruth(t_ns=t_ns, speed_rad_s=(speed_rad_s,) * 4)


def _ardupilot(message: Message) -> TruePose:
    return TruePose(
        latitude_rad=message.lat_int * _DEGREES_1E7,
        longitude_rad=message.lon_int * _DEGREES_1E7,
        altitude_m=message.alt,
        orientation_wxyz=_orientation(message.q1, message.q2, message.q3, message.q4),
        velocity_enu_m_s=enu_from_ned((message.vn, message.ve, message.vd)),
        rates_flu_rad_s=flu_from_frd((message.xgyro, message.ygyro, message.zgyro)),
    )


def _px4(message: Message) -> TruePose:
    return TruePose(
        latitude_rad=message.lat * _DEGREES_1E7,
        longitude_rad=message.lon * _DEGREES_1E7,
        altitude_m=message.alt * 1e-3,
        orientation_wxyz=_orientation(*message.attitude_quaternion),
        velocity_enu_m_s=enu_from_ned((message.vx * 0.01, message.vy * 0.01, message.vz * 0.01)),
        rates_flu_rad_s=flu_from_frd((message.rollspeed, message.pitchspeed, message.yawspeed)),
    )


def _orientation(w: float, x: float, y: float, z: float) -> Quaternion:
    return normalized(quaternion_enu_flu_from_ned_frd((w, x, y, z)))
