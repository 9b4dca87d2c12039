"""Messages that ArduPilot sends besides its stream groups, when somebody asks: truth, a summary, gimbals, motors.

Fields and scales: MAVLink common and ArduPilot dialects; what is not there is told as in ArduPilot's simulation.
"""

from collections.abc import Mapping
from math import degrees, nan, pi
from types import MappingProxyType

from link.frames.rotations import frd_from_flu, ned_from_enu, quaternion_ned_frd_from_enu_flu
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.places import geodetic
from sim_autopilot.firmware.ardupilot import messages
from sim_autopilot.firmware.ardupilot.messages import simstate
from sim_autopilot.interfaces import AutopilotConfig, Builder
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.safety.failsafes_step import charge_of
from sim_autopilot.telemetry.motion import wire_place
from sim_autopilot.telemetry.sensors import truth
from sim_autopilot.telemetry.status import boot_ms, extended_sys_state

_NONE = (0, 0, 0, 0)
_ALL_WELL = (
    mavlink.ESTIMATOR_ATTITUDE
    | mavlink.ESTIMATOR_VELOCITY_HORIZ
    | mavlink.ESTIMATOR_VELOCITY_VERT
    | mavlink.ESTIMATOR_POS_HORIZ_ABS
    | mavlink.ESTIMATOR_POS_VERT_ABS
)


def sim_state(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return SIM_STATE, by which the simulation tells the truth."""
    short, now = simstate(memory, config), truth(memory)
    q = quaternion_ned_frd_from_enu_flu(now.orientation_wxyz)
    place = geodetic(memory.places.chart, now.position_enu_m)
    motion = (short.xacc, short.yacc, short.zacc, short.xgyro, short.ygyro, short.zgyro)
    latitude, longitude, _ = wire_place(place)
    velocity = ned_from_enu(now.velocity_enu_m_s)
    return mavlink.MAVLink_sim_state_message(
        *q,
        *(short.roll, short.pitch, short.yaw, *motion, degrees(place[0]), degrees(place[1]), place[2], 0.0, 0.0),
        *velocity,
        latitude,
        longitude,
    )


def terrain_report(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return TERRAIN_REPORT: where it is, and that it knows of no terrain there."""
    latitude, longitude, _ = wire_place(geodetic(memory.places.chart, memory.now.position_enu_m))
    return mavlink.MAVLink_terrain_report_message(latitude, longitude, 0, 0.0, 0.0, 0, 0)


def state_for_gimbal(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return AUTOPILOT_STATE_FOR_GIMBAL_DEVICE, for everybody."""
    now = memory.now
    _, _, rate_rad_s = frd_from_flu(now.angular_velocity_flu_rad_s)
    return mavlink.MAVLink_autopilot_state_for_gimbal_device_message(
        0,
        0,
        now.boot_ns // 1000,
        quaternion_ned_frd_from_enu_flu(now.orientation_wxyz),
        0,
        *ned_from_enu(now.velocity_enu_m_s),
        0,
        nan if memory.course.following is None else -(memory.course.following.yaw_rate_rad_s or 0.0),
        _ALL_WELL,
        extended_sys_state(memory, config).landed_state,
        rate_rad_s,
    )


def relay_status(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return RELAY_STATUS: there is none."""
    return mavlink.MAVLink_relay_status_message(boot_ms(memory), 0, 0)


def esc_telemetry(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return ESC_TELEMETRY_1_TO_4: the battery's voltage and the rotors' speed."""
    empty_v, full_v = memory.tuning.settings.simulation.battery_v
    voltage_cv = round(100.0 * (empty_v + charge_of(memory, config) * (full_v - empty_v)))
    speeds = memory.plant.state.rotor_speed_rad_s.tolist()
    rpm = tuple(_within(speed * 30.0 / pi, 0, 65535) for speed in speeds)
    return mavlink.MAVLink_esc_telemetry_1_to_4_message(bytes(_NONE), (voltage_cv,) * 4, _NONE, _NONE, rpm, _NONE)


def _within(value: float, lowest: int, highest: int) -> int:
    return max(lowest, min(highest, round(value)))


BUILDERS: Mapping[int, Builder] = MappingProxyType(
    {
        mavlink.MAVLINK_MSG_ID_AHRS: messages.ahrs,
        mavlink.MAVLINK_MSG_ID_AHRS2: messages.ahrs2,
        mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT: messages.ekf_status_report,
        mavlink.MAVLINK_MSG_ID_WIND: messages.wind,
        mavlink.MAVLINK_MSG_ID_POWER_STATUS: messages.power_status,
        mavlink.MAVLINK_MSG_ID_MEMINFO: messages.meminfo,
        mavlink.MAVLINK_MSG_ID_HWSTATUS: messages.hwstatus,
        mavlink.MAVLINK_MSG_ID_NAV_CONTROLLER_OUTPUT: messages.nav_controller_output,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED: messages.position_target,
        mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT: messages.position_target_global,
        mavlink.MAVLINK_MSG_ID_SIMSTATE: messages.simstate,
        mavlink.MAVLINK_MSG_ID_SCALED_IMU2: messages.scaled_imu2,
        mavlink.MAVLINK_MSG_ID_SCALED_IMU3: messages.scaled_imu3,
        mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE2: messages.scaled_pressure2,
        mavlink.MAVLINK_MSG_ID_FENCE_STATUS: messages.fence_status,
        mavlink.MAVLINK_MSG_ID_SIM_STATE: sim_state,
        mavlink.MAVLINK_MSG_ID_TERRAIN_REPORT: terrain_report,
        mavlink.MAVLINK_MSG_ID_AUTOPILOT_STATE_FOR_GIMBAL_DEVICE: state_for_gimbal,
        mavlink.MAVLINK_MSG_ID_RELAY_STATUS: relay_status,
        mavlink.MAVLINK_MSG_ID_ESC_TELEMETRY_1_TO_4: esc_telemetry,
    }
)
"""Of all messages that only ArduPilot sends, or that it fills in its own way, these and those of `messages`."""
