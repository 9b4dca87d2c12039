"""What the world is told of a step: the landing's status, and the plan thinned out."""

import math
from typing import NamedTuple

from companion.config.companion import CompanionConfig
from companion.config.landing import DescentConfig
from companion.core.reasons import Cause, sentence
from companion.landing.aborts import unplaced
from companion.landing.memory import StepMemory
from companion.landing.waiting import why_held_up
from companion.planning.guidance import PlanResult
from companion.situation.phases import Phase
from companion.situation.situation import Approach, Situation
from link.messages import LandingStatus, Plan, PlannedPose
from link.payloads import cdr, json_messages
from link.zenoh.keys import Keys, Publication

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
    stretches = _sink_stretches(relative.height_m, descent)
    slow_s = max(stretches.slow_from_m, 0.0) / descent.touchdown_sink_rate_m_s
    return stretches.fast_s + stretches.slowing_s + slow_s


_PLAN_POINTS = 2  # every so many points of the plan are published


def status_publication(keys: Keys, status: LandingStatus) -> Publication:
    """Return the status as JSON."""
    return Publication(keys.landing_status, json_messages.encode(status), "application/json")


def plan_publication(keys: Keys, plan: PlanResult, t_ns: int, yaw_rad: float) -> Publication:
    """Return the planned motion as a path.

    Args:
        keys: of the Zenoh contract.
        plan: of a step.
        t_ns: of that step, UTC.
        yaw_rad: the heading that is flown, from East counter-clockwise.
    """
    trajectory = plan.trajectory
    offsets_s = trajectory.offset_s[::_PLAN_POINTS].tolist()
    points = zip(offsets_s, trajectory.position_enu_m[::_PLAN_POINTS].tolist(), strict=True)
    poses = tuple(
        PlannedPose(t_ns=t_ns + int(offset_s * 1e9), position_enu_m=(x, y, z), yaw_rad=yaw_rad)
        for offset_s, (x, y, z) in points
    )
    return Publication(keys.landing_plan, cdr.encode(Plan(t_ns=t_ns, poses=poses)), cdr.encoding_of(Plan))


class _SinkStretches(NamedTuple):
    """A descent's three stretches one after the other: at the largest rate, slowing down exponentially, at the slowest.

    Attributes:
        fast_s: how long the first takes.
        slowing_from_m: height over the pad at which the second begins.
        slowing_s: how long it takes.
        slow_from_m: height at which the third begins.
    """

    fast_s: float
    slowing_from_m: float
    slowing_s: float
    slow_from_m: float


def _sink_stretches(height_now_m: float, config: DescentConfig) -> _SinkStretches:
    """Return how a descent from a height over the pad goes: it sinks at the height times the gain, within limits."""
    fast_m_s, slow_m_s, gain_hz = config.descent_rate_max_m_s, config.touchdown_sink_rate_m_s, config.descent_gain_hz
    slowing_from_m = min(height_now_m, fast_m_s / gain_hz)
    slow_from_m = min(slowing_from_m, slow_m_s / gain_hz)
    return _SinkStretches(
        fast_s=max(height_now_m - slowing_from_m, 0.0) / fast_m_s,
        slowing_from_m=slowing_from_m,
        slowing_s=math.log(slowing_from_m / slow_from_m) / gain_hz if slowing_from_m > slow_from_m else 0.0,
        slow_from_m=slow_from_m,
    )
