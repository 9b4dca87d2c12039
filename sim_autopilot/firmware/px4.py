"""PX4 (multirotor, between 1.16 and 1.17), as it behaves in its own software-in-the-loop simulation.

Parameter names, types, defaults and ranges: PX4 parameter reference.
Rates, times and answers: measured on that simulation.
"""

from math import radians
from types import MappingProxyType

from link.mavlink.dialect import mavlink
from sim_autopilot.failsafes import FailsafeSettings
from sim_autopilot.firmware.firmware import (
    EventCode,
    Firmware,
    ModeCode,
    Readiness,
    Results,
    SensorFlags,
    Statuses,
    Texts,
)
from sim_autopilot.firmware.plain_answers import PX4_ANSWERS
from sim_autopilot.firmware.stored_parameters import whole_list
from sim_autopilot.modes import Event, Mode
from sim_autopilot.parameters import Parameter, Values
from sim_autopilot.settings import FlightSettings
from sim_autopilot.stick_feel import StickFeel
from sim_autopilot.streams import Stream

_AUTO_FLAGS = (
    mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    | mavlink.MAV_MODE_FLAG_AUTO_ENABLED
    | mavlink.MAV_MODE_FLAG_GUIDED_ENABLED
    | mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED
)
_OFFBOARD_FLAGS = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED
_ACRO_FLAGS = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
_MANUAL_FLAGS = _OFFBOARD_FLAGS | mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED


def _code(name: str, flags: int, main: int, sub: int = 0) -> ModeCode:
    return ModeCode(base_mode=flags, custom_mode=main << 16 | sub << 24, request=(main, sub), name=name)


_ARMING_S = 3.5
"""After boot, as measured: 2.7 to 4.8 s."""

_LOSS_EVENTS = {
    0: Event.LOST_TO_POSITION,
    1: Event.LOST_TO_POSITION,  # altitude mode needs a stick that nobody holds
    2: Event.LOST_TO_POSITION,  # so does stabilised
    3: Event.LOST_TO_RTL,
    4: Event.LOST_TO_LAND,
    5: Event.LOST_TO_HOLD,
}
"""By COM_OBL_RC_ACT; the other values stop the motors."""


_ACTIONS = {
    1: Event.FAILSAFE_HOLD,
    2: Event.FAILSAFE_RTL,
    3: Event.FAILSAFE_LAND,
    5: Event.FAILSAFE_TERMINATE,
    6: Event.FAILSAFE_TERMINATE,  # disarms, which is the same here
}
"""By NAV_RCL_ACT and NAV_DLL_ACT."""
_BATTERY_ACTIONS: dict[int, tuple[Event | None, Event | None, Event | None]] = {
    2: (None, Event.FAILSAFE_LAND, Event.FAILSAFE_LAND),
    3: (None, Event.FAILSAFE_RTL, Event.FAILSAFE_LAND),
}
"""By COM_LOW_BAT_ACT; the other values only warn."""
_FENCE_ACTIONS = {
    2: Event.FAILSAFE_HOLD,
    3: Event.FAILSAFE_RTL,
    4: Event.FAILSAFE_TERMINATE,
    5: Event.FAILSAFE_LAND,
}
"""By GF_ACTION; 0 and 1 do nothing."""
_AUTO_MODES = frozenset({Mode.HOLD, Mode.LAND, Mode.TAKEOFF, Mode.RTL, Mode.MISSION})
_OVERRIDDEN = ((1, _AUTO_MODES), (2, frozenset({Mode.OFFBOARD})))
"""By the bits of COM_RC_OVERRIDE."""


def _overridden(bits: int) -> frozenset[Mode]:
    return frozenset(mode for bit, modes in _OVERRIDDEN if bits & bit for mode in modes)


def _failsafes(values: Values) -> FailsafeSettings:
    return FailsafeSettings(
        battery_levels=(values["BAT_LOW_THR"], values["BAT_CRIT_THR"], values["BAT_EMERGEN_THR"]),
        battery_events=_BATTERY_ACTIONS.get(int(values["COM_LOW_BAT_ACT"]), (None, None, None)),
        station_lost_s=values["COM_DL_LOSS_T"],
        station_event=_ACTIONS.get(int(values["NAV_DLL_ACT"])),
        hold_s=values["COM_FAIL_ACT_T"],
        fence_event=_FENCE_ACTIONS.get(int(values["GF_ACTION"])),
        reach_m=values["GF_MAX_HOR_DIST"],
        height_m=values["GF_MAX_VER_DIST"],
    )


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
        land_approach_m_s=values["MPC_Z_VEL_MAX_DN"],
        land_descent_m_s=values["MPC_LAND_SPEED"],
        land_slow_below_m=5.0,  # MPC_LAND_ALT2
        braking_m_s2=values["MPC_ACC_HOR"],
        return_height_m=values["RTL_RETURN_ALT"],
        return_distance_m=values["RTL_MIN_DIST"],
        disarm_landed_s=_time_or_never(values["COM_DISARM_LAND"]),
        disarm_idle_s=_time_or_never(values["COM_DISARM_PRFLT"]),
        disarm_after_landing_mode_s=_time_or_never(values["COM_DISARM_LAND"]),
        landed_after_s=1.5,  # measured from contact to ON_GROUND
        landed_speed_max_m_s=values["LNDMC_XY_VEL_MAX"],
        landed_sink_max_m_s=values["LNDMC_Z_VEL_MAX"],
        landed_sink_asked_m_s=1.1 * values["LNDMC_Z_VEL_MAX"],
        landed_tilt_max_rad=None,
        landed_acceleration_max_m_s2=None,
        path=None,
        gains=None,
        cruise_m_s=values["MPC_XY_CRUISE"],
        reached_m=values["NAV_ACC_RAD"],
        reached_height_m=values["NAV_MC_ALT_RAD"],
        hover_share=values["MPC_THR_HOVER"],
        failsafes=_failsafes(values),
        sticks=StickFeel(
            speed_m_s=values["MPC_VEL_MANUAL"],
            tilt_rad=radians(values["MPC_MAN_TILT_MAX"]),
            yaw_rate_rad_s=radians(values["MPC_MAN_Y_MAX"]),
            dead_zone=values["MPC_HOLD_DZ"],
            lost_s=values["COM_RC_LOSS_T"],
        ),
        sticks_lost_event=_ACTIONS.get(int(values["NAV_RCL_ACT"])),
        overridden_modes=_overridden(int(values["COM_RC_OVERRIDE"])),
        sticks_moved_per_s=values["COM_RC_STICK_OV"] / 100.0,
        takes_failures=values["SYS_FAILURE_EN"] > 0.0,
    )


def _time_or_never(value_s: float) -> float | None:
    return value_s if value_s > 0.0 else None


def _parameter(name: str, default: float, lowest: float, highest: float) -> Parameter:
    return Parameter(name=name, default=default, lowest=lowest, highest=highest)


# NAV_ACC_RAD and RTL_RETURN_ALT as PX4 sets them for every multirotor, COM_LOW_BAT_ACT and SYS_FAILURE_EN for its
# own simulation.
OBEYED = (
    _parameter("BAT_CRIT_THR", 0.07, 0.05, 0.5),
    _parameter("BAT_EMERGEN_THR", 0.05, 0.03, 0.5),
    _parameter("BAT_LOW_THR", 0.15, 0.12, 0.5),
    _parameter("COM_DISARM_LAND", 2.0, -1.0, 1e4),
    _parameter("COM_DISARM_PRFLT", 10.0, -1.0, 1e4),
    _parameter("COM_DL_LOSS_T", 10, 5, 300),
    _parameter("COM_FAIL_ACT_T", 5.0, 0.0, 25.0),
    _parameter("COM_LOW_BAT_ACT", 3, 0, 3),
    _parameter("COM_OBL_RC_ACT", 0, 0, 7),
    _parameter("COM_OF_LOSS_T", 1.0, 0.0, 60.0),
    _parameter("COM_RC_LOSS_T", 0.5, 0.0, 35.0),
    _parameter("COM_RC_OVERRIDE", 1, 0, 3),
    _parameter("COM_RC_STICK_OV", 30.0, 5.0, 80.0),
    _parameter("COM_SPOOLUP_TIME", 1.0, 0.0, 30.0),
    _parameter("GF_ACTION", 2, 0, 5),
    _parameter("GF_MAX_HOR_DIST", 0.0, 0.0, 10000.0),
    _parameter("GF_MAX_VER_DIST", 0.0, 0.0, 10000.0),
    _parameter("LNDMC_XY_VEL_MAX", 1.5, 0.0, 30.0),
    _parameter("LNDMC_Z_VEL_MAX", 0.25, 0.0, 5.0),
    _parameter("MIS_TAKEOFF_ALT", 2.5, 0.0, 1000.0),
    _parameter("MPC_ACC_HOR", 3.0, 2.0, 15.0),
    _parameter("MPC_HOLD_DZ", 0.1, 0.0, 1.0),
    _parameter("MPC_LAND_SPEED", 0.7, 0.6, 10.0),
    _parameter("MPC_MAN_TILT_MAX", 35.0, 1.0, 70.0),
    _parameter("MPC_MAN_Y_MAX", 150.0, 0.0, 400.0),
    _parameter("MPC_TILTMAX_AIR", 45.0, 20.0, 89.0),
    _parameter("MPC_THR_HOVER", 0.5, 0.1, 0.8),
    _parameter("MPC_TKO_RAMP_T", 3.0, 0.0, 30.0),
    _parameter("MPC_TKO_SPEED", 1.5, 1.0, 5.0),
    _parameter("MPC_VEL_MANUAL", 10.0, 3.0, 20.0),
    _parameter("MPC_XY_CRUISE", 5.0, 3.0, 20.0),
    _parameter("MPC_XY_VEL_MAX", 12.0, 0.1, 40.0),
    _parameter("MPC_YAWRAUTO_MAX", 60.0, 5.0, 360.0),
    _parameter("MPC_Z_VEL_MAX_DN", 1.5, 0.5, 10.0),
    _parameter("MPC_Z_VEL_MAX_UP", 3.0, 0.5, 15.0),
    _parameter("NAV_ACC_RAD", 2.0, 0.05, 200.0),
    _parameter("NAV_DLL_ACT", 0, 0, 6),
    _parameter("NAV_MC_ALT_RAD", 0.8, 0.05, 200.0),
    _parameter("NAV_RCL_ACT", 2, 1, 6),
    _parameter("RTL_MIN_DIST", 10.0, 0.5, 100.0),
    _parameter("RTL_RETURN_ALT", 30.0, 0.0, 1000.0),
    _parameter("SYS_FAILURE_EN", 1, 0, 1),
)

_STREAMS = (
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HEARTBEAT, rate_hz=1.0, fixed=True),
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
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ALTITUDE, rate_hz=10.0, from_s=2.9),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SCALED_PRESSURE, rate_hz=1.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SCALED_IMU),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW, rate_hz=10.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ACTUATOR_OUTPUT_STATUS),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_VIBRATION, rate_hz=0.5),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS, rate_hz=1.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET, rate_hz=10.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_WIND_COV),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_HIL_STATE_QUATERNION),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_MISSION_CURRENT, rate_hz=1.0, fixed=True),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_RC_CHANNELS, rate_hz=20.0),
    Stream(message_id=mavlink.MAVLINK_MSG_ID_CURRENT_MODE, rate_hz=0.5, from_s=1.9),
)

_UNHEALTHY = "Arming denied: Resolve system health failures first"
_NO_SETPOINTS = "No offboard signal"
_NOT_LANDED = "Disarming denied: not landed"
_BATTERY_LOW = "Low battery level, return advised"
_BATTERY_CRITICAL = "Critical battery level, land now"
_BATTERY_EMERGENCY = "Emergency battery level, land immediately"
_FAILSAFE = "Failsafe activated"
_OFFBOARD_BIT = 1 << 14
"""Of the modes that a check bars: NAVIGATION_STATE_OFFBOARD."""
_EVENTS = {
    _UNHEALTHY: EventCode(name="commander_arm_denied_resolve_failures", levels=0x62),
    _NO_SETPOINTS: EventCode(
        name="check_modes_offboard_signal", levels=0x33, arguments=_OFFBOARD_BIT.to_bytes(4, "little")
    ),
    _NOT_LANDED: EventCode(name="commander_disarm_denied_not_landed", levels=0x62),
    _BATTERY_LOW: EventCode(name="commander_failsafe_enter_low_bat", levels=0x64),
    _BATTERY_CRITICAL: EventCode(name="commander_failsafe_enter_crit_bat_warn", levels=0x62),
    _BATTERY_EMERGENCY: EventCode(name="commander_failsafe_enter_crit_low_bat_warn", levels=0x60),
    _FAILSAFE: EventCode(name="commander_failsafe_enter_generic", levels=0x42),
}
"""Arguments of modes are left out where no client reads them."""

PX4 = Firmware(
    name="px4",
    autopilot_id=mavlink.MAV_AUTOPILOT_PX4,
    capabilities=mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FLOAT
    | mavlink.MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
    | mavlink.MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION
    | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
    | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
    | mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FLOAT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
    | mavlink.MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
    | mavlink.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED,
    version=0x01_11_00_00,  # 1.17.0, in development
    modes=MappingProxyType(
        {
            Mode.OFFBOARD: _code("offboard", _OFFBOARD_FLAGS, 6),
            Mode.HOLD: _code("hold", _AUTO_FLAGS, 4, 3),
            Mode.LAND: _code("land", _AUTO_FLAGS, 4, 6),
            Mode.TAKEOFF: _code("takeoff", _AUTO_FLAGS, 4, 2),
            Mode.RTL: _code("rtl", _AUTO_FLAGS, 4, 5),
            Mode.MISSION: _code("mission", _AUTO_FLAGS, 4, 4),
            Mode.POSITION: _code("position", _MANUAL_FLAGS, 3),
            Mode.ORBIT: _code("orbit", _AUTO_FLAGS, 3, 1),
            Mode.ALTITUDE: _code("altitude", _MANUAL_FLAGS, 2),
            Mode.STABILIZED: _code("stabilized", _MANUAL_FLAGS, 7),
            Mode.MANUAL: _code("manual", _MANUAL_FLAGS, 1),
            Mode.ACRO: _code("acro", _ACRO_FLAGS, 5),
        }
    ),
    boot_mode=Mode.HOLD,
    unarmable_modes=frozenset({Mode.LAND, Mode.RTL}),
    loiter_mode=Mode.HOLD,
    statuses=Statuses(
        booting=mavlink.MAV_STATE_UNINIT,
        standby=mavlink.MAV_STATE_STANDBY,
        armed=mavlink.MAV_STATE_ACTIVE,
        flying=mavlink.MAV_STATE_ACTIVE,
        failsafe=mavlink.MAV_STATE_CRITICAL,
    ),
    fix_type=mavlink.GPS_FIX_TYPE_3D_FIX,
    texts=Texts(
        everybody=False,
        severity=mavlink.MAV_SEVERITY_CRITICAL,
        boot=(),
        not_ready=((_ARMING_S, _UNHEALTHY),),
        unarmable=_UNHEALTHY,
        no_setpoints=_NO_SETPOINTS,
        disarm_refused=_NOT_LANDED,
        armed=None,
        disarmed=None,
        battery=MappingProxyType({1: _BATTERY_LOW, 2: _BATTERY_CRITICAL, 3: _BATTERY_EMERGENCY}),
        failsafe=_FAILSAFE,
    ),
    vtol_state=mavlink.MAV_VTOL_STATE_UNDEFINED,
    streams=MappingProxyType({stream.message_id: stream for stream in _STREAMS}),
    stream_groups=MappingProxyType({}),
    contact_streams=frozenset(),
    stream_rate_max_hz=125.0,
    readiness=Readiness(booted_s=_ARMING_S, fix_s=0.0, position_s=0.8, arming_s=_ARMING_S),
    results=Results(
        arm_refused=mavlink.MAV_RESULT_TEMPORARILY_REJECTED,
        reboot_refused=mavlink.MAV_RESULT_DENIED,
        disarm_in_the_air=mavlink.MAV_RESULT_TEMPORARILY_REJECTED,
        mode_refused=mavlink.MAV_RESULT_TEMPORARILY_REJECTED,
        no_such_mode=mavlink.MAV_RESULT_ACCEPTED,
        no_such_message=mavlink.MAV_RESULT_DENIED,
        no_such_stream=mavlink.MAV_RESULT_FAILED,
    ),
    sensors=SensorFlags(
        present=50348079, enabled=50413615, health=52480063, arming_health=0x10000000, arming_s=_ARMING_S
    ),
    parameters=whole_list("px4_parameters.csv", OBEYED),
    system_id_parameter="MAV_SYS_ID",
    lenient_parameters=False,
    settings=_settings,
    setpoint_frames=frozenset({mavlink.MAV_FRAME_LOCAL_NED, mavlink.MAV_FRAME_BODY_NED}),
    setpoint_stream_s=0.0,  # one fresh setpoint: MAVSDK sends its first and asks for the mode at once
    guided=False,
    keeps_origin=False,
    announces_home=False,
    takes_off_by_setpoint=True,
    lists_modes=True,
    events=MappingProxyType(_EVENTS),
    mode_answered_twice=True,
    answers_other_components=False,
    leaves_landing_modes=True,
    tells_modes=False,
    set_mode_answered_as=mavlink.MAV_CMD_DO_SET_MODE,
    tells_indices=True,
    plain_answers=PX4_ANSWERS,
)
