"""PX4's events: names, levels and arguments, by the text that says the same.

Source: PX4's source (commander, navigator).
"""

from collections.abc import Mapping

from sim_autopilot.core.status_texts import EventCode

UNHEALTHY = "Arming denied: Resolve system health failures first"
NO_SETPOINTS = "No offboard signal"
NOT_LANDED = "Disarming denied: not landed"
BATTERY_LOW = "Low battery level, return advised"
BATTERY_CRITICAL = "Critical battery level, land now"
BATTERY_EMERGENCY = "Emergency battery level, land immediately"
FAILSAFE = "Failsafe activated"
LANDING_HERE = "Landing at current position"
RETURNING = "Returning to launch"
HIGH_ENOUGH = "Already higher than takeoff altitude"
NO_MISSION = "Mission start denied! No valid mission"
ARMED = "Armed by external command"
DISARMED = "Disarmed by external command"
DISARMED_LANDED = "Disarmed by landing"
DISARMED_IDLE = "Disarmed by auto preflight disarming"
TAKEN_OFF = "Takeoff detected"
LANDED = "Landing detected"
RETURN_LANDS = "RTL: land at destination"
MISSION_BEGINS = "Executing Mission"
MISSION_LANDED = "Mission finished, landed"
MISSION_LOITERS = "Mission finished, loitering"
MISSION_GONE = "No valid mission available, loitering"
STATION_LOST = "Connection to ground station lost"
STATION_BACK = "GCS connection regained"
COMPANION_LOST = "Connection to mission computer lost"
COMPANION_BACK = "Onboard controller regained"
INFO = 0x66
_BY_COMMAND, _BY_LANDING, _BY_WAITING = b"\x04", b"\x06", b"\x07"
"""Of DISARM_REASONS."""
DISARM_REASONS: Mapping[int, tuple[str, str]] = {
    4: ("command_external", "external command"),
    6: ("auto_disarm_land", "landing"),
    7: ("auto_disarm_preflight", "auto preflight disarming"),
}
"""Name and words by the number in the events about motors: px4::enums::arm_disarm_reason_t."""
_OFFBOARD_BIT = 1 << 14
"""Of the modes that a check bars: NAVIGATION_STATE_OFFBOARD."""
EVENTS: Mapping[str, EventCode] = {
    UNHEALTHY: EventCode(name="commander_arm_denied_resolve_failures", levels=0x62),
    NO_SETPOINTS: EventCode(
        name="check_modes_offboard_signal", levels=0x33, arguments=_OFFBOARD_BIT.to_bytes(4, "little"), said=UNHEALTHY
    ),
    NOT_LANDED: EventCode(name="commander_disarm_denied_not_landed", levels=0x62),
    BATTERY_LOW: EventCode(name="commander_failsafe_enter_low_bat", levels=0x64, said=""),
    BATTERY_CRITICAL: EventCode(name="commander_failsafe_enter_crit_bat_warn", levels=0x62, said=""),
    BATTERY_EMERGENCY: EventCode(name="commander_failsafe_enter_crit_low_bat_warn", levels=0x60, said=""),
    FAILSAFE: EventCode(name="commander_failsafe_enter_generic", levels=0x42),
    LANDING_HERE: EventCode(name="commander_landing_current_pos", levels=INFO),
    RETURNING: EventCode(name="commander_rtl", levels=INFO),
    HIGH_ENOUGH: EventCode(name="navigator_takeoff_already_higher", levels=0x63),
    NO_MISSION: EventCode(name="commander_mission_start_denied_no_mission", levels=0x62),
    ARMED: EventCode(name="commander_armed_by", levels=INFO, arguments=_BY_COMMAND),
    DISARMED: EventCode(name="commander_disarmed_by", levels=INFO, arguments=_BY_COMMAND),
    DISARMED_LANDED: EventCode(name="commander_disarmed_by", levels=INFO, arguments=_BY_LANDING),
    DISARMED_IDLE: EventCode(name="commander_disarmed_by", levels=INFO, arguments=_BY_WAITING),
    TAKEN_OFF: EventCode(name="commander_takeoff_detected", levels=INFO),
    LANDED: EventCode(name="commander_landing_detected", levels=INFO),
    RETURN_LANDS: EventCode(name="rtl_land_at_destination", levels=INFO),
    MISSION_BEGINS: EventCode(name="mission_execute", levels=INFO),
    MISSION_LANDED: EventCode(name="mission_finished", levels=INFO),
    MISSION_LOITERS: EventCode(name="mission_finished_loiter", levels=INFO),
    MISSION_GONE: EventCode(name="mission_not_valid_loiter", levels=0x93),
    STATION_LOST: EventCode(name="commander_gcs_lost", levels=0x64),
    COMPANION_LOST: EventCode(name="commander_mission_comp_lost", levels=0x22),
    COMPANION_BACK: EventCode(name="commander_onboard_ctrl_regained", levels=INFO),
    STATION_BACK: EventCode(name="commander_dl_regained", levels=INFO),
}
"""Arguments of modes are left out where no client reads them."""
