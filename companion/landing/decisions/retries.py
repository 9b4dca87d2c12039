"""Decides how a climb after an abort ends: with another approach, or with a hold and what forbids one."""

from companion.config.companion import CompanionConfig
from companion.core.reasons import Cause, Reason, sentence
from companion.integrity.frames import tell_unheard
from companion.integrity.stamps import named_by_stamps
from companion.landing.decisions.aborts import is_out_of_range, why_unplaced
from companion.landing.decisions.conditions import (
    HEARD,
    holds,
    is_attitude_unknown,
    is_fix_old,
    is_heading_to_be_shown,
)
from companion.landing.decisions.entries import Decision
from companion.landing.decisions.feasibility import obstacle
from companion.landing.state.memory import Progress
from companion.situation.phases import Event
from companion.situation.situation import Situation

_LASTING = (
    Reason.OFFSET_UNKNOWN,
    Reason.SIGHTINGS_UNPLACED,
    Reason.SEEN_ELSEWHERE,
    Reason.SIGHTINGS_DISAGREE,
    Reason.SIGHTINGS_IMPOSSIBLE,
    Reason.ROAD_BELOW,
)
"""What the drone looked with the first time is all that it has to look with."""


def end_climb(progress: Progress, s: Situation, config: CompanionConfig) -> Decision | None:
    """Return the event that ends a climb after an abort, None while it goes on."""
    in_phase_s = (s.monotonic_ns - progress.since_ns) * 1e-9
    crest_m = 0.0 if s.pad is None else s.pad.crest_above_m
    high = s.approach is not None and s.approach.height_m > 0.8 * config.abort.height_m + crest_m
    ready = high and holds(HEARD, progress.held, s, config)
    if not ready and in_phase_s < config.abort.time_limit_s:
        return None
    why_not = _no_retry(progress, s, config)
    if why_not is not None:
        return Event.CLEAR_TO_HOLD, why_not
    if progress.interrupted_ns is not None:
        return Event.CLEAR, Cause(Reason.HEARD_AGAIN)
    return Event.CLEAR, Cause(Reason.RETRY, (progress.retries + 1, config.abort.retries_max))


def _no_retry(progress: Progress, s: Situation, config: CompanionConfig) -> Cause | None:
    """Return why no other approach is made, the first of all causes; None when one is."""
    known = {
        Reason.BROKEN_OFF: not progress.may_retry,
        Reason.NO_VEHICLE_DATA: is_fix_old(s, config),
        Reason.OWN_POSITION_OLD: s.drone is None,
        Reason.OWN_ATTITUDE_OLD: is_attitude_unknown(s, config),
        Reason.HEARD_WITH_BREAKS: not holds(HEARD, progress.held, s, config),
    }
    first = next((Cause(reason) for reason, holds_now in known.items() if holds_now), None)
    impossible = obstacle(progress.held, s, config)
    if first == Cause(Reason.NO_VEHICLE_DATA):
        first = named_by_stamps(impossible) or _why_unheard(progress, s, config)
    if not (is_heading_to_be_shown(s, config) and progress.cause.reason is not Reason.HEADING_UNKNOWN):
        first = first or why_unplaced(s)  # a heading that an alignment has waited for in vain is not waited for again
    if first is None and progress.cause.reason in _LASTING:
        first = progress.cause
    if first is None and is_out_of_range(s, config):
        first = Cause(Reason.TOO_FAR_FROM_START)
    first = first or impossible
    is_last = progress.interrupted_ns is None and progress.retries >= config.abort.retries_max
    return Cause(Reason.NO_RETRY_LEFT, (sentence(progress.cause),)) if first is None and is_last else first


def _why_unheard(progress: Progress, s: Situation, config: CompanionConfig) -> Cause:
    """Return why nothing is known of the vehicle: of one that is only seen, what its last sightings were wrong by."""
    is_only_seen = config.silent_vehicle is not None
    return progress.cause if is_only_seen and progress.cause.reason in _LASTING else tell_unheard(s, config)
