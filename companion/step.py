"""One step of the companion: estimate the vehicle, decide, plan, and say what the autopilot should do.

Pure: the same memory, inputs and system give the same result, in flight, in simulation and in replay.
"""

from dataclasses import replace

import numpy as np

from companion.autopilots.driver import AutopilotCommand, Desire
from companion.commands import answer
from companion.config import CompanionConfig
from companion.data import FlightLimits, Forecast, OwnState, Setpoint
from companion.decisions import CONTACT, Progress, decide, is_on_pad, update_held
from companion.pad import PadPath, pad_path
from companion.phases import FLYING_PHASES, LANDING_PHASES, Event, Phase, next_phase
from companion.planning.guidance import PlanRequest, PlanResult, ReferenceState
from companion.reference import Tracking, carried, compare, pressing, remember, setpoint_at
from companion.shifts import in_present_frame
from companion.situation import Situation, approach, drone_now
from companion.status import landing_status
from companion.step_data import StepInputs, StepMemory, StepOutputs, System
from companion.targets import HORIZON_OFFSETS_S, Aim, hover_aim, is_at_rest, pad_aim, stopping_point
from link.frames import wrap_angle, yaw_of
from link.messages import Command, CommandReply

_STEP_MAX_S = 0.1  # a longer pause does not let the virtual model jump
_ABORT_DECELERATION_M_S2 = 2.0


def companion_step(memory: StepMemory, inputs: StepInputs, system: System) -> tuple[StepMemory, StepOutputs]:
    """Return the memory after this step and what is to be sent.

    Args:
        memory: of the step before; `StepMemory()` at the start.
        inputs: what has been received since then.
        system: configuration, estimator and guidance law.
    """
    memory = _estimate(memory, inputs, system)
    memory, forecast = _forecast(memory, inputs, system)
    situation = _situation(memory, forecast, inputs, system)
    before = memory.phase
    memory, reply = _transitions(memory, situation, inputs, system.config)
    memory, plan = _fly(memory, situation, inputs, system)
    memory, commands = _drive(memory, situation, inputs, system.config)
    situation = replace(situation, reference=memory.reference)
    outputs = StepOutputs(
        setpoint=_setpoint(memory, inputs.t_ns, system.config),
        commands=commands,
        text=f"{memory.phase.value}: {memory.reason}" if memory.phase is not before else None,
        reply=reply,
        status=landing_status(memory, situation, system.config),
        plan=plan,
    )
    return memory, outputs


def _setpoint(memory: StepMemory, t_ns: int, config: CompanionConfig) -> Setpoint | None:
    """Return what the autopilot is to follow now, None while nothing is flown."""
    reference = memory.reference
    if reference is None:
        return None
    if memory.phase is Phase.TOUCHDOWN:
        reference = pressing(reference, config.touchdown.press_acceleration_m_s2)
    elif CONTACT in memory.held:
        reference = pressing(reference, config.touchdown.try_acceleration_m_s2)
    sent_ns = t_ns + round(config.setpoint_lead_s * 1e9)
    return setpoint_at(
        carried(reference, (sent_ns - memory.reference_ns) * 1e-9),
        memory.tracking.correction_enu_m,
        sent_ns,
        memory.yaw_setpoint_rad,
        position_only=config.position_only,
    )


def _estimate(memory: StepMemory, inputs: StepInputs, system: System) -> StepMemory:
    """Fuse what the vehicle sent; when the local frame has moved, everything in it starts anew."""
    memory = in_present_frame(memory, inputs.autopilot)
    if inputs.measurements:
        memory = replace(memory, estimator=system.estimator.fuse(memory.estimator, inputs.measurements))
    if inputs.own is not None and memory.reference is not None:
        learn = system.config.corrects_lag and memory.phase in LANDING_PHASES
        memory = replace(memory, tracking=compare(memory.tracking, inputs.own, learn=learn))
    return memory


def _forecast(memory: StepMemory, inputs: StepInputs, system: System) -> tuple[StepMemory, Forecast | None]:
    """Return the vehicle over the horizon; an estimate that is not finite is given up and starts anew."""
    forecast = system.estimator.forecast(memory.estimator, inputs.t_ns, HORIZON_OFFSETS_S)
    if forecast is None or _is_finite(forecast):
        return memory, forecast
    return replace(memory, estimator=None), None


def _is_finite(forecast: Forecast) -> bool:
    arrays = [forecast.position_enu_m, forecast.velocity_enu_m_s, forecast.acceleration_enu_m_s2]
    arrays += [forecast.position_std_m, *([] if forecast.yaw_rad is None else [forecast.yaw_rad])]
    return all(bool(np.isfinite(values).all()) for values in arrays)


def _situation(memory: StepMemory, forecast: Forecast | None, inputs: StepInputs, system: System) -> Situation:
    newest_ns = system.estimator.newest_fix_ns(memory.estimator)
    return Situation(
        t_ns=inputs.t_ns,
        autopilot=inputs.autopilot,
        drone=drone_now(inputs.own, inputs.t_ns, _own_yaw_rad(inputs.own), system.config.abort.own_age_max_s),
        pad=None if forecast is None else pad_path(forecast, inputs.pad),
        feet_offset_m=system.config.touchdown.gear_height_m,
        fix_age_s=None if newest_ns is None else (inputs.t_ns - newest_ns) * 1e-9,
        vehicle_alive=inputs.vehicle_alive,
        reference=memory.reference,
        tracking_error_m=memory.tracking.error_m,
        waiting_point_enu_m=memory.waiting_point_enu_m,
    )


def _own_yaw_rad(own: OwnState | None) -> float:
    return 0.0 if own is None else yaw_of(own.orientation_wxyz)


def _transitions(
    memory: StepMemory, situation: Situation, inputs: StepInputs, config: CompanionConfig
) -> tuple[StepMemory, CommandReply | None]:
    """Take the operator's command, then the event of this step."""
    reply = None
    if inputs.command is not None:
        event, reply = answer(inputs.command, memory.phase, situation)
        if event is not None:
            memory = _enter(memory, event, f"commanded: {inputs.command.value}", situation, config)
        if reply.accepted:
            memory = replace(memory, may_retry=inputs.command is Command.START)
    progress = Progress(
        phase=memory.phase,
        since_ns=memory.phase_since_ns,
        retries=memory.retries,
        may_retry=memory.may_retry,
        was_in_control=memory.was_in_control,
        was_armed=memory.was_armed,
    )
    held = update_held(memory.held, progress, situation, approach(situation), config)
    memory = replace(memory, held=held)
    decision = decide(progress, situation, held, config)
    if decision is not None:
        memory = _enter(memory, *decision, situation, config)
    flies, view = memory.phase in FLYING_PHASES, inputs.autopilot
    in_control = flies and (memory.was_in_control or view.in_control)
    armed = in_control and (memory.was_armed or (view.in_control and view.armed))
    return replace(memory, was_in_control=in_control, was_armed=armed), reply


def _enter(memory: StepMemory, event: Event, reason: str, situation: Situation, config: CompanionConfig) -> StepMemory:
    """Return the memory in the phase that `event` leads to, with what that phase needs at its beginning."""
    phase = next_phase(memory.phase, event)
    if phase is memory.phase:
        return memory
    retries = memory.retries + 1 if event is Event.CLEAR else memory.retries
    retries = 0 if event is Event.START else retries
    # What makes an approach unsafe goes on from one of its phases to the next, and so does the time it has held.
    held = memory.held if {memory.phase, phase} <= LANDING_PHASES else {}
    memory = replace(memory, phase=phase, phase_since_ns=situation.t_ns, reason=reason, held=held, retries=retries)
    if phase is Phase.TAKEOFF:
        return _begin_flight(memory, situation, config)
    if phase not in FLYING_PHASES:
        return replace(memory, reference=None, tracking=Tracking())
    if phase in (Phase.HOLD, Phase.ABORT) and memory.reference is not None:
        return replace(memory, anchor_enu_m=stopping_point(memory.reference, _ABORT_DECELERATION_M_S2))
    return memory


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


def _aim(memory: StepMemory, situation: Situation, config: CompanionConfig) -> Aim:
    """Return where the present phase wants the drone."""
    reference, pad = memory.reference, situation.pad
    if reference is None or memory.anchor_enu_m is None or memory.waiting_point_enu_m is None:
        raise ValueError(f"phase {memory.phase.value} flies without a reference")
    match memory.phase:
        case Phase.CHASE | Phase.ALIGN | Phase.DESCEND | Phase.TOUCHDOWN if pad is not None:
            return pad_aim(memory.phase, pad, reference, situation.feet_offset_m, config)
        case Phase.ABORT if pad is not None and _is_fresh(situation, config):
            return pad_aim(memory.phase, pad, reference, situation.feet_offset_m, config)
        case Phase.ABORT:
            return hover_aim(memory.anchor_enu_m + np.array([0.0, 0.0, config.abort.height_m]))
        case Phase.TAKEOFF if not (situation.autopilot.armed and situation.autopilot.in_control):
            return hover_aim(memory.anchor_enu_m)
        case Phase.HOLD:
            return hover_aim(memory.anchor_enu_m)
        case _:
            return hover_aim(memory.waiting_point_enu_m)


def _is_fresh(situation: Situation, config: CompanionConfig) -> bool:
    return situation.fix_age_s is not None and situation.fix_age_s <= config.abort.fix_age_max_s


def _fly(
    memory: StepMemory, situation: Situation, inputs: StepInputs, system: System
) -> tuple[StepMemory, PlanResult | None]:
    """Plan from the virtual model now to where it is at the next step, one period from now."""
    if memory.reference is None or memory.phase not in FLYING_PHASES:
        return memory, None
    # The last plan led to `reference_ns`; this step may come a little earlier or later than that.
    off_s = (inputs.t_ns - memory.reference_ns) * 1e-9
    reference = carried(memory.reference, max(min(off_s, _STEP_MAX_S), -_STEP_MAX_S))
    memory = replace(memory, reference=reference)
    period_s = 1.0 / system.config.step_rate_hz
    aim = _aim(memory, situation, system.config)
    if is_at_rest(reference, aim):
        return _resting(memory, inputs.t_ns + round(period_s * 1e9)), None
    request = PlanRequest(
        state=reference,
        target=aim.target,
        limits=_limits(memory, situation, inputs.limits, system.config),
        floor_enu_m=aim.floor_enu_m,
        dt_s=period_s,
    )
    guidance, plan = system.guidance.plan(memory.guidance, request)
    reference_ns = inputs.t_ns + round(period_s * 1e9)
    memory = replace(
        memory,
        guidance=guidance,
        reference=plan.next_state,
        reference_ns=reference_ns,
        tracking=remember(memory.tracking, reference_ns, plan.next_state),
        yaw_setpoint_rad=_slewed_yaw_rad(memory, situation.pad, period_s, system.config),
    )
    return _anchored(memory, situation, system.config), plan


def _resting(memory: StepMemory, reference_ns: int) -> StepMemory:
    """Let the virtual model stay where it is, for there is nothing to plan."""
    if memory.reference is None:
        return memory
    tracking = remember(memory.tracking, reference_ns, memory.reference)
    return replace(memory, reference_ns=reference_ns, tracking=tracking)


def _anchored(memory: StepMemory, situation: Situation, config: CompanionConfig) -> StepMemory:
    """Take the place to stop along while an abort follows the vehicle, for when the vehicle falls silent."""
    if memory.phase is not Phase.ABORT or memory.reference is None or memory.anchor_enu_m is None:
        return memory
    if situation.pad is None or not _is_fresh(situation, config):
        return memory
    x, y, _ = stopping_point(memory.reference, _ABORT_DECELERATION_M_S2)
    return replace(memory, anchor_enu_m=np.array([x, y, memory.anchor_enu_m[2]]))


def _limits(memory: StepMemory, situation: Situation, limits: FlightLimits, config: CompanionConfig) -> FlightLimits:
    """Return the limits of this step: just above the pad the drone turns less than the deck, to touch down level."""
    relative = approach(situation)
    if memory.phase is not Phase.DESCEND or relative is None or relative.height_m > config.touchdown.level_height_m:
        return limits
    level_m_s2 = min(config.touchdown.level_acceleration_m_s2, limits.acceleration_max_m_s2)
    return replace(limits, acceleration_max_m_s2=level_m_s2)


def _slewed_yaw_rad(memory: StepMemory, pad: PadPath | None, dt_s: float, config: CompanionConfig) -> float:
    """Turn towards the vehicle's heading while it is followed, at a bounded rate."""
    follows = memory.phase in LANDING_PHASES or memory.phase is Phase.TOUCHDOWN
    if not (follows and config.follows_heading) or pad is None or pad.yaw_rad is None:
        return memory.yaw_setpoint_rad
    turn_max_rad = config.yaw_rate_max_rad_s * dt_s
    turn_rad = wrap_angle(pad.yaw_rad - memory.yaw_setpoint_rad)
    return wrap_angle(memory.yaw_setpoint_rad + min(max(turn_rad, -turn_max_rad), turn_max_rad))


def _drive(
    memory: StepMemory, situation: Situation, inputs: StepInputs, config: CompanionConfig
) -> tuple[StepMemory, tuple[AutopilotCommand, ...]]:
    """Return the memory and the commands that bring the autopilot to what the phase needs."""
    if inputs.driver is None:
        return memory, ()
    driver_memory = memory.driver
    for command, result in inputs.acknowledgements:
        driver_memory = inputs.driver.acknowledged(driver_memory, command, result)
    desire = _desire(memory, situation, config)
    driver_memory, commands = inputs.driver.act(driver_memory, inputs.autopilot, desire, inputs.t_ns)
    return replace(memory, driver=driver_memory), commands


def _desire(memory: StepMemory, situation: Situation, config: CompanionConfig) -> Desire:
    match memory.phase:
        case Phase.TAKEOFF:
            return Desire(control=True, armed=True)
        case Phase.TOUCHDOWN:
            return Desire(armed=False, force_disarm=is_on_pad(situation, config))
        case _:
            return Desire()  # control that was had and is lost is not taken back
