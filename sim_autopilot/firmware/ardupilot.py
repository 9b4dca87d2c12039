"""ArduCopter 4.6, as it behaves in its own software-in-the-loop simulation.

Mode numbers, stream groups, texts: ArduCopter's documentation and source. Times and answers: measured.
"""

from functools import partial
from types import MappingProxyType

from link.frames.local_frame import Projection
from link.mavlink.dialect import mavlink
from sim_autopilot.files.flight_log import ARDUPILOT_LOGS
from sim_autopilot.files.ftp_state import ARDUPILOT_FTP
from sim_autopilot.files.parameter_file import PATH, packed
from sim_autopilot.files.store import Shown
from sim_autopilot.firmware.ardupilot_parameters import OBEYED, flight_settings
from sim_autopilot.firmware.ardupilot_streams import CONTACT_STREAMS, SILENT_MESSAGES, STREAM_GROUPS, STREAMS
from sim_autopilot.firmware.firmware import (
    Firmware,
    ModeCode,
    Readiness,
    Results,
    SensorFlags,
    Statuses,
    Text,
    Texts,
)
from sim_autopilot.firmware.identity import Identity
from sim_autopilot.firmware.plain_answers import ARDUCOPTER_ANSWERS
from sim_autopilot.firmware.stored_parameters import whole_list
from sim_autopilot.flight.modes import Mode
from sim_autopilot.missions.rules import ARDUCOPTER_MISSIONS
from sim_autopilot.parameters import Parameter, Values

_STICK_FLAGS = (
    mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
    | mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED
    | mavlink.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
)
_POSITION_FLAGS = _STICK_FLAGS | mavlink.MAV_MODE_FLAG_GUIDED_ENABLED
"""Of every mode that controls the position."""


def _code(name: str, number: int, flags: int = _POSITION_FLAGS) -> ModeCode:
    return ModeCode(base_mode=flags, custom_mode=number, request=(number,), name=name)


_MODES = {
    Mode.STABILIZED: _code("STABILIZE", 0, _STICK_FLAGS),
    Mode.ACRO: _code("ACRO", 1, _STICK_FLAGS),
    Mode.ALTITUDE: _code("ALT_HOLD", 2, _STICK_FLAGS),
    Mode.MISSION: _code("AUTO", 3),
    Mode.OFFBOARD: _code("GUIDED", 4),
    Mode.POSITION: _code("LOITER", 5),
    Mode.RTL: _code("RTL", 6),
    Mode.ORBIT: _code("CIRCLE", 7),
    Mode.LAND: _code("LAND", 9),
    Mode.DRIFT: _code("DRIFT", 11, _STICK_FLAGS),
    Mode.POSHOLD: _code("POSHOLD", 16),
    Mode.BRAKE: _code("BRAKE", 17),
    Mode.THROW: _code("THROW", 18, _STICK_FLAGS),
    Mode.AVOID: _code("AVOID_ADSB", 19),
    Mode.GUIDED_NOGPS: _code("GUIDED_NOGPS", 20, _STICK_FLAGS),
    Mode.SMART_RTL: _code("SMART_RTL", 21),
    Mode.ZIGZAG: _code("ZIGZAG", 24, _STICK_FLAGS),
}


def _info(text: str) -> Text:
    return Text(severity=mavlink.MAV_SEVERITY_INFO, text=text)


_BOOT_TEXTS = (
    (0.9, _info("Barometer 1 calibration complete")),
    (1.5, _info("ArduPilot Ready")),
    (1.5, _info("AHRS: DCM active")),
    (3.5, _info("EKF3 IMU0 initialised")),
    (3.5, _info("AHRS: EKF3 active")),
    (4.8, _info("EKF3 IMU0 tilt alignment complete")),
    (4.9, _info("EKF3 IMU0 MAG0 initial yaw alignment complete")),
    (9.8, _info("GPS 1: detected u-blox")),
    (20.0, _info("EKF3 IMU0 origin set")),
    (41.4, _info("EKF3 IMU0 is using GPS")),
)


def _files(parameters: tuple[Parameter, ...], values: Values) -> Shown:
    return {
        PATH: partial(packed, parameters, values),
        f"{PATH}?withdefaults=1": partial(packed, parameters, values, with_defaults=True),
    }


_COMMIT, _BOARD = "c86c3a57", "8d1219c7c4c5404aaa1f6d2a48adfda4"
"""Of the build that was measured, and its board's number in full."""

ARDUPILOT = Firmware(
    name="ardupilot",
    autopilot_id=mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA,
    capabilities=mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
    | mavlink.MAV_PROTOCOL_CAPABILITY_FTP
    | mavlink.MAV_PROTOCOL_CAPABILITY_COMPASS_CALIBRATION
    | mavlink.MAV_PROTOCOL_CAPABILITY_FLIGHT_TERMINATION
    | mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FLOAT
    | mavlink.MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
    | mavlink.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_LOCAL_NED,
    version=0x04_06_00_00,  # 4.6.0, in development
    modes=MappingProxyType(_MODES),
    boot_mode=Mode.STABILIZED,
    unarmable_modes=frozenset({Mode.LAND, Mode.RTL, Mode.SMART_RTL, Mode.BRAKE, Mode.MISSION}),
    loiter_mode=Mode.POSITION,
    statuses=Statuses(
        booting=mavlink.MAV_STATE_BOOT,
        standby=mavlink.MAV_STATE_STANDBY,
        armed=mavlink.MAV_STATE_STANDBY,
        flying=mavlink.MAV_STATE_ACTIVE,
        failsafe=mavlink.MAV_STATE_CRITICAL,
    ),
    fix_type=mavlink.GPS_FIX_TYPE_RTK_FIXED,
    texts=Texts(
        everybody=True,
        severity=mavlink.MAV_SEVERITY_CRITICAL,
        boot=_BOOT_TEXTS,
        not_ready=(
            (11.0, "Arm: Gyros inconsistent"),
            (20.0, "Arm: AHRS: waiting for home"),
            (41.5, "Arm: Need Position Estimate"),
        ),
        unarmable="Arm: {} mode not armable",
        no_setpoints="",
        disarm_refused=None,
        no_such_mode="No such mode {}",
        armed=_info("Arming motors"),
        disarmed=_info("Disarming motors"),
    ),
    current_ca=None,
    vtol_state=mavlink.MAV_VTOL_STATE_MC,
    streams=MappingProxyType({stream.message_id: stream for stream in STREAMS}),
    stream_groups=STREAM_GROUPS,
    contact_streams=CONTACT_STREAMS,
    stream_rate_max_hz=100.0,  # the step's; the firmware's is 0.8 of its loop's 400 Hz
    readiness=Readiness(booted_s=1.5, fix_s=10.0, position_s=20.0, arming_s=41.5),
    results=Results(
        arm_refused=mavlink.MAV_RESULT_FAILED,
        reboot_refused=mavlink.MAV_RESULT_FAILED,
        disarm_in_the_air=mavlink.MAV_RESULT_FAILED,
        mode_refused=mavlink.MAV_RESULT_FAILED,
        no_such_mode=mavlink.MAV_RESULT_FAILED,
        no_such_message=mavlink.MAV_RESULT_FAILED,
        no_such_stream=mavlink.MAV_RESULT_DENIED,
    ),
    sensors=SensorFlags(
        present=0x5371FC2F,
        enabled=0x52619C2F,
        health=0x47719C0F,
        fix_health=mavlink.MAV_SYS_STATUS_SENSOR_GPS,
        arming_health=mavlink.MAV_SYS_STATUS_PREARM_CHECK,
        arming_s=22.5,
        control=mavlink.MAV_SYS_STATUS_SENSOR_Z_ALTITUDE_CONTROL | mavlink.MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL,
    ),
    parameters=whole_list("ardupilot_parameters.csv", OBEYED),
    system_id_parameter="SYSID_THISMAV",
    lenient_parameters=True,
    settings=flight_settings,
    setpoint_frames=frozenset(
        {
            mavlink.MAV_FRAME_LOCAL_NED,
            mavlink.MAV_FRAME_LOCAL_OFFSET_NED,
            mavlink.MAV_FRAME_BODY_NED,
            mavlink.MAV_FRAME_BODY_OFFSET_NED,
        }
    ),
    setpoint_stream_s=None,
    guided=True,
    projection=Projection.ARDUPILOT,
    keeps_origin=True,
    announces_home=True,
    takes_off_by_setpoint=False,
    mode_answered_twice=False,
    answers_other_components=True,
    leaves_landing_modes=False,
    tells_modes=True,
    set_mode_answered_as=None,
    tells_indices=False,
    plain_answers=ARDUCOPTER_ANSWERS,
    files=_files,
    ftp=ARDUPILOT_FTP,
    logs=ARDUPILOT_LOGS,
    reposition_mode=Mode.OFFBOARD,
    missions=ARDUCOPTER_MISSIONS,
    banner=(f"ArduCopter V4.6.0-dev ({_COMMIT})", _BOARD, "Frame: QUAD/PLUS"),
    identity=Identity(custom_version=_COMMIT.encode(), uid2=_BOARD[:17].encode().ljust(18, b"\0")),
    silent_messages=SILENT_MESSAGES,
)
