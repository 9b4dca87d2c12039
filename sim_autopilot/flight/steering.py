"""What an armed drone follows next: the mode's wish, by way of the spool-up and the lift-off."""

from dataclasses import dataclass, replace

from sim_autopilot.data import Reference
from sim_autopilot.flight.climb import Climb, asks_for_takeoff, has_lifted, is_idle, ramped
from sim_autopilot.flight.flight import ModeFlight, next_reference
from sim_autopilot.flight.follow import chased
from sim_autopilot.flight.land_detector import IN_AIR, Landing
from sim_autopilot.flight.manual import MANUAL_MODES, follow_sticks, sticks_in_effect
from sim_autopilot.flight.modes import Mode
from sim_autopilot.flight.precision_landing import is_acquired, steered
from sim_autopilot.memory import AutopilotConfig, AutopilotMemory
from sim_autopilot.setpoints.guided import Guided, has_run_up, lifted, next_guided, on_the_ground


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Steering:
    """The parts of the memory that steering changes."""

    flight: ModeFlight
    guided: Guided
    climb: Climb | None
    landing: Landing
    following: Reference | None


def steer(memory: AutopilotMemory, config: AutopilotConfig, elapsed_s: float) -> Steering:
    """Return what is followed for the next `elapsed_s`; without motors, or on the ground, that is nothing."""
    if memory.armed_ns is None:
        guided = on_the_ground(memory.guided, memory.now)
        return Steering(flight=memory.flight, guided=guided, climb=None, landing=memory.landing, following=None)
    if config.firmware.guided and memory.modes.mode is Mode.OFFBOARD:
        return _guided(memory, elapsed_s)
    flight, wanted = _wish(memory, elapsed_s)
    climb = _lift_off(memory, config, wanted, memory.armed_ns) if memory.landing.landed else memory.climb
    if climb is not None and wanted is not None:
        return _climbing(memory, flight, climb, wanted)
    following = None if memory.landing.landed else wanted
    return Steering(flight=flight, guided=memory.guided, climb=None, landing=memory.landing, following=following)


def over_target(
    memory: AutopilotMemory, following: Reference | None, elapsed_s: float
) -> tuple[AutopilotMemory, Reference | None]:
    """Return the memory and what is followed for the next `elapsed_s`, LAND's over a target that is in sight."""
    services, settings = memory.services, memory.settings
    target, limits = services.target, settings.path
    if target is None or following is None or limits is None or memory.modes.mode is not Mode.LAND:
        return memory, following
    if not is_acquired(target, memory.now.boot_ns):
        return memory, following
    target, following = steered(target, following, memory.now, settings.landing, limits, elapsed_s)
    return replace(memory, services=replace(services, target=target)), following


def _wish(memory: AutopilotMemory, elapsed_s: float) -> tuple[ModeFlight, Reference | None]:
    """What the mode asks for, of the sticks where it is theirs and somebody holds them."""
    mode, now = memory.modes.mode, memory.now
    sticks = sticks_in_effect(memory.services.sticks, now.boot_ns, memory.settings.sticks)
    if mode in MANUAL_MODES and sticks is not None and not (mode is Mode.POSITION and memory.modes.failsafe):
        return follow_sticks(memory.flight, mode, sticks, now, memory.settings, elapsed_s)
    leader = memory.services.leader
    if mode is Mode.FOLLOW and leader is not None:
        follow = memory.settings.follow
        chase, reference = chased(
            memory.flight.chase, leader, now, memory.home_enu_m, settings=follow, elapsed_s=elapsed_s
        )
        return replace(memory.flight, chase=chase), reference
    return next_reference(
        memory.flight,
        memory.modes,
        now,
        setpoints=memory.setpoints,
        home_enu_m=memory.home_enu_m,
        settings=memory.settings,
        elapsed_s=elapsed_s,
    )


def _guided(memory: AutopilotMemory, elapsed_s: float) -> Steering:
    """GUIDED leaves the ground by its own take-off only, whatever setpoints ask for."""
    settings, guided, landing, now = memory.settings, memory.guided, memory.landing, memory.now
    if settings.path is None:
        raise ValueError("a firmware with GUIDED has limits of its path")
    if landing.landed and has_run_up(guided, now, settings.path):
        guided, landing = lifted(guided, now), IN_AIR
    if landing.landed:
        guided = on_the_ground(guided, now)
        return Steering(flight=memory.flight, guided=guided, climb=None, landing=landing, following=None)
    guided, reference = next_guided(guided, now, settings, settings.path, elapsed_s)
    return Steering(flight=memory.flight, guided=guided, climb=None, landing=landing, following=reference)


def _climbing(memory: AutopilotMemory, flight: ModeFlight, climb: Climb, wanted: Reference) -> Steering:
    settings = memory.settings
    rate_m_s = settings.climb_max_m_s
    if memory.modes.mode is Mode.TAKEOFF:
        rate_m_s = min(rate_m_s, settings.takeoff_climb_m_s)
    elapsed_s, ramp_s = (memory.now.boot_ns - climb.start_ns) * 1e-9, settings.takeoff_ramp_s
    landing = IN_AIR if has_lifted(elapsed_s, ramp_s) else memory.landing
    if is_idle(elapsed_s, rate_m_s, ramp_s):
        return Steering(flight=flight, guided=memory.guided, climb=climb, landing=landing, following=None)
    slowed = ramped(wanted, climb, elapsed_s, rate_m_s, ramp_s)
    if slowed is None:
        return Steering(flight=flight, guided=memory.guided, climb=None, landing=IN_AIR, following=wanted)
    return Steering(flight=flight, guided=memory.guided, climb=climb, landing=landing, following=slowed)


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
