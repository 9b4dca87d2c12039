"""PX4 (multirotor, between 1.16 and 1.17), as it behaves in its own software-in-the-loop simulation.

Parameter names, types, defaults and ranges: PX4 parameter reference.
Rates, times and answers: measured on that simulation.
"""

from functools import partial
from types import MappingProxyType

from link.frames.local_frame import Projection
from link.mavlink.dialect import mavlink
from sim_autopilot.files.store import Shown
from sim_autopilot.firmware.actuator_metadata import ACTUATORS_PATH
from sim_autopilot.firmware.component_metadata import (
    GENERAL_PATH,
    PARAMETERS_PATH,
    actuators_file,
    events_file,
    general_file,
    parameters_file,
)
from sim_autopilot.firmware.event_metadata import EVENTS_PATH
from sim_autopilot.firmware.firmware import (
    Firmware,
    ModeCode,
    Readiness,
    Results,
    SensorFlags,
    Statuses,
    Texts,
)
from sim_autopilot.firmware.identity import Identity
from sim_autopilot.firmware.plain_answers import PX4_ANSWERS
from sim_autopilot.firmware.px4_events import (
    BATTERY_CRITICAL,
    BATTERY_EMERGENCY,
    BATTERY_LOW,
    EVENTS,
    FAILSAFE,
    HIGH_ENOUGH,
    LANDING_HERE,
    NO_MISSION,
    NO_SETPOINTS,
    NOT_LANDED,
    RETURNING,
    UNHEALTHY,
)
from sim_autopilot.firmware.px4_parameters import OBEYED, flight_settings
from sim_autopilot.firmware.px4_streams import SILENT_MESSAGES, STREAMS
from sim_autopilot.firmware.stored_parameters import whole_list
from sim_autopilot.flight.modes import Mode
from sim_autopilot.parameters import Parameter, Values

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

_OBEYED_NAMES = frozenset(parameter.name for parameter in OBEYED)


_MODES = MappingProxyType(
    {
        Mode.OFFBOARD: _code("offboard", _OFFBOARD_FLAGS, 6),
        Mode.HOLD: _code("hold", _AUTO_FLAGS, 4, 3),
        Mode.LAND: _code("land", _AUTO_FLAGS, 4, 6),
        Mode.TAKEOFF: _code("takeoff", _AUTO_FLAGS, 4, 2),
        Mode.RTL: _code("rtl", _AUTO_FLAGS, 4, 5),
        Mode.MISSION: _code("mission", _AUTO_FLAGS, 4, 4),
        Mode.POSITION: _code("position", _MANUAL_FLAGS, 3),
        Mode.ORBIT: _code("orbit", _AUTO_FLAGS, 3, 1),
        Mode.FOLLOW: _code("follow", _AUTO_FLAGS, 4, 8),
        Mode.ALTITUDE: _code("altitude", _MANUAL_FLAGS, 2),
        Mode.STABILIZED: _code("stabilized", _MANUAL_FLAGS, 7),
        Mode.MANUAL: _code("manual", _MANUAL_FLAGS, 1),
        Mode.ACRO: _code("acro", _ACRO_FLAGS, 5),
    }
)
_CUSTOM_MODES = tuple((mode, code.custom_mode) for mode, code in _MODES.items())


def _files(parameters: tuple[Parameter, ...], _values: Values) -> Shown:
    return {
        GENERAL_PATH: partial(general_file, parameters, _OBEYED_NAMES, _CUSTOM_MODES),
        ACTUATORS_PATH: actuators_file,
        EVENTS_PATH: partial(events_file, _CUSTOM_MODES),
        PARAMETERS_PATH: partial(parameters_file, parameters, _OBEYED_NAMES),
    }


PX4 = Firmware(
    name="px4",
    autopilot_id=mavlink.MAV_AUTOPILOT_PX4,
    capabilities=mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    | mavlink.MAV_PROTOCOL_CAPABILITY_FTP
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
    modes=_MODES,
    boot_mode=Mode.HOLD,
    unarmable_modes=frozenset({Mode.LAND, Mode.RTL, Mode.ORBIT, Mode.FOLLOW}),
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
        not_ready=((_ARMING_S, UNHEALTHY),),
        unarmable=UNHEALTHY,
        no_setpoints=NO_SETPOINTS,
        disarm_refused=NOT_LANDED,
        armed=None,
        disarmed=None,
        battery=MappingProxyType({1: BATTERY_LOW, 2: BATTERY_CRITICAL, 3: BATTERY_EMERGENCY}),
        failsafe=FAILSAFE,
        obeyed=MappingProxyType({Mode.LAND: LANDING_HERE, Mode.RTL: RETURNING}),
        no_mission=NO_MISSION,
        high_enough=HIGH_ENOUGH,
    ),
    current_ca=-100,
    vtol_state=mavlink.MAV_VTOL_STATE_UNDEFINED,
    streams=MappingProxyType({stream.message_id: stream for stream in STREAMS}),
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
    settings=flight_settings,
    setpoint_frames=frozenset({mavlink.MAV_FRAME_LOCAL_NED, mavlink.MAV_FRAME_BODY_NED}),
    setpoint_stream_s=0.0,  # one fresh setpoint: MAVSDK sends its first and asks for the mode at once
    guided=False,
    projection=Projection.PX4,
    keeps_origin=False,
    announces_home=False,
    takes_off_by_setpoint=True,
    lists_modes=True,
    has_shell=True,
    silent_messages=SILENT_MESSAGES,
    tells_flights=True,
    events=MappingProxyType(EVENTS),
    mode_answered_twice=True,
    answers_other_components=False,
    leaves_landing_modes=True,
    tells_modes=False,
    set_mode_answered_as=mavlink.MAV_CMD_DO_SET_MODE,
    tells_indices=True,
    identity=Identity(
        custom_version=bytes((0, 0, 0, 24, 153, 179, 3, 186)),
        os_version=0x06_12_2C_FF,  # Linux 6.18.44
        board_version=1,
        uid=0x4954_414C_4449_4E54,  # its simulation's, the same for all
        uid2=bytes((5, *(0,) * 17)),
    ),
    plain_answers=PX4_ANSWERS,
    files=_files,
)
