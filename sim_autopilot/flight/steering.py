"""What an armed drone follows next: the mode's wish, by way of the spool-up and the lift-off."""

import numpy as np

from link.records import replace
from sim_autopilot.core.data import Reference
from sim_autopilot.core.modes import Mode
from sim_autopilot.flight.climb import Climb, asks_for_takeoff, has_lifted, is_idle, ramp
from sim_autopilot.flight.flight import Leg, ModeFlight, descend, descend_here, go_to, next_reference, pace_of
from sim_autopilot.flight.follow import chase_leader
from sim_autopilot.flight.land_detector import IN_AIR
from sim_autopilot.flight.manual import MANUAL_MODES, follow_sticks, sticks_in_effect
from sim_autopilot.flight.precision_landing import is_acquired, steer_to_target
from sim_autopilot.flight.target_stages import SINKING, begin_target_landing, next_stage
from sim_autopilot.flight.travel import Goal, move
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory, Course
from sim_autopilot.setpoints.guided import on_the_ground


def steer(memory: AutopilotMemory, config: AutopilotConfig, elapsed_s: float) -> Course:
    """Return what is followed for the next `elapsed_s`; without motors, or on the ground, that is nothing."""
    if memory.armed_ns is None:
        guided = on_the_ground(memory.course.guided, memory.now)
        return Course(
            flight=memory.course.flight, guided=guided, climb=None, landing=memory.course.landing, following=None
        )
    own = config.firmware.setpoints.steer(memory, elapsed_s) if memory.modes.mode is Mode.OFFBOARD else None
    if own is not None:
        return own
    flight, wanted = _wish(memory, elapsed_s)
    climb = _lift_off(memory, wanted, memory.armed_ns) if memory.course.landing.landed else memory.course.climb
    if climb is not None and wanted is not None:
        return _climb(memory, flight, climb, wanted)
    following = None if memory.course.landing.landed else wanted
    return Course(
        flight=flight, guided=memory.course.guided, climb=None, landing=memory.course.landing, following=following
    )


def over_target(memory: AutopilotMemory, course: Course, elapsed_s: float) -> tuple[AutopilotMemory, Course]:
    """Return the memory and the course for the next `elapsed_s`, LAND's over a target that is in sight.

    LAND sinks on from where it was held up: what the target kept the drone from is not made up for.
    """
    settings, target, following = memory.tuning.settings, memory.heard.target, course.following
    limits = settings.path
    if target is None or following is None or limits is None or memory.modes.mode is not Mode.LAND:
        return memory, course
    if not is_acquired(target, memory.now.boot_ns):
        return memory, course
    target, following = steer_to_target(target, following, memory.now, settings.land.precision, limits, elapsed_s)
    flight = course.flight
    if following.position_enu_m is not None:
        flight = replace(flight, sinking_m=max(flight.sinking_m, float(following.position_enu_m[2])))
    return replace(memory, heard=replace(memory.heard, target=target)), replace(
        course, flight=flight, following=following
    )


def _wish(memory: AutopilotMemory, elapsed_s: float) -> tuple[ModeFlight, Reference | None]:
    """What the mode asks for, of the sticks where it is theirs and somebody holds them."""
    mode, now = memory.modes.mode, memory.now
    sticks = sticks_in_effect(memory.heard.sticks, now.boot_ns, memory.tuning.settings.sticks)
    if mode in MANUAL_MODES and sticks is not None and not (mode is Mode.POSITION and memory.modes.failsafe):
        return follow_sticks(memory.course.flight, mode, sticks, now, memory.tuning.settings, elapsed_s)
    if mode is Mode.PRECISION_LAND:
        return _land_on_target(memory, elapsed_s)
    leader = memory.heard.leader
    if mode is Mode.FOLLOW and leader is not None:
        follow = memory.tuning.settings.follow
        chase, reference = chase_leader(
            memory.course.flight.chase, leader, now, memory.places.home_enu_m, settings=follow, elapsed_s=elapsed_s
        )
        return replace(memory.course.flight, chase=chase), reference
    return next_reference(
        memory.course.flight,
        memory.modes,
        now,
        setpoints=memory.heard.setpoints,
        home_enu_m=memory.places.home_enu_m,
        settings=memory.tuning.settings,
        elapsed_s=elapsed_s,
    )


def _land_on_target(memory: AutopilotMemory, elapsed_s: float) -> tuple[ModeFlight, Reference]:
    """What PX4's precision landing asks for: a point on its way to a place, or one that sinks there."""
    flight, now, settings, home = memory.course.flight, memory.now, memory.tuning.settings, memory.places.home_enu_m
    landing = flight.target_landing
    if landing is None:
        stop = now.position_enu_m if flight.anchor.position_enu_m is None else flight.anchor.position_enu_m
        landing = begin_target_landing((float(stop[0]), float(stop[1]), float(stop[2])), now.boot_ns)
    landing = next_stage(landing, memory.heard.target, now, settings.land.target, home[2], settings.travel.reached_m)
    flight = replace(flight, target_landing=landing)
    if landing.stage in SINKING:
        flight = flight if flight.leg is Leg.DESCEND else descend_here(flight, now)
        flight = replace(flight, anchor=replace(flight.anchor, position_enu_m=np.array(landing.place_enu_m)))
        return descend(flight, now, home, settings, elapsed_s)
    goal = Goal(position_enu_m=landing.place_enu_m, speed_m_s=settings.travel.cruise_m_s)
    flight = go_to(flight, goal, now)
    flight = replace(flight, goal=goal, anchor=move(flight.anchor, goal, pace_of(settings), elapsed_s))
    return flight, flight.anchor


def _climb(memory: AutopilotMemory, flight: ModeFlight, climb: Climb, wanted: Reference) -> Course:
    settings = memory.tuning.settings
    rate_m_s = settings.envelope.climb_max_m_s
    if memory.modes.mode is Mode.TAKEOFF:
        rate_m_s = min(rate_m_s, settings.takeoff.climb_m_s)
    elapsed_s, ramp_s = (memory.now.boot_ns - climb.start_ns) * 1e-9, settings.takeoff.ramp_s
    landing = IN_AIR if has_lifted(elapsed_s, ramp_s) else memory.course.landing
    if is_idle(elapsed_s, rate_m_s, ramp_s):
        return Course(flight=flight, guided=memory.course.guided, climb=climb, landing=landing, following=None)
    slowed = ramp(wanted, climb, elapsed_s, rate_m_s, ramp_s)
    if slowed is None:
        return Course(flight=flight, guided=memory.course.guided, climb=None, landing=IN_AIR, following=wanted)
    return Course(flight=flight, guided=memory.course.guided, climb=climb, landing=landing, following=slowed)


def _lift_off(memory: AutopilotMemory, wanted: Reference | None, armed_ns: int) -> Climb | None:
    """Return the climb of a drone on the ground: the one under way, a new one, or None where it stays."""
    boot_ns, height_m, climb = memory.now.boot_ns, memory.now.position_enu_m[2], memory.course.climb
    spooled = (boot_ns - armed_ns) * 1e-9 >= memory.tuning.settings.takeoff.spool_up_s
    if climb is not None or not spooled or not asks_for_takeoff(wanted, height_m):
        return climb
    return Climb(start_ns=boot_ns, base_m=height_m)
