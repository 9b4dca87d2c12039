"""Applies the operator's command and the step's event, and initialises the phase that follows; pure."""

import numpy as np

from companion.autopilots.messages import is_arming
from companion.config.companion import CompanionConfig
from companion.core.reasons import Cause, Reason, same_or_new
from companion.landing.commands import answer
from companion.landing.decisions.aborts import ABORTS
from companion.landing.decisions.conditions import is_above_commitment, is_low_above_pad
from companion.landing.decisions.entries import update_held
from companion.landing.decisions.events import decide
from companion.landing.decisions.feasibility import OBSTACLES, obstacle
from companion.landing.decisions.waiting import update_wait
from companion.landing.flying import model_at
from companion.landing.sortie.events import SORTIE_CONDITIONS, decide_sortie, stay_out, update_sortie
from companion.landing.sortie.phases import begin_phase_of_sortie, clear_of_vehicle, take_order
from companion.landing.sortie.riding import is_carried_by_deck
from companion.landing.sortie.way_home import way_home_due
from companion.landing.state.memory import NOTHING_HELD, ControlMemory, ModelMemory, Progress, StepMemory
from companion.landing.state.step_data import StepInputs
from companion.landing.steering.following_height import climb_m, too_low_m
from companion.landing.steering.targets import stopping_point
from companion.landing.steering.virtual_model import Tracking
from companion.planning.guidance import ReferenceState
from companion.situation.phases import FLYING_PHASES, LANDING_PHASES, Event, Phase, next_phase
from companion.situation.situation import Situation
from link.messages import Command, CommandReply, Order
from link.records import replace

_BESIDE_LANDINGS = (*OBSTACLES, *SORTIE_CONDITIONS)
_OUTAGES = frozenset(condition.reason for condition in ABORTS if condition.is_outage)
_COMMANDED = {
    Command.START: Cause(Reason.OPERATOR_STARTS),
    Command.START_ANYWAY: Cause(Reason.OPERATOR_STARTS),
    Command.ABORT: Cause(Reason.OPERATOR_ABORTS),
    Command.HOLD: Cause(Reason.OPERATOR_HOLDS),
    Command.LAUNCH: Cause(Reason.OPERATOR_LAUNCHES),
    Command.FOLLOW: Cause(Reason.OPERATOR_FOLLOWS),
    Command.RETURN: Cause(Reason.OPERATOR_RETURNS),
}
_BREAKS_OFF = (Command.ABORT, Command.HOLD)
_BEGINNINGS = frozenset({Event.START, Event.START_AGAIN, Event.LAUNCH, Event.FOLLOW, Event.RETURN})
"""From here on approaches are counted."""


def take_events(
    memory: StepMemory, situation: Situation, inputs: StepInputs, config: CompanionConfig
) -> tuple[StepMemory, CommandReply | None]:
    """Take the operator's command, then the event of this step."""
    reply = None
    if inputs.command is not None:
        progress = memory.progress
        known = obstacle(progress.held, situation, config)
        order = Order(command=inputs.command, station=inputs.station)
        due = way_home_due(memory.sortie, situation, config)
        driver = memory.control.driver
        event, reply = answer(
            order,
            progress.phase,
            situation,
            config,
            known,
            called_home=due,
            is_arming=is_arming(driver, situation.monotonic_ns),
            is_disarming=driver.disarm_asked and situation.autopilot.armed,
        )
        if event is not None:
            memory = _enter(memory, event, _COMMANDED[inputs.command], situation, config)
        if reply.accepted:
            memory = replace(memory, sortie=take_order(memory.sortie, order))
            may_retry = inputs.command not in _BREAKS_OFF
            stays = memory.progress.phase is Phase.HOLD and not may_retry
            cause = _COMMANDED[inputs.command] if stays else memory.progress.cause
            memory = replace(memory, progress=replace(memory.progress, may_retry=may_retry, cause=cause))
    if inputs.leaving:
        memory = _leave(memory, situation, config)
    progress = update_wait(memory, situation, config)
    held = update_held(progress.held, progress.phase, situation, config, others=_BESIDE_LANDINGS)
    known = same_or_new(progress.obstacle, obstacle(held, situation, config))
    memory = replace(memory, progress=replace(progress, held=held, obstacle=known))
    memory = replace(memory, sortie=update_sortie(memory.sortie, progress.phase, situation, config))
    decision = decide(memory.progress, memory.control, situation, config)
    if decision is None:
        decision = decide_sortie(memory.sortie, memory.progress, memory.control, situation, config)
    if decision is not None:
        decision = stay_out(memory.sortie, memory.progress, decision)
        memory = _enter(memory, *decision, situation, config)
    return _update_control(_learn_of_restart(memory, inputs), inputs), reply


def _leave(memory: StepMemory, situation: Situation, config: CompanionConfig) -> StepMemory:
    """Return the memory of a companion that is to end; an autopilot that hovers by itself holds its place in the world.

    On the deck that would be against the deck, which drives on. A drone that is low above a pad and not committed to it
    climbs first.
    """
    phase = memory.progress.phase
    is_low = is_low_above_pad(situation, config) and is_above_commitment(situation, config)
    if phase is Phase.DESCEND and is_low:
        return _enter(memory, Event.ABORT, _COMMANDED[Command.ABORT], situation, config)
    if is_carried_by_deck(phase, situation, config):
        return _enter(memory, Event.CALLED_OFF, _COMMANDED[Command.ABORT], situation, config)
    return memory


def _learn_of_restart(memory: StepMemory, inputs: StepInputs) -> StepMemory:
    """Say that motors which had stopped did so by a restart, once the autopilot's clock has told of it."""
    progress = memory.progress
    if progress.phase is not Phase.PILOT or progress.cause.reason is not Reason.DISARMED:
        return memory
    if not inputs.autopilot.restarted:
        return memory
    return replace(memory, progress=replace(progress, cause=Cause(Reason.AUTOPILOT_RESTARTED)))


def _update_control(memory: StepMemory, inputs: StepInputs) -> StepMemory:
    """Take note of whether the autopilot is the companion's, armed so, and in the air."""
    control, view = memory.control, inputs.autopilot
    flies = memory.progress.phase in FLYING_PHASES
    in_control = flies and (control.was_in_control or view.in_control)
    was_stopped = memory.progress.phase is Phase.ON_DECK and control.driver.disarm_asked and not view.armed
    armed = in_control and not was_stopped and (control.was_armed or (view.in_control and view.armed))
    flown = flies and (control.has_flown or (view.armed and view.landed is False))
    if (in_control, armed, flown) == (control.was_in_control, control.was_armed, control.has_flown):
        return memory
    return replace(memory, control=replace(control, was_in_control=in_control, was_armed=armed, has_flown=flown))


def _enter(memory: StepMemory, event: Event, cause: Cause, situation: Situation, config: CompanionConfig) -> StepMemory:
    """Return the memory in the phase that `event` leads to, with what that phase needs at its beginning."""
    phase = next_phase(memory.progress.phase, event)
    if phase is memory.progress.phase:
        return memory
    before = memory.progress.phase
    memory = replace(memory, progress=_progress_after(memory.progress, event, cause, situation.monotonic_ns, config))
    memory = begin_phase_of_sortie(memory, before, situation, config)
    model, places = memory.model, memory.places
    anchor = places.anchor_enu_m
    if phase is Phase.WAITING and event is Event.START and anchor is not None:
        # It waits where it hovers, unless that is too low.
        waiting_point = anchor + np.array([0.0, 0.0, too_low_m(float(anchor[2]), situation, config)])
        return replace(memory, places=replace(places, waiting_point_enu_m=waiting_point))
    if phase in (Phase.TAKEOFF, Phase.ON_DECK):
        return _begin_flight(memory, situation, config)
    if event is Event.CARRIED_OFF and situation.drone is not None:  # nothing pulls it back to where it began
        return replace(memory, model=model_at(situation.drone, model, situation.monotonic_ns))
    if phase not in FLYING_PHASES:
        return replace(memory, model=replace(model, reference=None, tracking=Tracking()))
    if phase in (Phase.HOLD, Phase.ABORT) and model.reference is not None:
        anchor = clear_of_vehicle(stopping_point(model.reference), memory, situation, config)
        memory = replace(memory, places=replace(places, anchor_enu_m=anchor))
    return replace(memory, model=_escape(model, situation, config)) if phase is Phase.ABORT else memory


def _progress_after(
    before: Progress, event: Event, cause: Cause, monotonic_ns: int, config: CompanionConfig
) -> Progress:
    """Return the progress in the phase that `event` leads to, with what is counted over an approach and from there on.

    A chase that an outage broke off, before the drone was near, goes on after it: it costs no retry, nor does it get
    more time.
    """
    phase = next_phase(before.phase, event)
    resumed_ns = before.interrupted_ns if event is Event.CLEAR else None
    retries = before.retries + 1 if event is Event.CLEAR and resumed_ns is None else before.retries
    in_time = (monotonic_ns - before.since_ns) * 1e-9 < config.chase.time_limit_s
    is_outage = event is Event.UNSAFE and before.phase is Phase.CHASE and cause.reason in _OUTAGES and in_time
    begun_anew = before.begun_anew
    if event is Event.OUT_OF_ALIGNMENT:
        begun_anew = {**begun_anew, cause.reason: begun_anew.get(cause.reason, 0) + 1}
    is_too_long = event is Event.TIME_LIMIT and before.phase is Phase.RETURN  # nor does it set out again by itself
    # What makes an approach unsafe goes on from one of its phases to the next, and so does the time it has held.
    goes_on = {before.phase, phase} <= LANDING_PHASES
    return Progress(
        phase=phase,
        since_ns=monotonic_ns if resumed_ns is None else resumed_ns,
        cause=cause,
        retries=0 if event in _BEGINNINGS and cause.reason is not Reason.HEARD_AGAIN else retries,
        interrupted_ns=before.since_ns if is_outage else None,
        begun_anew=begun_anew if goes_on else {},
        may_retry=(before.may_retry or event is Event.HOME_NOW) and not is_too_long,
        stopped_by_pad=event is Event.CONTACT and Reason.HARD_CONTACT in before.held,
        held=before.held if goes_on else NOTHING_HELD,
        obstacle=before.obstacle,
    )


def _escape(model: ModelMemory, situation: Situation, config: CompanionConfig) -> ModelMemory:
    """Let the virtual model sink no further towards a roof that is near: no plan of limited jerk turns it in time."""
    reference, pad, limits = model.reference, situation.pad, situation.limits
    if reference is None or pad is None or limits is None or not is_low_above_pad(situation, config):
        return model
    velocity, acceleration = reference.velocity_enu_m_s.copy(), reference.acceleration_enu_m_s2.copy()
    velocity[2] = max(velocity[2], pad.velocity_enu_m_s[0, 2])
    acceleration[2] = limits.vertical_acceleration_max_m_s2
    escaping = replace(reference, velocity_enu_m_s=velocity, acceleration_enu_m_s2=acceleration)
    return replace(model, reference=escaping, plan=None, guidance=None)


def _begin_flight(memory: StepMemory, situation: Situation, config: CompanionConfig) -> StepMemory:
    """Start the virtual model where the drone is, and place the waiting point above it."""
    drone = situation.drone
    if drone is None:
        nowhere = replace(memory.progress, phase=Phase.IDLE, cause=Cause(Reason.DRONE_UNKNOWN))
        return replace(memory, progress=nowhere)
    position, zero = drone.position_enu_m, np.zeros(3)
    model = replace(
        memory.model,
        reference=ReferenceState(position_enu_m=position, velocity_enu_m_s=zero, acceleration_enu_m_s2=zero),
        reference_ns=situation.monotonic_ns,
        plan=None,
        tracking=Tracking(),
        guidance=None,
        yaw_setpoint_rad=drone.yaw_rad,
    )
    waiting_point = position + np.array([0.0, 0.0, climb_m(float(position[2]), situation, config)])
    return replace(
        memory,
        control=ControlMemory(driver=memory.control.driver, mode_before=situation.autopilot.mode),
        model=model,
        places=replace(memory.places, anchor_enu_m=position, waiting_point_enu_m=waiting_point),
    )
