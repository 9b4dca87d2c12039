"""How an autopilot that carries setpoints on is led in each phase, so that its drone outlives the companion; pure.

`carried_on` has what a setpoint may ask for.
"""

import math

from companion.autopilots.shaping import Shaping
from companion.config.companion import CompanionConfig
from companion.core.data import FlightLimits
from companion.landing.carried_on import Carried, bound_reference, rate_of, speed_carried_m_s
from companion.landing.feasibility import SPEED_SHARE_MIN
from companion.landing.memory import StepMemory
from companion.planning.guidance import ReferenceState
from companion.situation.phases import Phase
from companion.situation.situation import Situation
from link.records import replace

LOWEST_M = 0.8
"""Accepted: so far above the pad it then ends, unless it was nearer or was about to touch."""

# Of the vehicle's speed, up to which setpoints accelerate: of ArduCopter's default parameters 25 m leave that at 5 m/s.
_ACCELERATED_SHARE = 1.07


def limit_rates(
    limits: FlightLimits, situation: Situation, room_m: float | None, shaping: Shaping | None, config: CompanionConfig
) -> FlightLimits:
    """Return the limits of a plan, and for an autopilot that carries setpoints on the rates at which it may.

    It has to be somewhat faster than the vehicle, or it never catches up. It sinks as fast as it touches down, or
    faster as long as it can stop in time.

    Args:
        limits: without regard to that.
        situation: now.
        room_m: of the plan's beginning above where a setpoint has to end; None where it may touch.
        shaping: of the autopilot; None of one that holds setpoints as they came.
        config: all numbers.
    """
    if shaping is None:
        return limits
    speed_m_s = max(speed_carried_m_s(shaping), SPEED_SHARE_MIN * _vehicle_m_s(situation))
    limits = replace(limits, speed_max_m_s=min(limits.speed_max_m_s, speed_m_s))
    if room_m is None:
        return limits
    sink_m_s = max(rate_of(max(room_m, 0.0), shaping), config.descent.sink.contact_rate_m_s)
    if situation.pad is not None:
        sink_m_s += max(-float(situation.pad.velocity_enu_m_s[0, 2]), 0.0)
    return replace(limits, descent_max_m_s=min(limits.descent_max_m_s, sink_m_s))


def bound_carried(
    reference: ReferenceState,
    memory: StepMemory,
    situation: Situation,
    shaping: Shaping | None,
    config: CompanionConfig,
) -> ReferenceState:
    """Return what to ask for, so that it may be carried on, of an autopilot that is to follow `reference`.

    A drone that is committed is on the pad before a setpoint could carry it anywhere.
    """
    if shaping is None or _is_committed(memory, situation, config):
        return reference
    limits = config.limits.flight_limits() if situation.limits is None else situation.limits
    carried = Carried(
        speed_m_s=max(speed_carried_m_s(shaping), _ACCELERATED_SHARE * _vehicle_m_s(situation)),
        climb_m_s=limits.climb_max_m_s,
        lowest_enu_m=None if memory.model.plan is None else memory.model.plan.lowest_enu_m,
    )
    return bound_reference(reference, carried, shaping)


def _vehicle_m_s(situation: Situation) -> float:
    return 0.0 if situation.pad is None else math.hypot(*situation.pad.velocity_enu_m_s[0, :2].tolist())


def _is_committed(memory: StepMemory, situation: Situation, config: CompanionConfig) -> bool:
    relative, phase = situation.approach, memory.progress.phase
    is_low = relative is not None and relative.height_m < config.descent.commit_height_m
    return phase is Phase.TOUCHDOWN or (phase is Phase.DESCEND and is_low)


def lowest_enu_m(memory: StepMemory, situation: Situation, floor_enu_m: float, config: CompanionConfig) -> float | None:
    """Return above which height in W a setpoint that is carried on has to end; None once the drone may touch.

    Args:
        memory: with the phase.
        situation: now.
        floor_enu_m: of the phase's plan.
        config: all numbers.
    """
    phase, pad = memory.progress.phase, situation.pad
    if phase not in (Phase.DESCEND, Phase.TOUCHDOWN):
        return floor_enu_m
    if pad is None or _is_committed(memory, situation, config):
        return None
    return float(pad.position_enu_m[0, 2]) + situation.feet_offset_m + LOWEST_M
