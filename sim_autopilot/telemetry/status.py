"""Messages about the autopilot's condition: mode, health, battery, clock, landed state."""

from math import copysign, degrees

from link.frames.geodesy import geodetic_from_enu
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.modes import Mode
from sim_autopilot.flight.target_stages import SINKING
from sim_autopilot.interfaces import AutopilotConfig, has_passed
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.safety.failsafes_step import charge_of
from sim_autopilot.setpoints.guided import is_rising

_UNKNOWN_MV = 65535
_MAVLINK_VERSION = 3
_FENCE = "FENCE_ENABLE"
"""ArduCopter's; PX4 tells of no fence there."""
_CAPACITY_TO_CA = 360.0
"""Centiampere that give a milliampere-hour in a second."""
_CHARGE_STATES = (
    mavlink.MAV_BATTERY_CHARGE_STATE_OK,
    mavlink.MAV_BATTERY_CHARGE_STATE_LOW,
    mavlink.MAV_BATTERY_CHARGE_STATE_CRITICAL,
    mavlink.MAV_BATTERY_CHARGE_STATE_EMERGENCY,
)


def boot_ms(memory: AutopilotMemory) -> int:
    """Return milliseconds since boot as the 32 bits on the wire hold them."""
    return memory.now.boot_ns // 1_000_000 & 0xFFFFFFFF


def heartbeat(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return the HEARTBEAT."""
    code = config.firmware.modes.codes[memory.modes.mode]
    armed = mavlink.MAV_MODE_FLAG_SAFETY_ARMED if memory.armed_ns is not None else 0
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_QUADROTOR,
        config.firmware.identity.autopilot_id,
        code.base_mode | armed,
        code.custom_mode,
        _system_status(memory, config),
        _MAVLINK_VERSION,
    )


def _system_status(memory: AutopilotMemory, config: AutopilotConfig) -> int:
    statuses = config.firmware.condition.statuses
    if memory.armed_ns is not None:
        if memory.modes.failsafe:
            return statuses.failsafe
        return statuses.armed if memory.course.landing.landed else statuses.flying
    return (
        statuses.standby
        if has_passed(config, memory, config.firmware.condition.readiness.booted_s)
        else statuses.booting
    )


def sys_status(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return SYS_STATUS, whose health says whether it can arm."""
    sensors, readiness = config.firmware.condition.sensors, config.firmware.condition.readiness
    control = sensors.control if memory.armed_ns is not None else 0
    fenced = mavlink.MAV_SYS_STATUS_GEOFENCE if memory.tuning.values.get(_FENCE, 0.0) > 0.0 else 0
    health = sensors.health | control
    health |= sensors.fix_health if has_passed(config, memory, readiness.fix_s) else 0
    health |= sensors.arming_health if has_passed(config, memory, sensors.arming_s) else 0
    charge = charge_of(memory, config)
    return mavlink.MAVLink_sys_status_message(
        sensors.present,
        sensors.enabled | control | fenced,
        health,
        200,
        _millivolts(charge, memory),
        _current_ca(memory, config),
        _percent(charge),
        0,
        0,
        0,
        0,
        0,
        0,
    )


def battery_status(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return BATTERY_STATUS of a battery that the running motors empty evenly."""
    charge = charge_of(memory, config)
    return mavlink.MAVLink_battery_status_message(
        0,
        mavlink.MAV_BATTERY_FUNCTION_ALL,
        mavlink.MAV_BATTERY_TYPE_LIPO,
        32767,
        (_millivolts(charge, memory), *(_UNKNOWN_MV,) * 9),
        _current_ca(memory, config),
        _consumed_mah(memory, charge) if config.firmware.condition.current_ca is None else 0,
        -1,
        _percent(charge),
        0,
        _CHARGE_STATES[memory.safety.watch.level],
    )


def _current_ca(memory: AutopilotMemory, config: AutopilotConfig) -> int:
    """What the motors take, where that is measured."""
    if config.firmware.condition.current_ca is not None:
        return config.firmware.condition.current_ca
    return (
        0
        if memory.armed_ns is None
        else min(32767, round(_CAPACITY_TO_CA * _capacity_mah(memory) / config.endurance_s))
    )


def _consumed_mah(memory: AutopilotMemory, charge: float) -> int:
    return round((1.0 - charge) * _capacity_mah(memory))


def _capacity_mah(memory: AutopilotMemory) -> float:
    return max(0.0, memory.tuning.values["BATT_CAPACITY"])


def _millivolts(charge: float, memory: AutopilotMemory) -> int:
    empty_v, full_v = memory.tuning.settings.simulation.battery_v
    return round(1000.0 * (empty_v + charge * (full_v - empty_v)))


def _percent(charge: float) -> int:
    return round(100.0 * charge)


def system_time(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return SYSTEM_TIME: UTC beside the boot clock."""
    return mavlink.MAVLink_system_time_message(memory.now.t_ns // 1000, boot_ms(memory))


def timesync_question(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return a TIMESYNC that asks for the other side's clock."""
    return mavlink.MAVLink_timesync_message(0, memory.now.boot_ns)


def timesync_answer(question: Message, boot_ns: int) -> Message:
    """Return the answer to a TIMESYNC that came at `boot_ns`."""
    return mavlink.MAVLink_timesync_message(max(boot_ns, 1), question.ts1)


def ping_answer(question: Message) -> Message:
    """Return the answer to a PING that was for everybody."""
    return mavlink.MAVLink_ping_message(
        question.time_usec, question.seq, question.get_srcSystem(), question.get_srcComponent()
    )


def extended_sys_state(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return EXTENDED_SYS_STATE."""
    return mavlink.MAVLink_extended_sys_state_message(config.firmware.condition.vtol_state, _landed_state(memory))


def _landed_state(memory: AutopilotMemory) -> int:
    if memory.course.landing.landed:
        return int(mavlink.MAV_LANDED_STATE_ON_GROUND)
    if memory.modes.mode is Mode.TAKEOFF or (memory.modes.mode is Mode.OFFBOARD and is_rising(memory.course.guided)):
        return int(mavlink.MAV_LANDED_STATE_TAKEOFF)
    target_landing = memory.course.flight.target_landing
    if memory.modes.mode is Mode.LAND or (target_landing is not None and target_landing.stage in SINKING):
        return int(mavlink.MAV_LANDED_STATE_LANDING)
    return int(mavlink.MAV_LANDED_STATE_IN_AIR)


def current_mode(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return CURRENT_MODE: the mode flown and the mode asked for."""
    modes = config.firmware.modes.codes
    flown, asked = modes[memory.modes.mode].custom_mode, modes[memory.modes.intended].custom_mode
    return mavlink.MAVLink_current_mode_message(0, flown, asked)


def orbit_execution_status(memory: AutopilotMemory, config: AutopilotConfig) -> Message | None:
    """Return the centre, the radius (negative against the clock) and the present altitude of the orbit.

    None while none is flown: disarmed, or in another mode.
    """
    orbit = memory.course.flight.orbit
    if orbit is None or memory.modes.mode is not Mode.ORBIT or memory.armed_ns is None:
        return None
    east_m, north_m, _ = orbit.centre_enu_m
    latitude, longitude, altitude_m = geodetic_from_enu(config.datum, (east_m, north_m, orbit.height_m))
    return mavlink.MAVLink_orbit_execution_status_message(
        memory.now.boot_ns // 1000,
        copysign(orbit.radius_m, orbit.speed_m_s),
        mavlink.MAV_FRAME_GLOBAL,
        round(degrees(latitude) * 1e7),
        round(degrees(longitude) * 1e7),
        altitude_m,
    )
