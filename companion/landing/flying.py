"""From the phase to the next state of the virtual model, and from that to the setpoint; pure."""

import math

import numpy as np

from companion.autopilots.velocity_bias import as_seen_with
from companion.config.companion import CompanionConfig
from companion.core.data import Setpoint
from companion.core.reasons import Reason
from companion.landing.levelling import limits_now
from companion.landing.memory import ModelMemory, StepMemory
from companion.landing.step_data import StepInputs, System
from companion.landing.sway import update_sway
from companion.landing.targets import Aim, hover_aim, is_at_rest, pad_aim, stopping_point
from companion.landing.transitions import BRAKING_M_S2
from companion.landing.virtual_model import (
    Tracking,
    add_to_past,
    extrapolate,
    free_place,
    limit_sink,
    press_down,
    setpoint_at,
    state_in_plan,
)
from companion.landing.waiting import waits_at_m
from companion.planning.guidance import PlanRequest, PlanResult, ReferenceState
from companion.situation.phases import FLYING_PHASES, LANDING_PHASES, Phase
from companion.situation.situation import Situation
from companion.vehicle.pad import PadPath
from companion.vehicle.pad_reach import over_pad_radius_m
from link.frames import wrap_angle
from link.records import replace

# A chase keeps its place: through an outage the drone then stops where it was last sent.
_FREE_PLACE_PHASES = (Phase.ALIGN, Phase.DESCEND, Phase.TOUCHDOWN)
_STEP_MAX_S = 0.1  # a longer pause does not let the virtual model jump


def setpoint(
    memory: StepMemory, inputs: StepInputs, config: CompanionConfig, plan: PlanResult | None = None
) -> Setpoint | None:
    """Return what the autopilot is to follow now, None while nothing is flown.

    Args:
        memory: after this step's plan.
        inputs: of this step.
        config: all numbers.
        plan: of this step, None when there was nothing to plan.
    """
    model = memory.model
    if model.reference is None or memory.control.driver.climbs_by_itself:
        return None
    ahead_s = inputs.link_delay_s + config.setpoint_lead_s
    if plan is None:
        reference = extrapolate(model.reference, (inputs.monotonic_ns - model.reference_ns) * 1e-9 + ahead_s)
    else:
        reference = state_in_plan(plan.trajectory, ahead_s)
    if inputs.driver is not None and inputs.driver.carries_setpoints_on:
        reference = limit_sink(reference, model.lowest_enu_m, inputs.timeout_s)
    press_m_s2 = _press_m_s2(memory, config)
    if press_m_s2 is not None:
        reference = press_down(reference, press_m_s2, ahead_s)
    wanted = setpoint_at(
        reference,
        model.tracking.correction_enu_m,
        inputs.t_ns + round(ahead_s * 1e9),
        model.yaw_setpoint_rad,
        position_only=config.position_only,
    )
    if has_free_place(memory, inputs, config):
        wanted = free_place(wanted, model.tracking.behind_enu_m, config.place_gain_hz)
    return wanted if inputs.own is None else as_seen_with(wanted, inputs.own.velocity_bias_enu_m_s)


def has_free_place(memory: StepMemory, inputs: StepInputs, config: CompanionConfig) -> bool:
    """Return whether the link's jitter would move the place that is asked for too far for a landing.

    A setpoint is held as it came, so one that comes late by so much asks for a place that the vehicle has left.
    """
    reference, driver = memory.model.reference, inputs.driver
    if memory.progress.phase not in _FREE_PLACE_PHASES or reference is None or config.position_only:
        return False
    if driver is None or not driver.holds_height_alone:
        return False
    speed_m_s = math.hypot(*reference.velocity_enu_m_s[:2].tolist())
    return speed_m_s * inputs.link_delay_std_s > config.place_jitter_max_m


def _press_m_s2(memory: StepMemory, config: CompanionConfig) -> float | None:
    """Return the downward acceleration with which a drone is pressed on what it touches, None for one that flies."""
    if memory.progress.phase is Phase.TOUCHDOWN:
        return config.touchdown.press_acceleration_m_s2
    held = memory.progress.held
    touches = Reason.CONTACT in held or Reason.DISPUTED_CONTACT in held
    return config.touchdown.try_acceleration_m_s2 if touches else None


def _aim(memory: StepMemory, situation: Situation, config: CompanionConfig) -> Aim:
    """Return where the present phase wants the drone."""
    phase, reference, pad = memory.progress.phase, memory.model.reference, situation.pad
    anchor, waiting_point = memory.places.anchor_enu_m, memory.places.waiting_point_enu_m
    if reference is None or anchor is None or waiting_point is None:
        raise ValueError(f"phase {phase.value} flies without a reference")
    match phase:
        case Phase.CHASE | Phase.ALIGN | Phase.DESCEND | Phase.TOUCHDOWN if pad is not None:
            lowest_m = waits_at_m(memory, situation, config)
            return pad_aim(phase, pad, reference, situation.feet_offset_m, config, lowest_m=lowest_m)
        case Phase.ABORT if pad is not None and _is_fresh(situation, config):
            return pad_aim(phase, pad, reference, situation.feet_offset_m, config)
        case Phase.ABORT:
            return hover_aim(anchor + np.array([0.0, 0.0, config.abort.height_m]))
        case Phase.TAKEOFF if not (situation.autopilot.armed and situation.autopilot.in_control):
            return hover_aim(anchor)
        case Phase.HOLD:
            return hover_aim(anchor)
        case _:
            return hover_aim(waiting_point)


def _is_fresh(situation: Situation, config: CompanionConfig) -> bool:
    age_s = situation.vehicle.fix_age_s
    return age_s is not None and age_s <= config.abort.fix_age_max_s


def fly(
    memory: StepMemory, situation: Situation, inputs: StepInputs, system: System
) -> tuple[StepMemory, PlanResult | None]:
    """Plan from the virtual model now to where it is at the next step, one period from now."""
    if memory.model.reference is None or memory.progress.phase not in FLYING_PHASES:
        return memory, None
    if inputs.own is not None:
        own_ns = inputs.monotonic_at(inputs.own.t_ns)
        sway = update_sway(memory.model.sway, inputs.own, own_ns, system.config.descent)
        memory = replace(memory, model=replace(memory.model, sway=sway))
    memory = _to_lost_drone(memory, situation, system.config)
    model = memory.model
    if model.reference is None:
        return memory, None
    # The last plan led to `reference_ns`; this step may come a little earlier or later than that.
    off_s = (inputs.monotonic_ns - model.reference_ns) * 1e-9
    reference = extrapolate(model.reference, max(min(off_s, _STEP_MAX_S), -_STEP_MAX_S))
    reference = _at_drone(memory, reference, situation, system.config)
    model = replace(model, reference=reference)
    memory = replace(memory, model=model)
    period_s = 1.0 / system.config.step_rate_hz
    reference_ns = inputs.monotonic_ns + round(period_s * 1e9)
    aim = _aim(memory, situation, system.config)
    if is_at_rest(reference, aim):  # there is nothing to plan
        tracking = add_to_past(model.tracking, reference_ns, reference)
        return replace(memory, model=replace(model, reference_ns=reference_ns, tracking=tracking)), None
    request = PlanRequest(
        state=reference,
        target=aim.target,
        limits=limits_now(memory, situation, inputs, system.config),
        floor_enu_m=aim.floor_enu_m,
        dt_s=period_s,
    )
    guidance, plan = system.guidance.plan(model.guidance, request)
    model = ModelMemory(
        reference=plan.next_state,
        reference_ns=reference_ns,
        guidance=guidance,
        tracking=add_to_past(model.tracking, reference_ns, plan.next_state),
        sway=model.sway,
        lowest_enu_m=float(aim.floor_enu_m[0]),
        yaw_setpoint_rad=_slewed_yaw_rad(memory, situation.pad, period_s, system.config),
    )
    return _update_anchor(replace(memory, model=model), situation, system.config), plan


def _at_drone(
    memory: StepMemory, reference: ReferenceState, situation: Situation, config: CompanionConfig
) -> ReferenceState:
    """Keep the virtual model with a drone that does not follow it, so that it takes over wherever that ends.

    One climbs by itself; another was held by what it touched while the pad drove on: it is pressed down where it is,
    which is what an autopilot's land detector waits for.
    """
    drone, sinking = situation.drone, _is_left_by_pad(memory, situation, config)
    if drone is None or not (memory.control.driver.climbs_by_itself or sinking):
        return reference
    depth_m, sink_m_s = (
        (config.descent.press_depth_m, config.descent.touchdown_sink_rate_m_s) if sinking else (0.0, 0.0)
    )
    return ReferenceState(
        position_enu_m=drone.position_enu_m - np.array([0.0, 0.0, depth_m]),
        velocity_enu_m_s=np.array([0.0, 0.0, -sink_m_s]),
        acceleration_enu_m_s2=np.zeros(3),
    )


def _is_left_by_pad(memory: StepMemory, situation: Situation, config: CompanionConfig) -> bool:
    relative = situation.approach
    if memory.progress.phase is not Phase.TOUCHDOWN or relative is None:
        return False
    left_m = 2.0 * over_pad_radius_m(relative.pad_half_width_m, config)
    return relative.speed_m_s > config.abort.near_speed_max_m_s or relative.distance_m > left_m


def _to_lost_drone(memory: StepMemory, situation: Situation, config: CompanionConfig) -> StepMemory:
    """Return the memory with the virtual model where the drone is, once the drone has lost it outside of a landing.

    A drone that hovered through a silent link is not to be sent after a model that has flown on.
    """
    phase, drone, tracking = memory.progress.phase, situation.drone, memory.model.tracking
    lands = phase in LANDING_PHASES or phase is Phase.TOUCHDOWN
    if lands or drone is None or tracking.error_m < config.abort.tracking_error_max_m:
        return memory
    reference = ReferenceState(
        position_enu_m=drone.position_enu_m, velocity_enu_m_s=drone.velocity_enu_m_s, acceleration_enu_m_s2=np.zeros(3)
    )
    model = replace(
        memory.model,
        reference=reference,
        reference_ns=situation.monotonic_ns,
        guidance=None,
        tracking=Tracking(compared_ns=tracking.compared_ns),
    )
    places = memory.places
    if phase in (Phase.ABORT, Phase.HOLD):
        places = replace(places, anchor_enu_m=stopping_point(reference, BRAKING_M_S2))
    return replace(memory, model=model, places=places)


def _update_anchor(memory: StepMemory, situation: Situation, config: CompanionConfig) -> StepMemory:
    """Take the place to stop along while an abort follows the vehicle, for when the vehicle falls silent."""
    reference, anchor = memory.model.reference, memory.places.anchor_enu_m
    if memory.progress.phase is not Phase.ABORT or reference is None or anchor is None:
        return memory
    if situation.pad is None or not _is_fresh(situation, config):
        return memory
    x, y, _ = stopping_point(reference, BRAKING_M_S2)
    return replace(memory, places=replace(memory.places, anchor_enu_m=np.array([x, y, anchor[2]])))


def _slewed_yaw_rad(memory: StepMemory, pad: PadPath | None, dt_s: float, config: CompanionConfig) -> float:
    """Turn towards the vehicle's heading while it is followed, at a bounded rate."""
    phase, yaw_rad = memory.progress.phase, memory.model.yaw_setpoint_rad
    follows = phase in LANDING_PHASES or phase is Phase.TOUCHDOWN
    if not (follows and config.follows_heading) or pad is None or pad.yaw_rad is None:
        return yaw_rad
    turn_max_rad = config.yaw_rate_max_rad_s * dt_s
    turn_rad = wrap_angle(pad.yaw_rad - yaw_rad)
    return wrap_angle(yaw_rad + min(max(turn_rad, -turn_max_rad), turn_max_rad))
