"""The operator's command and the event of a step, and what the phase that they lead to begins with; pure."""

import numpy as np

from companion.config.companion import CompanionConfig
from companion.landing.commands import answer
from companion.landing.conditions import ABORT_TESTS, update_held
from companion.landing.contact_tests import HARD_CONTACT
from companion.landing.decisions import Progress, decide
from companion.landing.feasibility import OBSTACLE_TESTS, obstacle
from companion.landing.silence import SILENCES
from companion.landing.step_data import StepInputs, StepMemory
from companion.landing.targets import stopping_point
from companion.landing.virtual_model import Tracking
from companion.landing.waiting import waited_s, with_wait_counted
from companion.planning.guidance import ReferenceState
from companion.situation.phases import FLYING_PHASES, LANDING_PHASES, Event, Phase, next_phase
from companion.situation.situation import Situation, approach
from link.messages import Command, CommandReply
from link.records import replace

BRAKING_M_S2 = 2.0
"""Deceleration that the place to stop at is taken from."""

_OUTAGES = frozenset(test.reason for test in ABORT_TESTS if test.is_true in SILENCES)


def transitions(
    memory: StepMemory, situation: Situation, inputs: StepInputs, config: CompanionConfig
) -> tuple[StepMemory, CommandReply | None]:
    """Take the operator's command, then the event of this step."""
    reply = None
    if inputs.command is not None:
        known = obstacle(memory.held, situation, config)
        event, reply = answer(inputs.command, memory.phase, situation, config, None if known is None else known[1])
        if event is not None:
            memory = _enter(memory, event, f"commanded: {inputs.command.value}", situation, config)
        if reply.accepted:
            memory = replace(memory, may_retry=inputs.command is Command.START)
    memory = with_wait_counted(memory, situation, config)
    progress = Progress(
        phase=memory.phase,
        since_ns=memory.phase_since_ns,
        retries=memory.retries,
        may_retry=memory.may_retry,
        was_in_control=memory.was_in_control,
        was_armed=memory.was_armed,
        is_interrupted=memory.interrupted_ns is not None,
        begun_anew=memory.begun_anew,
        waited_s=waited_s(memory, situation.t_ns),
    )
    held = update_held(memory.held, memory.phase, situation, approach(situation), config, others=OBSTACLE_TESTS)
    memory = replace(memory, held=held, obstacle=_same_or_new(memory.obstacle, obstacle(held, situation, config)))
    decision = decide(progress, situation, held, config)
    if decision is not None:
        memory = _enter(memory, *decision, situation, config)
    flies, view = memory.phase in FLYING_PHASES, inputs.autopilot
    in_control = flies and (memory.was_in_control or view.in_control)
    armed = in_control and (memory.was_armed or (view.in_control and view.armed))
    if (in_control, armed) != (memory.was_in_control, memory.was_armed):
        memory = replace(memory, was_in_control=in_control, was_armed=armed)
    return memory, reply


def _same_or_new(told: tuple[str, str] | None, now: tuple[str, str] | None) -> tuple[str, str] | None:
    """Keep the sentence that was told as long as it is the same thing: its numbers change in every step."""
    return told if told is not None and now is not None and told[0] == now[0] else now


def _enter(memory: StepMemory, event: Event, reason: str, situation: Situation, config: CompanionConfig) -> StepMemory:
    """Return the memory in the phase that `event` leads to, with what that phase needs at its beginning."""
    phase = next_phase(memory.phase, event)
    if phase is memory.phase:
        return memory
    memory = _counted(memory, event, reason, situation, config)
    # What makes an approach unsafe goes on from one of its phases to the next, and so does the time it has held.
    held = memory.held if {memory.phase, phase} <= LANDING_PHASES else {}
    stopped = event is Event.CONTACT and HARD_CONTACT in memory.held
    memory = replace(memory, phase=phase, reason=reason, held=held, stopped_by_pad=stopped)
    if phase is Phase.WAITING and event is Event.START:
        return replace(memory, waiting_point_enu_m=memory.anchor_enu_m)  # it waits where it hovers
    if phase is Phase.TAKEOFF:
        return _begin_flight(memory, situation, config)
    if phase not in FLYING_PHASES:
        return replace(memory, reference=None, tracking=Tracking())
    if phase in (Phase.HOLD, Phase.ABORT) and memory.reference is not None:
        memory = replace(memory, anchor_enu_m=stopping_point(memory.reference, BRAKING_M_S2))
    return _escaping(memory, situation, config) if phase is Phase.ABORT else memory


def _counted(
    memory: StepMemory, event: Event, reason: str, situation: Situation, config: CompanionConfig
) -> StepMemory:
    """Return the memory, still in the old phase, with what is counted over an approach and from the new phase on.

    A chase that an outage broke off, before the drone was near, goes on after it: it costs no retry, nor does it get
    more time.
    """
    resumed_ns = memory.interrupted_ns if event is Event.CLEAR else None
    retries = memory.retries + 1 if event is Event.CLEAR and resumed_ns is None else memory.retries
    since_ns = memory.phase_since_ns
    in_time = (situation.t_ns - since_ns) * 1e-9 < config.chase.time_limit_s
    is_outage = event is Event.UNSAFE and memory.phase is Phase.CHASE and reason in _OUTAGES and in_time
    begun_anew = memory.begun_anew
    if event is Event.OUT_OF_ALIGNMENT:
        begun_anew = {**begun_anew, reason: begun_anew.get(reason, 0) + 1}
    goes_on = {memory.phase, next_phase(memory.phase, event)} <= LANDING_PHASES
    return replace(
        memory,
        phase_since_ns=situation.t_ns if resumed_ns is None else resumed_ns,
        retries=0 if event in (Event.START, Event.START_AGAIN) else retries,
        interrupted_ns=since_ns if is_outage else None,
        begun_anew=begun_anew if goes_on else {},
        waits_since_ns=None,
        waited_s=0.0,
    )


def _escaping(memory: StepMemory, situation: Situation, config: CompanionConfig) -> StepMemory:
    """Let the virtual model sink no further towards a roof that is near: no plan of limited jerk turns it in time."""
    reference, pad, limits, relative = memory.reference, situation.pad, situation.limits, approach(situation)
    if reference is None or pad is None or limits is None or relative is None:
        return memory
    if relative.height_m > config.descent.waiting_height_m:
        return memory
    velocity, acceleration = reference.velocity_enu_m_s.copy(), reference.acceleration_enu_m_s2.copy()
    velocity[2] = max(velocity[2], pad.velocity_enu_m_s[0, 2])
    acceleration[2] = limits.vertical_acceleration_max_m_s2
    escaping = replace(reference, velocity_enu_m_s=velocity, acceleration_enu_m_s2=acceleration)
    return replace(memory, reference=escaping, guidance=None)


def _begin_flight(memory: StepMemory, situation: Situation, config: CompanionConfig) -> StepMemory:
    """Start the virtual model where the drone is, and place the waiting point above it."""
    if situation.drone is None:
        return replace(memory, phase=Phase.IDLE, reason="the drone's position is not known")
    position, zero = situation.drone.position_enu_m, np.zeros(3)
    airborne = situation.autopilot.armed and situation.autopilot.landed is False
    climb_m = 0.0 if airborne else config.takeoff.waiting_height_m
    return replace(
        memory,
        was_in_control=False,
        was_armed=False,
        reference=ReferenceState(position_enu_m=position, velocity_enu_m_s=zero, acceleration_enu_m_s2=zero),
        reference_ns=situation.t_ns,
        tracking=Tracking(),
        guidance=None,
        anchor_enu_m=position,
        waiting_point_enu_m=position + np.array([0.0, 0.0, climb_m]),
        yaw_setpoint_rad=situation.drone.yaw_rad,
    )
