"""Motors on and off: who may when, and by itself after a landing or an idle wait."""

from dataclasses import replace

from sim_autopilot.land_detector import Landing
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.modes import Mode
from sim_autopilot.setpoints import are_streaming


def is_ready(config: AutopilotConfig, boot_ns: int) -> bool:
    """Return whether the autopilot has booted far enough to arm."""
    return config.instant or boot_ns * 1e-9 >= config.firmware.readiness.arming_s


def arming_obstacle(memory: AutopilotMemory, config: AutopilotConfig) -> str | None:
    """Return why it does not arm, None where it does."""
    if not is_ready(config, memory.now.boot_ns):
        return "not ready"
    if memory.modes.intended in config.firmware.unarmable_modes:
        return f"mode {memory.modes.intended.value}"
    if memory.modes.intended is Mode.OFFBOARD and not may_fly_setpoints(memory, config):
        return "no setpoints"
    return None


def may_fly_setpoints(memory: AutopilotMemory, config: AutopilotConfig) -> bool:
    """Return whether setpoints come so steadily that OFFBOARD can be entered."""
    loss_s, stream_s = memory.settings.setpoint_loss_s, config.firmware.setpoint_stream_s
    return are_streaming(memory.setpoints, memory.now.boot_ns, loss_s, stream_s)


def arm(memory: AutopilotMemory) -> AutopilotMemory:
    """Return the memory with the motors on, and home here."""
    if memory.armed_ns is not None:
        return memory
    now = memory.now
    return replace(memory, armed_ns=now.boot_ns, landing=Landing(), climb=None, home_enu_m=now.position_enu_m)


def disarm(memory: AutopilotMemory) -> AutopilotMemory:
    """Return the memory with the motors off; the drone counts as landed from then on, wherever it is."""
    if memory.armed_ns is None:
        return memory
    ran_s = memory.motors_ran_s + (memory.now.boot_ns - memory.armed_ns) * 1e-9
    return replace(memory, armed_ns=None, landing=Landing(), climb=None, following=None, motors_ran_s=ran_s)


def should_disarm(memory: AutopilotMemory) -> bool:
    """Return whether it is time to stop the motors unasked."""
    armed_ns, landing, settings = memory.armed_ns, memory.landing, memory.settings
    if armed_ns is None or not landing.landed or memory.climb is not None:
        return False
    if landing.landed_ns is not None:
        limit_s, since_ns = settings.disarm_landed_s, landing.landed_ns
    else:
        limit_s, since_ns = settings.disarm_idle_s, armed_ns + round(settings.spool_up_s * 1e9)
    return limit_s is not None and (memory.now.boot_ns - since_ns) * 1e-9 >= limit_s
