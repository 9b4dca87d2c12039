"""The bits of PX4's report on health and arming: modes by their navigation state, and the parts of the autopilot.

Source: PX4's source (vehicle_status, px4::enums::health_component_t).
"""

from collections.abc import Mapping

from sim_autopilot.core.modes import Mode

MODE_STATES: Mapping[Mode, tuple[int, str]] = {
    Mode.MANUAL: (0, "manual"),
    Mode.ALTITUDE: (1, "altctl"),
    Mode.POSITION: (2, "posctl"),
    Mode.MISSION: (3, "mission"),
    Mode.HOLD: (4, "loiter"),
    Mode.RTL: (5, "rtl"),
    Mode.ACRO: (10, "acro"),
    Mode.OFFBOARD: (14, "offboard"),
    Mode.STABILIZED: (15, "stab"),
    Mode.TAKEOFF: (17, "takeoff"),
    Mode.LAND: (18, "land"),
    Mode.FOLLOW: (19, "follow_target"),
    Mode.PRECISION_LAND: (20, "precland"),
    Mode.ORBIT: (21, "orbit"),
}
"""Number and name."""

COMPONENTS: Mapping[int, tuple[str, str]] = {
    0: ("none", "None"),
    1: ("absolute_pressure", "Absolute pressure"),
    3: ("gps", "GPS"),
    7: ("remote_control", "Remote Control (RC or Joystick)"),
    11: ("battery", "Battery"),
    16: ("attitude_estimate", "Attitude estimate"),
    17: ("local_position_estimate", "Local position estimate"),
    20: ("system", "System"),
    24: ("global_position_estimate", "Global position estimate"),
    27: ("magnetometer", "Magnetometer"),
    28: ("accel", "Accelerometer"),
    29: ("gyro", "Gyroscope"),
}
"""Name and words by the number of the bit."""

ARMING_SUMMARY, HEALTH_SUMMARY = "commander_arming_check_summary", "commander_health_summary"
PROTOCOL = 0x88
"""The log levels of events that are for programs only."""
