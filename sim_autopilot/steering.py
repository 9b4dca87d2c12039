"""What an armed drone follows next: the mode's wish, by way of the spool-up and the lift-off."""

from dataclasses import dataclass

from sim_autopilot.climb import Climb, asks_for_takeoff, has_lifted, is_idle, ramped
from sim_autopilot.data import Reference
from sim_autopilot.flight import ModeFlight, next_reference
from sim_autopilot.land_detector import IN_AIR, Landing
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.modes import Mode


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Steering:
    """The parts of the memory that steering changes."""

    flight: ModeFlight
    climb: Climb | None
    landing: Landing
    following: Reference | None


def steer(memory: AutopilotMemory, config: AutopilotConfig, elapsed_s: float) -> Steering:
    """Return what is followed for the next `elapsed_s`; without motors, or on the ground, that is nothing."""
    if memory.armed_ns is None:
        return Steering(flight=memory.flight, climb=None, landing=memory.landing, following=None)
    flight, wanted = next_reference(
        memory.flight,
        memory.modes,
        memory.now,
        setpoints=memory.setpoints,
        home_enu_m=memory.home_enu_m,
        settings=memory.settings,
        elapsed_s=elapsed_s,
    )
    climb = _lift_off(memory, config, wanted, memory.armed_ns) if memory.landing.landed else memory.climb
    if climb is not None and wanted is not None:
        return _climbing(memory, flight, climb, wanted)
    following = None if memory.landing.landed else wanted
    return Steering(flight=flight, climb=None, landing=memory.landing, following=following)


def _climbing(memory: AutopilotMemory, flight: ModeFlight, climb: Climb, wanted: Reference) -> Steering:
    settings = memory.settings
    rate_m_s = settings.climb_max_m_s
    if memory.modes.mode is Mode.TAKEOFF:
        rate_m_s = min(rate_m_s, settings.takeoff_climb_m_s)
    elapsed_s, ramp_s = (memory.now.boot_ns - climb.start_ns) * 1e-9, settings.takeoff_ramp_s
    landing = IN_AIR if has_lifted(elapsed_s, ramp_s) else memory.landing
    if is_idle(elapsed_s, rate_m_s, ramp_s):
        return Steering(flight=flight, climb=climb, landing=landing, following=None)
    slowed = ramped(wanted, climb, elapsed_s, rate_m_s, ramp_s)
    if slowed is None:
        return Steering(flight=flight, climb=None, landing=IN_AIR, following=wanted)
    return Steering(flight=flight, climb=climb, landing=landing, following=slowed)


def _lift_off(
    memory: AutopilotMemory, config: AutopilotConfig, wanted: Reference | None, armed_ns: int
) -> Climb | None:
    """Return the climb of a drone on the ground: the one under way, a new one, or None where it stays."""
    if memory.modes.mode is Mode.OFFBOARD and not config.firmware.takes_off_by_setpoint:
        return None
    boot_ns, height_m = memory.now.boot_ns, memory.now.position_enu_m[2]
    spooled = (boot_ns - armed_ns) * 1e-9 >= memory.settings.spool_up_s
    if memory.climb is not None or not spooled or not asks_for_takeoff(wanted, height_m):
        return memory.climb
    return Climb(start_ns=boot_ns, base_m=height_m)
