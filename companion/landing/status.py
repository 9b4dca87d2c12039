"""The landing's status for the world, from a step's memory and facts."""

from companion.config.companion import CompanionConfig
from companion.config.landing import DescentConfig
from companion.core.reasons import Cause, sentence
from companion.landing.aborts import unplaced
from companion.landing.memory import StepMemory
from companion.landing.targets import sink_stretches
from companion.landing.waiting import why_held_up
from companion.situation.phases import Phase
from companion.situation.situation import Approach, Situation
from link.messages import LandingStatus

_WAITING_FOR_PAD = frozenset({Phase.WAITING, Phase.CHASE, Phase.ALIGN})
_NOT_BEGUN = frozenset({Phase.IDLE, Phase.WAITING})
_TIMED_PHASES = frozenset({Phase.ALIGN, Phase.DESCEND})


def landing_status(memory: StepMemory, situation: Situation, config: CompanionConfig) -> LandingStatus:
    """Return the status; the counters of bad bytes are filled in by whoever counts them."""
    relative, cause = situation.approach, _cause(memory, situation, config)
    phase = memory.progress.phase
    timed = phase in _TIMED_PHASES and relative is not None
    return LandingStatus(
        stamp_ns=situation.t_ns,
        phase=phase.value,
        reason=sentence(cause),
        reason_code=cause.reason.name,
        relative_position_enu_m=None if relative is None else relative.position_enu_m,
        relative_velocity_enu_m_s=None if relative is None else relative.velocity_enu_m_s,
        height_above_pad_m=None if relative is None else relative.height_m,
        time_to_contact_s=_time_to_contact_s(relative, config.descent) if timed and relative is not None else None,
        mavlink_bad_bytes=0,
        zenoh_bad_payloads=0,
        armed=situation.autopilot.armed,
        fix_age_s=situation.vehicle.fix_age_s,
    )


def _cause(memory: StepMemory, situation: Situation, config: CompanionConfig) -> Cause:
    """Return what the landing waits for, or why its phase began."""
    progress, not_placed = memory.progress, unplaced(situation)
    if progress.phase in _WAITING_FOR_PAD and not_placed is not None:
        return not_placed
    if progress.phase in _NOT_BEGUN and progress.obstacle is not None:
        return progress.obstacle
    return why_held_up(memory, situation, config) or progress.cause


def _time_to_contact_s(relative: Approach, descent: DescentConfig) -> float:
    """Return how long the sink profile takes from the present height: fast, slowing down, slow."""
    stretches = sink_stretches(relative.height_m, descent)
    slow_s = max(stretches.slow_from_m, 0.0) / descent.touchdown_sink_rate_m_s
    return stretches.fast_s + stretches.slowing_s + slow_s
