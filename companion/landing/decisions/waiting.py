"""Why a descent waits above the pad, how low it may wait, and for how long; pure."""

import math

from companion.config.companion import CompanionConfig
from companion.core.reasons import Cause, Reason
from companion.landing.decisions.aborts import strays
from companion.landing.state.memory import Progress, StepMemory
from companion.situation.phases import Phase
from companion.situation.situation import Approach, Situation
from link.records import replace

_HELD_UP_M = 0.1  # above the height of waiting, down to which a descent sinks whether it is to wait or not


def waits_at_m(memory: StepMemory, situation: Situation, config: CompanionConfig) -> float | None:
    """Return how high above the pad a descent waits for now, None for one that goes on."""
    return None if _find_awaited(memory, situation, config) is None else _waiting_height_m(situation, config)


def _waiting_height_m(situation: Situation, config: CompanionConfig) -> float:
    is_coarse = situation.pad is not None and situation.pad.is_coarse
    return config.descent.wait.height_coarse_m if is_coarse else config.descent.wait.height_m


def why_held_up(memory: StepMemory, situation: Situation, config: CompanionConfig) -> Cause | None:
    """Return what a descent waits for that has come as low as it may, None for one that goes on."""
    relative = situation.approach
    if relative is None or relative.height_m > _waiting_height_m(situation, config) + _HELD_UP_M:
        return None
    return _find_awaited(memory, situation, config)


def update_wait(memory: StepMemory, situation: Situation, config: CompanionConfig) -> Progress:
    """Return the progress with the time for which this descent has waited for a smaller risk."""
    progress, now_ns = memory.progress, situation.monotonic_ns
    if _find_risk(memory, situation, config) is not None:
        return progress if progress.waits_since_ns is not None else replace(progress, waits_since_ns=now_ns)
    if progress.waits_since_ns is None:
        return progress
    return replace(progress, waits_since_ns=None, waited_s=waited_s(progress, now_ns))


def waited_s(progress: Progress, monotonic_ns: int) -> float:
    """Return for how long this descent has waited for a smaller risk."""
    since_ns = progress.waits_since_ns
    return progress.waited_s + (0.0 if since_ns is None else (monotonic_ns - since_ns) * 1e-9)


def _may_wait(memory: StepMemory, situation: Situation, config: CompanionConfig) -> bool:
    """Return whether this is a descent that is not committed yet."""
    if memory.progress.phase is not Phase.DESCEND or situation.approach is None:
        return False
    return situation.approach.height_m > config.descent.commit_height_m


def _find_awaited(memory: StepMemory, situation: Situation, config: CompanionConfig) -> Cause | None:
    relative = situation.approach
    if relative is None or not _may_wait(memory, situation, config):
        return None
    risk = _find_risk(memory, situation, config)
    if risk is not None:
        return risk
    if strays(situation, config):
        return Cause(Reason.NOT_OVER_PAD)
    if _is_off_centre(situation, relative, config):
        return Cause(Reason.OFF_CENTRE, (config.descent.wait.centred_distance_m,))
    return None


def _is_off_centre(situation: Situation, relative: Approach, config: CompanionConfig) -> bool:
    """Return whether the drone has to come nearer the centre first, while it may still see the pad.

    What it makes up for in the last second is speed against the pad, and where fixes are coarse nothing corrects it.
    """
    if situation.pad is None or not situation.pad.is_coarse or relative.height_m < config.descent.wait.centred_height_m:
        return False
    return relative.distance_m > config.descent.wait.centred_distance_m


def _find_risk(memory: StepMemory, situation: Situation, config: CompanionConfig) -> Cause | None:
    """Return that a contact begun now is forecast to be too risky.

    A driver may do something else at any time, so a descent that has begun goes back up from what has become much
    riskier. The deck of a ship is decided on once. What heaves back within the time that the contact takes has no quiet
    moment that can be seen from up here: waiting for one above cars that shake made contacts later and no better.
    """
    contact, pad, has_begun = memory.forecast.contact, situation.pad, memory.forecast.has_begun
    if contact is None or memory.forecast.risk is None or pad is None or not _may_wait(memory, situation, config):
        return None
    if pad.swing is not None and (has_begun or contact.in_s is None or contact.in_s > math.pi / pad.swing.heave_rad_s):
        return None
    risk, limits = memory.forecast.risk, config.descent.risk
    risk, most = (contact.unsafe, limits.turns_back_min) if has_begun else (risk, limits.begins_max)
    return Cause(Reason.MOMENT_RISKY, (most,)) if risk > most else None


def is_moment_quiet(risk: float | None, situation: Situation, config: CompanionConfig) -> bool:
    """Return whether a descent that has come to the height of waiting is to go on by the risk of its contact.

    A ship's deck is decided on once for all: one that judged again all the way down would turn back where a new wave is
    as near as the pad.
    """
    relative = situation.approach
    if risk is None or relative is None or relative.height_m > _waiting_height_m(situation, config) + _HELD_UP_M:
        return False
    return risk <= config.descent.risk.begins_max
