"""Messages about the autopilot's condition: mode, health, battery, clock, landed state."""

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.arming import is_ready
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.modes import Mode

_FULL_MV = 16200
_EMPTY_MV = 14000
_UNKNOWN_MV = 65535
_MAVLINK_VERSION = 3


def boot_ms(memory: AutopilotMemory) -> int:
    """Return milliseconds since boot as the 32 bits on the wire hold them."""
    return memory.now.boot_ns // 1_000_000 & 0xFFFFFFFF


def heartbeat(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return the HEARTBEAT."""
    code = config.firmware.modes[memory.modes.mode]
    armed = mavlink.MAV_MODE_FLAG_SAFETY_ARMED if memory.armed_ns is not None else 0
    return mavlink.MAVLink_heartbeat_message(
        mavlink.MAV_TYPE_QUADROTOR,
        config.firmware.autopilot_id,
        code.base_mode | armed,
        code.custom_mode,
        _system_status(memory, config),
        _MAVLINK_VERSION,
    )


def _system_status(memory: AutopilotMemory, config: AutopilotConfig) -> int:
    if memory.armed_ns is not None:
        return int(mavlink.MAV_STATE_CRITICAL if memory.modes.failsafe else mavlink.MAV_STATE_ACTIVE)
    return int(mavlink.MAV_STATE_STANDBY if is_ready(config, memory.now.boot_ns) else mavlink.MAV_STATE_UNINIT)


def sys_status(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return SYS_STATUS, whose health says whether it can arm."""
    sensors = config.firmware.sensors
    health = sensors.health | (sensors.arming_health if is_ready(config, memory.now.boot_ns) else 0)
    charge = _charge(memory, config)
    return mavlink.MAVLink_sys_status_message(
        sensors.present, sensors.enabled, health, 200, _millivolts(charge), -1, _percent(charge), 0, 0, 0, 0, 0, 0
    )


def battery_status(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return BATTERY_STATUS of a battery that the running motors empty evenly."""
    charge = _charge(memory, config)
    return mavlink.MAVLink_battery_status_message(
        0,
        mavlink.MAV_BATTERY_FUNCTION_ALL,
        mavlink.MAV_BATTERY_TYPE_LIPO,
        32767,
        (_millivolts(charge), *(_UNKNOWN_MV,) * 9),
        -1,
        -1,
        -1,
        _percent(charge),
        0,
        mavlink.MAV_BATTERY_CHARGE_STATE_OK,
    )


def _charge(memory: AutopilotMemory, config: AutopilotConfig) -> float:
    ran_s = memory.motors_ran_s
    if memory.armed_ns is not None:
        ran_s += (memory.now.boot_ns - memory.armed_ns) * 1e-9
    return max(0.0, 1.0 - ran_s / config.endurance_s)


def _millivolts(charge: float) -> int:
    return round(_EMPTY_MV + charge * (_FULL_MV - _EMPTY_MV))


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


def extended_sys_state(memory: AutopilotMemory, _config: AutopilotConfig) -> Message:
    """Return EXTENDED_SYS_STATE."""
    return mavlink.MAVLink_extended_sys_state_message(mavlink.MAV_VTOL_STATE_UNDEFINED, _landed_state(memory))


def _landed_state(memory: AutopilotMemory) -> int:
    if memory.landing.landed:
        return int(mavlink.MAV_LANDED_STATE_ON_GROUND)
    if memory.modes.mode is Mode.TAKEOFF:
        return int(mavlink.MAV_LANDED_STATE_TAKEOFF)
    if memory.modes.mode is Mode.LAND:
        return int(mavlink.MAV_LANDED_STATE_LANDING)
    return int(mavlink.MAV_LANDED_STATE_IN_AIR)


def current_mode(memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return CURRENT_MODE: the mode flown and the mode asked for."""
    modes = config.firmware.modes
    flown, asked = modes[memory.modes.mode].custom_mode, modes[memory.modes.intended].custom_mode
    return mavlink.MAVLink_current_mode_message(0, flown, asked)


def autopilot_version(_memory: AutopilotMemory, config: AutopilotConfig) -> Message:
    """Return AUTOPILOT_VERSION."""
    firmware, no_hash = config.firmware, (0,) * 8
    return mavlink.MAVLink_autopilot_version_message(
        firmware.capabilities, firmware.version, 0, 0, 0, no_hash, no_hash, no_hash, 0, 0, config.system_id
    )
