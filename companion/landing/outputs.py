"""What a step tells: the setpoint for the autopilot, the news for the pilot, status and plan for the world; pure."""

import numpy as np

from companion.autopilots.driver import AutopilotView
from companion.autopilots.own_reports import as_seen_with
from companion.config.companion import CompanionConfig
from companion.config.descent import DescentConfig
from companion.core.data import Array, FlightLimits, Setpoint
from companion.core.reasons import Cause, Reason, sentence
from companion.integrity.vehicle_data import unverified
from companion.landing.carried_on import bound_carried
from companion.landing.decisions.aborts import why_unplaced
from companion.landing.decisions.contact_trial import trial_press
from companion.landing.decisions.passing import why_not_chased
from companion.landing.decisions.waiting import why_held_up
from companion.landing.state.memory import Progress, StepMemory
from companion.landing.state.step_data import StepInputs
from companion.landing.steering.flown_plan import asked_for, extrapolate
from companion.landing.steering.targets import way_down
from companion.landing.steering.virtual_model import press_down, setpoint_at
from companion.planning.guidance import Trajectory
from companion.situation.phases import Phase
from companion.situation.situation import Approach, Situation
from link.messages import LandingStatus, Plan, PlannedPose, Vector3
from link.payloads import cdr, json_messages
from link.zenoh.keys import Keys, Publication


def setpoint(
    memory: StepMemory, inputs: StepInputs, situation: Situation, config: CompanionConfig, *, is_planned: bool = False
) -> Setpoint | None:
    """Return what the autopilot is to follow now, None while nothing is flown.

    Args:
        memory: after this step's plan.
        inputs: of this step.
        situation: of this step.
        config: all numbers.
        is_planned: whether this step has planned; there may be nothing to plan.
    """
    model = memory.model
    if model.reference is None or memory.control.driver.climbs_by_itself:
        return None
    ahead_s = inputs.ahead_s(config)
    if is_planned and model.plan is not None:
        cascade = None if inputs.response is None else inputs.response.cascade
        reference = asked_for(model.plan, cascade, 1.0 / config.setpoints.rate_hz)
    else:
        reference = extrapolate(model.reference, (inputs.monotonic_ns - model.reference_ns) * 1e-9 + ahead_s)
    press_m_s2 = _press_m_s2(memory, situation, config)
    if press_m_s2 is not None:
        reference = press_down(reference, press_m_s2, ahead_s)
    wanted = setpoint_at(
        bound_carried(reference, memory, situation, inputs.shaping, config),
        inputs.t_ns + round(ahead_s * 1e9),
        model.yaw_setpoint_rad,
        position_only=config.setpoints.position_only,
    )
    return wanted if inputs.own is None else as_seen_with(wanted, inputs.own.velocity_bias_enu_m_s)


def _press_m_s2(memory: StepMemory, situation: Situation, config: CompanionConfig) -> float | None:
    """Return the downward acceleration with which a drone is pressed on what it touches, None for one that flies."""
    if memory.progress.phase is Phase.TOUCHDOWN:
        return config.touchdown.press_acceleration_m_s2
    held = memory.progress.held
    touches = Reason.CONTACT in held or Reason.DISPUTED_CONTACT in held
    return trial_press(situation, config) if touches else None


_WAITING_FOR_PAD = frozenset({Phase.WAITING, Phase.CHASE, Phase.ALIGN})
_NOT_BEGUN = frozenset({Phase.IDLE, Phase.WAITING, Phase.RETURN})
_STOPPED_WITHIN_S = 5.0  # motors: PX4's land detector takes up to 3 s, and each order to disarm is given again
_TIMED_PHASES = frozenset({Phase.ALIGN, Phase.DESCEND})
_CONTACT_OFFSETS_S: Array = np.arange(0.0, 30.0, 0.1)  # from 8 m, the greatest height of a chase, it takes 8 s


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
        time_to_contact_s=(
            _time_to_contact_s(relative, situation.limits or config.limits.flight_limits(), config.descent)
            if timed and relative is not None
            else None
        ),
        armed=situation.autopilot.armed,
        fix_age_s=situation.vehicle.fix_age_s,
        flown_by=_flown_by(phase, situation.autopilot),
        battery_share=situation.autopilot.battery_share,
        contact_forecast=memory.forecast.contact,
        unverified=unverified(situation, config),
        station_offset_m=_station_offset_m(memory),
    )


def _station_offset_m(memory: StepMemory) -> Vector3 | None:
    """Return where the station is that is kept now, None where none is."""
    way = memory.sortie.way
    if way is None or memory.progress.phase is not Phase.FOLLOW:
        return None
    ahead_m, left_m, up_m = way.end_m.tolist()
    return ahead_m, left_m, up_m


def _flown_by(phase: Phase, autopilot: AutopilotView) -> str:
    """Return who flies the drone, for people; empty while the autopilot is silent.

    A pilot who gives the companion's mode back after taking over still flies: no setpoints come until a start.
    """
    if not autopilot.link_up:
        return ""
    if autopilot.in_control and phase is not Phase.PILOT:
        return "companion"
    return "failsafe" if autopilot.failsafe else "other"


def _cause(memory: StepMemory, situation: Situation, config: CompanionConfig) -> Cause:
    """Return what the landing waits for, or why its phase began."""
    progress, not_placed = memory.progress, why_unplaced(situation)
    if progress.phase in _NOT_BEGUN and progress.obstacle is not None:
        return progress.obstacle  # a fault of the data also has the pad unplaced
    if progress.phase in _WAITING_FOR_PAD and not_placed is not None:
        return not_placed
    in_phase_s = (situation.monotonic_ns - progress.since_ns) * 1e-9
    if progress.phase is Phase.TOUCHDOWN and in_phase_s > _STOPPED_WITHIN_S:
        return Cause(Reason.MOTORS_RUN, (in_phase_s,))
    way = memory.sortie.way
    is_outrun = way is not None and way.frame is not way.station.frame
    outrun = Cause(Reason.STATION_OUTRUNS) if is_outrun and progress.phase is Phase.FOLLOW else None
    return memory.sortie.warning or outrun or _awaited(memory, situation, config) or progress.cause


def _awaited(memory: StepMemory, situation: Situation, config: CompanionConfig) -> Cause | None:
    """Return what the drone waits for, before the chase or above the pad; None while it does not."""
    if memory.progress.phase is Phase.WAITING:
        return why_not_chased(memory.progress.held, situation, config)
    return why_held_up(memory, situation, config)


def _time_to_contact_s(relative: Approach, limits: FlightLimits, descent: DescentConfig) -> float:
    """Return how long a descent that nothing holds up takes from the present height and rate, at most the horizon."""
    if relative.height_m <= 0.0:
        return 0.0
    state = (relative.height_m, relative.climb_m_s, 0.0)
    height_m = way_down(state, _CONTACT_OFFSETS_S, limits, descent)[0]
    below = int(np.argmax(height_m <= 0.0))
    if height_m[below] > 0.0:
        return float(_CONTACT_OFFSETS_S[-1])
    around = [below, below - 1]
    return float(np.interp(0.0, height_m[around], _CONTACT_OFFSETS_S[around]))


def news(before: Progress, now: Progress) -> str | None:
    """Return what the pilot is told of this step, None when there is nothing new."""
    is_explained = now.phase is Phase.PILOT and now.cause.reason is not before.cause.reason
    if now.phase is not before.phase or is_explained:
        return f"{now.phase.value}: {sentence(now.cause)}"
    told = now.obstacle
    if told is None:
        return None
    said = {cause.reason for cause in (before.obstacle, now.cause) if cause is not None}
    return None if told.reason in said else f"{now.phase.value}: {sentence(told)}"


def news_of_sortie(before: Cause | None, now: Cause | None, phase: Phase) -> str | None:
    """Return what the pilot is told of the way home, None when that is nothing new."""
    return f"{phase.value}: {sentence(now)}" if now is not None and before is None else None


_PLAN_POINTS = 2  # every so many points of the plan are published


def status_publication(keys: Keys, status: LandingStatus) -> Publication:
    """Return the status as JSON."""
    return Publication(keys.landing_status, json_messages.encode(status), json_messages.JSON_ENCODING)


def plan_publication(keys: Keys, way: Trajectory, t_ns: int, yaw_rad: float) -> Publication:
    """Return the planned motion as a path.

    Args:
        keys: of the Zenoh contract.
        way: planned by a step, its offsets from `t_ns`.
        t_ns: of the step that planned it, UTC.
        yaw_rad: the heading that is flown, from East counter-clockwise.
    """
    offsets_s = way.offset_s[::_PLAN_POINTS].tolist()
    points = zip(offsets_s, way.position_enu_m[::_PLAN_POINTS].tolist(), strict=True)
    poses = tuple(
        PlannedPose(t_ns=t_ns + int(offset_s * 1e9), position_enu_m=(x, y, z), yaw_rad=yaw_rad)
        for offset_s, (x, y, z) in points
    )
    return Publication(keys.landing_plan, cdr.encode(Plan(t_ns=t_ns, poses=poses)), cdr.encoding_of(Plan))
