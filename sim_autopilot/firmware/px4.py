"""PX4 (multirotor, between 1.16 and 1.17), as it behaves in its own software-in-the-loop simulation.

Parameter names, types, defaults and ranges: PX4 parameter reference.
Rates, times and answers: measured on that simulation.
"""

from math import radians
from types import MappingProxyType

from link.mavlink.dialect import mavlink
from sim_autopilot.firmware.firmware import Firmware, ModeCode, Readiness, Results, SensorFlags
from sim_autopilot.modes import Event, Mode
from sim_autopilot.parameters import Parameter, Values
from sim_autopilot.settings import FlightSettings
from sim_autopilot.streams import Stream

_AUTO_FLAGS = (
    mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    | mavlink.MAV_MODE_FLAG_AUTO_ENABLED
    | mavlink.MAV_MODE_FLAG_GUIDED_ENABLED
    | mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED
)
_OFFBOARD_FLAGS = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED
_MANUAL_FLAGS = _OFFBOARD_FLAGS | mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED


def _code(flags: int, main: int, sub: int = 0) -> ModeCode:
    return ModeCode(base_mode=flags, custom_mode=main << 16 | sub << 24, request=(main, sub))


_LOSS_EVENTS = {
    0: Event.LOST_TO_POSITION,
    1: Event.LOST_TO_POSITION,  # altitude mode needs a stick that nobody holds
    2: Event.LOST_TO_POSITION,  # so does stabilised
    3: Event.LOST_TO_RTL,
    4: Event.LOST_TO_LAND,
    5: Event.LOST_TO_HOLD,
}
"""By COM_OBL_RC_ACT; the other values stop the motors."""


def _settings(values: Values) -> FlightSettings:
    return FlightSettings(
        speed_max_m_s=values["MPC_XY_VEL_MAX"],
        climb_max_m_s=values["MPC_Z_VEL_MAX_UP"],
        descent_max_m_s=values["MPC_Z_VEL_MAX_DN"],
        tilt_max_rad=radians(values["MPC_TILTMAX_AIR"]),
        yaw_rate_max_rad_s=radians(values["MPC_YAWRAUTO_MAX"]),
        setpoint_loss_s=values["COM_OF_LOSS_T"],
        setpoint_loss_event=_LOSS_EVENTS.get(int(values["COM_OBL_RC_ACT"])),
        spool_up_s=values["COM_SPOOLUP_TIME"],
        takeoff_ramp_s=values["MPC_TKO_RAMP_T"],
        takeoff_climb_m_s=values["MPC_TKO_SPEED"],
        takeoff_height_m=values["MIS_TAKEOFF_ALT"],
        land_descent_m_s=values["MPC_LAND_SPEED"],
        return_height_m=values["RTL_RETURN_ALT"],
        return_distance_m=values["RTL_MIN_DIST"],
        disarm_landed_s=_time_or_never(values["COM_DISARM_LAND"]),
        disarm_idle_s=_time_or_never(values["COM_DISARM_PRFLT"]),
        landed_speed_max_m_s=values["LNDMC_XY_VEL_MAX"],
        landed_sink_max_m_s=values["LNDMC_Z_VEL_MAX"],
        landed_sink_asked_m_s=1.1 * values["LNDMC_Z_VEL_MAX"],
    )


def _time_or_never(value_s: float) -> float | None:
    return value_s if value_s > 0.0 else None


def _parameter(name: str, default: float, lowest: float, highest: float) -> Parameter:
    return Parameter(name=name, default=default, lowest=lowest, highest=highest)


_PARAMETERS = (
    _parameter("COM_DISARM_LAND", 2.0, -1.0, 1e4),
    _parameter("COM_DISARM_PRFLT", 10.0, -1.0, 1e4),
    _parameter("COM_OBL_RC_ACT", 0, 0, 7),
    _parameter("COM_OF_LOSS_T", 1.0, 0.0, 60.0),
    _parameter("COM_SPOOLUP_TIME", 1.0, 0.0, 30.0),
    _parameter("LNDMC_XY_VEL_MAX", 1.5, 0.0, 30.0),
    _parameter("LNDMC_Z_VEL_MAX", 0.25, 0.0, 5.0),
    _parameter("MIS_TAKEOFF_ALT", 2.5, 0.0, 1000.0),
    _parameter("MPC_LAND_SPEED", 0.7, 0.6, 10.0),
    _parameter("MPC_TILTMAX_AIR", 45.0, 20.0, 89.0),
    _parameter("MPC_TKO_RAMP_T", 3.0, 0.0, 30.0),
    _parameter("MPC_TKO_SPEED", 1.5, 1.0, 5.0),
    _parameter("MPC_XY_VEL_MAX", 12.0, 0.1, 40.0),
    _parameter("MPC_YAWRAUTO_MAX", 60.0, 5.0, 360.0),
    _parameter("MPC_Z_VEL_MAX_DN", 1.5, 0.5, 10.0),
    _parameter("MPC_Z_VEL_MAX_UP", 3.0, 0.5, 15.0),
    _parameter("RTL_MIN_DIST", 10.0, 0.5, 100.0),
    _parameter("RTL_RETURN_ALT", 60.0, 0.0, 1000.0),
)

_STREAMS = (
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HEARTBEAT, rate_hz=1.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SYS_STATUS, rate_hz=5.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SYSTEM_TIME, rate_hz=1.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_GPS_RAW_INT, rate_hz=8.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ATTITUDE, rate_hz=100.0, from_s=1.8),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION, rate_hz=50.0, from_s=1.8),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED, rate_hz=30.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT, rate_hz=50.0, from_s=2.9),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_GPS_GLOBAL_ORIGIN, from_s=0.8),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_VFR_HUD, rate_hz=10.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED, rate_hz=10.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HIGHRES_IMU, rate_hz=50.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_TIMESYNC, rate_hz=10.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_DISTANCE_SENSOR, rate_hz=10.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_BATTERY_STATUS, rate_hz=0.5, from_s=1.9),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HOME_POSITION, rate_hz=0.5, from_s=1.9),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE, rate_hz=5.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ODOMETRY, rate_hz=30.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_CURRENT_MODE, rate_hz=0.5, from_s=1.9),
)

PX4 = Firmware(
    name="px4",
    autopilot_id=mavlink.MAV_AUTOPILOT_PX4,
    capabilities=mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
    | mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED,
    version=0x01_11_00_00,  # 1.17.0, in development
    modes=MappingProxyType(
        {
            Mode.OFFBOARD: _code(_OFFBOARD_FLAGS, 6),
            Mode.HOLD: _code(_AUTO_FLAGS, 4, 3),
            Mode.LAND: _code(_AUTO_FLAGS, 4, 6),
            Mode.TAKEOFF: _code(_AUTO_FLAGS, 4, 2),
            Mode.RTL: _code(_AUTO_FLAGS, 4, 5),
            Mode.POSITION: _code(_MANUAL_FLAGS, 3),
        }
    ),
    boot_mode=Mode.HOLD,
    unarmable_modes=frozenset({Mode.LAND, Mode.RTL}),
    streams=MappingProxyType({stream.message_id: stream for stream in _STREAMS}),
    stream_rate_max_hz=125.0,
    readiness=Readiness(fix_s=0.0, position_s=0.8, arming_s=3.5),
    results=Results(
        arm_refused=mavlink.MAV_RESULT_TEMPORARILY_REJECTED,
        disarm_in_the_air=mavlink.MAV_RESULT_TEMPORARILY_REJECTED,
        mode_refused=mavlink.MAV_RESULT_TEMPORARILY_REJECTED,
        no_such_message=mavlink.MAV_RESULT_DENIED,
        no_such_stream=mavlink.MAV_RESULT_FAILED,
    ),
    sensors=SensorFlags(present=50348079, enabled=50413615, health=52480063, arming_health=0x10000000),
    parameters=_PARAMETERS,
    settings=_settings,
    setpoint_frames=frozenset({mavlink.MAV_FRAME_LOCAL_NED, mavlink.MAV_FRAME_BODY_NED}),
    setpoint_stream_s=0.2,  # 0.3 s of setpoints at 20 Hz were seen to suffice
    takes_off_by_setpoint=True,
    mode_answered_twice=True,
    answers_other_components=False,
)
