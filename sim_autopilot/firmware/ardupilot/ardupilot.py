"""ArduCopter 4.6, as it behaves in its own software-in-the-loop simulation.

Mode numbers, stream groups, texts: ArduCopter's documentation and source. Times and answers: measured.
"""

from types import MappingProxyType

from link.frames.geodesy import Projection
from link.mavlink.dialect import mavlink
from sim_autopilot.core.firmware import (
    COMMON_CAPABILITIES,
    Condition,
    DefaultLink,
    Identity,
    LinkRules,
    OriginRules,
    ParameterRules,
    Readiness,
    Results,
    SensorFlags,
    Statuses,
)
from sim_autopilot.core.status_texts import Text, Texts
from sim_autopilot.firmware.ardupilot.commands import COMMANDS
from sim_autopilot.firmware.ardupilot.guided import GuidedFlight
from sim_autopilot.firmware.ardupilot.mission_texts import mission_texts
from sim_autopilot.firmware.ardupilot.modes import MODES
from sim_autopilot.firmware.ardupilot.parameters import OBEYED, flight_settings
from sim_autopilot.firmware.ardupilot.requested_messages import BUILDERS
from sim_autopilot.firmware.ardupilot.streams import (
    CONTACT_STREAMS,
    GROUP_PARAMETERS,
    SILENT_MESSAGES,
    STREAM_GROUPS,
    STREAMS,
)
from sim_autopilot.firmware.parameter_table import whole_list
from sim_autopilot.flying_rules import MissionRules
from sim_autopilot.interfaces import CommandRules, Firmware, StreamRules


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


def _default_links(instance: int) -> tuple[DefaultLink, ...]:
    """Return the links of its simulation, whose ports are shifted by ten for each instance."""
    return (
        DefaultLink(device=f"tcpin:127.0.0.1:{5760 + 10 * instance}"),
        DefaultLink(device=f"udpout:127.0.0.1:{14550 + 10 * instance}", is_ground=True),
    )


_COMMIT, _BOARD = "c86c3a57", "8d1219c7c4c5404aaa1f6d2a48adfda4"
"""Of the build that was measured, and its board's number in full."""

ARDUPILOT = Firmware(
    name="ardupilot",
    identity=Identity(
        autopilot_id=mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA,
        capabilities=COMMON_CAPABILITIES
        | mavlink.MAV_PROTOCOL_CAPABILITY_COMPASS_CALIBRATION
        | mavlink.MAV_PROTOCOL_CAPABILITY_SET_POSITION_TARGET_GLOBAL_INT,
        version=0x04_06_00_00,  # 4.6.0, in development
        custom_version=_COMMIT.encode(),
        uid2=_BOARD[:17].encode().ljust(18, b"\0"),
    ),
    modes=MODES,
    condition=Condition(
        readiness=Readiness(booted_s=1.5, fix_s=10.0, position_s=20.0, arming_s=41.5),
        statuses=Statuses(
            booting=mavlink.MAV_STATE_BOOT,
            standby=mavlink.MAV_STATE_STANDBY,
            armed=mavlink.MAV_STATE_STANDBY,
            flying=mavlink.MAV_STATE_ACTIVE,
            failsafe=mavlink.MAV_STATE_CRITICAL,
        ),
        sensors=SensorFlags(
            present=0x5371FC2F,
            enabled=0x52619C2F,
            health=0x47719C0F,
            fix_health=mavlink.MAV_SYS_STATUS_SENSOR_GPS,
            arming_health=mavlink.MAV_SYS_STATUS_PREARM_CHECK,
            arming_s=22.5,
            control=mavlink.MAV_SYS_STATUS_SENSOR_Z_ALTITUDE_CONTROL
            | mavlink.MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL,
        ),
        fix_type=mavlink.GPS_FIX_TYPE_RTK_FIXED,
        vtol_state=mavlink.MAV_VTOL_STATE_MC,
        current_ca=None,
    ),
    streams=StreamRules(
        messages=MappingProxyType({stream.message_id: stream for stream in STREAMS}),
        builders=BUILDERS,
        groups=STREAM_GROUPS,
        group_parameters=GROUP_PARAMETERS,
        on_contact=CONTACT_STREAMS,
        rate_max_hz=100.0,  # the step's; the firmware's is 0.8 of its loop's 400 Hz
        silent=SILENT_MESSAGES,
        answers_silent=True,
    ),
    parameters=ParameterRules(
        table=whole_list("ardupilot", OBEYED),
        settings=flight_settings,
        system_id="SYSID_THISMAV",
        lenient=True,
        tells_indices=False,
        banner=(f"ArduCopter V4.6.0-dev ({_COMMIT})", _BOARD, "Frame: QUAD/PLUS"),
    ),
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
        neither_arms_nor_disarms=None,
        no_such_mode="No such mode {}",
        armed=_info("Arming motors"),
        disarmed=_info("Disarming motors"),
    ),
    commands=CommandRules(
        handlers=COMMANDS,
        results=Results(
            arm_refused=mavlink.MAV_RESULT_FAILED,
            reboot_refused=mavlink.MAV_RESULT_FAILED,
            disarm_in_the_air=mavlink.MAV_RESULT_FAILED,
            mode_refused=mavlink.MAV_RESULT_FAILED,
            no_such_mode=mavlink.MAV_RESULT_FAILED,
            no_such_message=mavlink.MAV_RESULT_FAILED,
            no_such_stream=mavlink.MAV_RESULT_DENIED,
        ),
        answers_other_components=True,
        reboots=True,
    ),
    setpoints=GuidedFlight(),
    origin=OriginRules(projection=Projection.ARDUPILOT, stays=True, announces_home=True),
    missions=MissionRules(
        home_first=True,
        returns_itself=True,
        holds_at_the_end=False,
        arms_to_start=False,
        describe=mission_texts,
        flies_single_items=True,
    ),
    links=LinkRules(defaults=_default_links, answers_ping=False, takes_signing=True, ground_rates_hz=None),
)
