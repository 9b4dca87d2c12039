"""The landing's status for the world, from a step's memory and facts."""

from companion.config.companion import CompanionConfig
from companion.config.landing import DescentConfig
from companion.landing.step_data import StepMemory
from companion.landing.targets import sink_stretches
from companion.landing.waiting import why_held_up
from companion.situation.phases import Phase
from companion.situation.situation import Approach, Situation, approach
from link.messages import LandingStatus

_WAITING_FOR_PAD = frozenset({Phase.WAITING, Phase.CHASE, Phase.ALIGN})
_NOT_BEGUN = frozenset({Phase.IDLE, Phase.WAITING})
_TIMED_PHASES = frozenset({Phase.ALIGN, Phase.DESCEND})


def landing_status(memory: StepMemory, situation: Situation, config: CompanionConfig) -> LandingStatus:
    """Return the status; the counters of bad bytes are filled in by whoever counts them."""
    relative = approach(situation)
    timed = memory.phase in _TIMED_PHASES and relative is not None
    return LandingStatus(
        stamp_ns=situation.t_ns,
        phase=memory.phase.value,
        reason=_reason(memory, situation, config),
        relative_position_enu_m=None if relative is None else relative.position_enu_m,
        relative_velocity_enu_m_s=None if relative is None else relative.velocity_enu_m_s,
        height_above_pad_m=None if relative is None else relative.height_m,
        time_to_contact_s=_time_to_contact_s(relative, config.descent) if timed and relative is not None else None,
        mavlink_bad_bytes=0,
        zenoh_bad_payloads=0,
        armed=situation.autopilot.armed,
        fix_age_s=situation.fix_age_s,
    )


def _reason(memory: StepMemory, situation: Situation, config: CompanionConfig) -> str:
    """Return what the landing waits for, or why its phase began."""
    if memory.phase in _WAITING_FOR_PAD and situation.pad is not None and situation.pad.unplaced is not None:
        return situation.pad.unplaced
    if memory.phase in _NOT_BEGUN and memory.obstacle is not None:
        return memory.obstacle[1]
    awaited = why_held_up(memory, situation, config)
    return memory.reason if awaited is None else f"waits above the pad: {awaited}"


def _time_to_contact_s(relative: Approach, descent: DescentConfig) -> float:
    """Return how long the sink profile takes from the present height: fast, slowing down, slow."""
    stretches = sink_stretches(relative.height_m, descent)
    slow_s = max(stretches.slow_from_m, 0.0) / descent.touchdown_sink_rate_m_s
    return stretches.fast_s + stretches.slowing_s + slow_s
