"""PX4 (multirotor, between 1.16 and 1.17), as it behaves in its own software-in-the-loop simulation.

Parameter names, types, defaults and ranges: PX4 parameter reference.
Rates, times and answers: measured on that simulation.
"""

from types import MappingProxyType

from link.frames.geodesy import Projection
from link.mavlink.dialect import mavlink
from sim_autopilot.core.firmware import (
    COMMON_CAPABILITIES,
    Condition,
    Identity,
    OriginRules,
    ParameterRules,
    Readiness,
    Results,
    SensorFlags,
    Statuses,
)
from sim_autopilot.core.modes import Mode
from sim_autopilot.core.status_texts import FailsafeTexts, Texts
from sim_autopilot.firmware.parameter_table import whole_list
from sim_autopilot.firmware.px4.commands import COMMANDS
from sim_autopilot.firmware.px4.events import (
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
from sim_autopilot.firmware.px4.flight_texts import flight_texts
from sim_autopilot.firmware.px4.modes import MODES
from sim_autopilot.firmware.px4.offboard import Offboard
from sim_autopilot.firmware.px4.parameters import OBEYED, flight_settings
from sim_autopilot.firmware.px4.streams import LINKS, SILENT_MESSAGES, STREAMS
from sim_autopilot.flying_rules import MissionRules
from sim_autopilot.interfaces import CommandRules, Firmware, StreamRules
from sim_autopilot.telemetry.status import orbit_execution_status

_ARMING_S = 3.5
"""After boot, as measured: 2.7 to 4.8 s."""

PX4 = Firmware(
    name="px4",
    identity=Identity(
        autopilot_id=mavlink.MAV_AUTOPILOT_PX4,
        capabilities=COMMON_CAPABILITIES | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE,
        version=0x01_11_00_00,  # 1.17.0, in development
        custom_version=bytes((0, 0, 0, 24, 153, 179, 3, 186)),
        os_version=0x06_12_2C_FF,  # Linux 6.18.44
        board_version=1,
        uid=0x4954_414C_4449_4E54,  # its simulation's, the same for all
        uid2=bytes((5, *(0,) * 17)),
    ),
    modes=MODES,
    condition=Condition(
        readiness=Readiness(booted_s=_ARMING_S, fix_s=0.0, position_s=0.8, arming_s=_ARMING_S),
        statuses=Statuses(
            booting=mavlink.MAV_STATE_UNINIT,
            standby=mavlink.MAV_STATE_STANDBY,
            armed=mavlink.MAV_STATE_ACTIVE,
            flying=mavlink.MAV_STATE_ACTIVE,
            failsafe=mavlink.MAV_STATE_CRITICAL,
        ),
        sensors=SensorFlags(
            present=50348079, enabled=50413615, health=52480063, arming_health=0x10000000, arming_s=_ARMING_S
        ),
        fix_type=mavlink.GPS_FIX_TYPE_3D_FIX,
        vtol_state=mavlink.MAV_VTOL_STATE_UNDEFINED,
        current_ca=-100,
    ),
    streams=StreamRules(
        messages=MappingProxyType({stream.message_id: stream for stream in STREAMS}),
        builders=MappingProxyType({mavlink.MAVLINK_MSG_ID_ORBIT_EXECUTION_STATUS: orbit_execution_status}),
        rate_max_hz=125.0,
        silent=SILENT_MESSAGES,
        answers_silent=False,
    ),
    parameters=ParameterRules(
        table=whole_list("px4", OBEYED),
        settings=flight_settings,
        system_id="MAV_SYS_ID",
        lenient=False,
        tells_indices=True,
    ),
    texts=Texts(
        everybody=False,
        severity=mavlink.MAV_SEVERITY_CRITICAL,
        boot=(),
        not_ready=((_ARMING_S, UNHEALTHY),),
        unarmable=UNHEALTHY,
        no_setpoints=NO_SETPOINTS,
        disarm_refused=NOT_LANDED,
        neither_arms_nor_disarms="Unsupported ARM_DISARM param: {:.3f}\t",
        armed=None,
        disarmed=None,
        failsafes=FailsafeTexts(
            battery=MappingProxyType({1: BATTERY_LOW, 2: BATTERY_CRITICAL, 3: BATTERY_EMERGENCY}), entered=FAILSAFE
        ),
        obeyed=MappingProxyType({Mode.LAND: LANDING_HERE, Mode.RTL: RETURNING}),
        no_mission=NO_MISSION,
        high_enough=HIGH_ENOUGH,
    ),
    events=MappingProxyType(EVENTS),
    describe_flight=flight_texts,
    commands=CommandRules(
        handlers=COMMANDS,
        results=Results(
            arm_refused=mavlink.MAV_RESULT_TEMPORARILY_REJECTED,
            reboot_refused=mavlink.MAV_RESULT_DENIED,
            disarm_in_the_air=mavlink.MAV_RESULT_TEMPORARILY_REJECTED,
            mode_refused=mavlink.MAV_RESULT_TEMPORARILY_REJECTED,
            no_such_mode=mavlink.MAV_RESULT_ACCEPTED,
            no_such_message=mavlink.MAV_RESULT_DENIED,
            no_such_stream=mavlink.MAV_RESULT_FAILED,
        ),
        answers_other_components=False,
        reboots=False,  # its simulation cannot
    ),
    setpoints=Offboard(),
    origin=OriginRules(projection=Projection.PX4, stays=False, announces_home=False),
    missions=MissionRules(home_first=False, returns_itself=False, holds_at_the_end=True, arms_to_start=True),
    links=LINKS,
)
