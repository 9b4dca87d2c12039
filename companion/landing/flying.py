"""From the phase to the next state of the virtual model; pure."""

import numpy as np

from companion.config.companion import CompanionConfig
from companion.config.planning import GuidanceKind
from companion.core.data import STEP_MAX_S, FlightLimits
from companion.landing.carried_on import limit_rates
from companion.landing.decisions.conditions import is_fix_old
from companion.landing.decisions.contact_trial import hears_setpoints
from companion.landing.decisions.waiting import waits_at_m
from companion.landing.sortie.aims import advance_way, sortie_aim
from companion.landing.sortie.riding import is_carried_by_deck, model_on_deck
from companion.landing.state.memory import ModelMemory, StepMemory
from companion.landing.state.step_data import StepInputs, System
from companion.landing.steering.ahead import make_up, model_along, shift_aim
from companion.landing.steering.flown_plan import extrapolate, flown_plan, state_at
from companion.landing.steering.following_height import rise_from_ground_m, waiting_rise_m
from companion.landing.steering.seen_floor import keep_above_seen
from companion.landing.steering.targets import Aim, hover_aim, is_at_rest, pad_aim, stopping_point
from companion.landing.steering.virtual_model import Tracking, add_to_past, state_then
from companion.landing.touchdown.levelling import levelled, levelling_now, limit_tilt
from companion.planning.guidance import PlanRequest, PlanResult, ReferenceState
from companion.situation.phases import FLYING_PHASES, LANDING_PHASES, STATION_PHASES, Phase
from companion.situation.situation import Drone, Situation
from companion.vehicle.pad import PadPath
from companion.vehicle.pad_reach import left_behind_m
from link.frames.rotations import wrap_angle
from link.records import replace


def _aim(
    memory: StepMemory, situation: Situation, limits: FlightLimits, planned: FlightLimits, config: CompanionConfig
) -> Aim:
    """Return where the present phase wants the drone, which has `limits`; its plan keeps to those `planned` with."""
    phase, reference, pad = memory.progress.phase, memory.model.reference, situation.pad
    anchor, waiting_point = memory.places.anchor_enu_m, memory.places.waiting_point_enu_m
    if reference is None or anchor is None or waiting_point is None:
        raise ValueError(f"phase {phase.value} flies without a reference")
    aim = sortie_aim(memory, situation, planned, config)
    if aim is not None:
        return aim
    match phase:
        case Phase.CHASE | Phase.ALIGN | Phase.DESCEND | Phase.TOUCHDOWN | Phase.ABORT if pad is not None and (
            phase is not Phase.ABORT or not is_fix_old(situation, config)
        ):
            lowest_m = waits_at_m(memory, situation, config)
            aim = pad_aim(phase, pad, reference, situation.feet_offset_m, config, limits=limits, lowest_m=lowest_m)
            return keep_above_seen(aim, phase, reference, situation, config)
        case Phase.ABORT:
            return hover_aim(anchor + np.array([0.0, 0.0, config.abort.height_m]))
        case Phase.TAKEOFF if not (situation.autopilot.armed and situation.autopilot.in_control):
            return hover_aim(anchor)
        case Phase.HOLD | Phase.TOUCHDOWN:  # what touches a pad that nobody knows any more stays where it is
            return hover_aim(anchor if phase is Phase.HOLD else reference.position_enu_m)
        case _:
            looks = phase is Phase.WAITING and not is_fix_old(situation, config)
            rise_m = waiting_rise_m(float(waiting_point[2]), situation, config) if looks else 0.0
            return hover_aim(waiting_point + np.array([0.0, 0.0, rise_m]))


def fly(
    memory: StepMemory, situation: Situation, inputs: StepInputs, system: System
) -> tuple[StepMemory, PlanResult | None]:
    """Plan from the virtual model now to where it is at the next step, one period from now."""
    if memory.model.reference is None or memory.progress.phase not in FLYING_PHASES:
        return memory, None
    memory = _to_lost_drone(memory, situation)
    model = memory.model
    if model.reference is None:
        return memory, None
    period_s, ahead_s = 1.0 / system.config.setpoints.rate_hz, inputs.ahead_s(system.config)
    late_s = _late_s(model, inputs.monotonic_ns, period_s)
    reference_ns, starts_ns = (inputs.monotonic_ns + round(later_s * 1e9) for later_s in (period_s, ahead_s))
    now, start = extrapolate(model.reference, late_s), None
    if model.plan is not None:
        elapsed_s = late_s + ahead_s - (model.plan.starts_ns - model.reference_ns) * 1e-9
        now, start = model_along(model.plan, model.tracking, inputs.monotonic_ns, starts_ns, elapsed_s)
    reference = _at_drone(memory, now, situation, system.config)
    if start is None or reference is not now:
        start = extrapolate(reference, ahead_s)
        model = replace(model, tracking=add_to_past(model.tracking, inputs.monotonic_ns, reference))
    memory = replace(memory, model=(model := replace(model, reference=reference)))
    limits = _plan_limits(memory, situation, inputs, system.config)
    memory = _wait_above_ground(memory, situation, period_s, system.config)
    memory = advance_way(memory, situation, limits, system.config)
    aim = shift_aim(_aim(memory, situation, inputs.limits, limits, system.config), ahead_s)
    tracking = add_to_past(model.tracking, starts_ns, start)
    if is_at_rest(start, aim):  # there is nothing to plan
        tracking = add_to_past(tracking, max(starts_ns, reference_ns), start)
        return replace(memory, model=replace(model, reference_ns=reference_ns, plan=None, tracking=tracking)), None
    request = PlanRequest(
        state=start,
        target=aim.target,
        limits=limits,
        floor_enu_m=aim.floor_enu_m,
        touched_enu_m=aim.touched_enu_m,
        dt_s=period_s,
    )
    request = _for_the_drone(request, memory, inputs, system.config.guidance.kind, ahead_s=ahead_s)
    request = limit_tilt(request, model.tracking.holds_enu_m_s2)
    guidance, plan = system.guidance.plan(model.guidance, request)
    flown = flown_plan(plan, period_s, float(aim.floor_enu_m[0]), inputs.shaping, limits, starts_ns=starts_ns)
    levelling = levelling_now(memory, situation, inputs, system.config)
    flown = flown if levelling is None else levelled(flown, levelling)
    plan = replace(plan, next_state=state_at(flown, period_s))
    tracking = add_to_past(tracking, starts_ns + round(period_s * 1e9), plan.next_state)
    model = replace(
        model,
        reference=state_then(tracking, reference_ns),
        reference_ns=reference_ns,
        plan=flown,
        guidance=guidance,
        tracking=tracking,
        yaw_setpoint_rad=_slew_yaw_rad(memory, situation.pad, period_s + late_s, system.config),
    )
    return _update_anchor(replace(memory, model=model), situation, system.config), plan


def _wait_above_ground(
    memory: StepMemory, situation: Situation, period_s: float, config: CompanionConfig
) -> StepMemory:
    point = memory.places.waiting_point_enu_m
    if memory.progress.phase is not Phase.WAITING or point is None:
        return memory
    up_m = rise_from_ground_m(float(point[2]), situation, period_s, config)
    if up_m == 0.0:
        return memory
    return replace(memory, places=replace(memory.places, waiting_point_enu_m=point + np.array([0.0, 0.0, up_m])))


def _plan_limits(memory: StepMemory, situation: Situation, inputs: StepInputs, config: CompanionConfig) -> FlightLimits:
    """Return the limits of this step's plan, all but that of the tilt."""
    if memory.progress.phase in (Phase.RETURN, Phase.RALLY):  # high, above all that being carried on could meet
        return inputs.limits
    return limit_rates(inputs.limits, memory, situation, inputs.shaping, config)


def _late_s(model: ModelMemory, monotonic_ns: int, period_s: float) -> float:
    """Return by how much later than `reference_ns`, to which the last step led, this step comes; it may be earlier."""
    return max(min((monotonic_ns - model.reference_ns) * 1e-9, STEP_MAX_S), -period_s)


def _for_the_drone(
    request: PlanRequest, memory: StepMemory, inputs: StepInputs, kind: GuidanceKind, *, ahead_s: float
) -> PlanRequest:
    """Return the request for a plan by which the drone, not the virtual model, is where the target is."""
    tracking, response = memory.model.tracking, inputs.response
    if memory.progress.phase not in LANDING_PHASES | STATION_PHASES or response is None or tracking.compared_ns is None:
        return request
    foresees = kind is GuidanceKind.MPC
    target = make_up(
        request.target,
        request.state,
        tracking,
        response,
        late_s=(inputs.monotonic_ns - tracking.compared_ns) * 1e-9,
        ahead_s=ahead_s,
        planner_foresees=foresees,
    )
    return replace(request, target=target, following=response.following if foresees else None)


def _at_drone(
    memory: StepMemory, reference: ReferenceState, situation: Situation, config: CompanionConfig
) -> ReferenceState:
    """Keep the virtual model with a drone that does not follow it, so that it takes over wherever that ends.

    One climbs by itself; another was held by what it touched while the pad drove on: it is pressed down where it is,
    which is what an autopilot's land detector waits for.
    """
    drone, sinking = situation.drone, _is_left_by_pad(memory, situation, config)
    lifts_by_itself = memory.progress.phase is Phase.LIFT_OFF and memory.control.driver.climbs_by_itself
    if drone is not None and (lifts_by_itself or is_carried_by_deck(memory.progress.phase, situation, config)):
        return model_on_deck(drone, memory.progress.phase, situation, config)
    if drone is None or not (memory.control.driver.climbs_by_itself or sinking):
        return reference
    depth_m, sink_m_s = (
        (config.descent.sink.press_depth_m, config.descent.sink.contact_rate_m_s) if sinking else (0.0, 0.0)
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
    is_left = relative.distance_m > left_behind_m(relative.pad_half_width_m, config)
    return is_left or relative.speed_m_s > config.abort.near_speed_max_m_s


def _to_lost_drone(memory: StepMemory, situation: Situation) -> StepMemory:
    """Return the memory with the virtual model where the drone is, once the drone has lost it and nothing watches that.

    A drone that hovered through a silent link is not to be sent after a model that has flown on. Nor is one at a
    station that did not hear setpoints until a moment ago.
    """
    phase, drone, tracking = memory.progress.phase, situation.drone, memory.model.tracking
    is_watched = phase in LANDING_PHASES or phase is Phase.TOUCHDOWN
    is_watched = is_watched or (phase is Phase.FOLLOW and hears_setpoints(situation))
    if is_watched or drone is None or tracking.error_m < situation.following.error_max_m:
        return memory
    model, places = model_at(drone, memory.model, situation.monotonic_ns), memory.places
    if phase in (Phase.ABORT, Phase.HOLD) and model.reference is not None:
        places = replace(places, anchor_enu_m=stopping_point(model.reference))
    return replace(memory, model=model, places=places)


def model_at(drone: Drone, model: ModelMemory, monotonic_ns: int) -> ModelMemory:
    """Return the virtual model where the drone is, moving as it does."""
    return replace(
        model,
        reference=ReferenceState(
            position_enu_m=drone.position_enu_m,
            velocity_enu_m_s=drone.velocity_enu_m_s,
            acceleration_enu_m_s2=np.zeros(3),
        ),
        reference_ns=monotonic_ns,
        plan=None,
        guidance=None,
        tracking=Tracking(compared_ns=model.tracking.compared_ns),
    )


def _update_anchor(memory: StepMemory, situation: Situation, config: CompanionConfig) -> StepMemory:
    """Take the place to stop along while an abort follows the vehicle, for when the vehicle falls silent."""
    reference, anchor = memory.model.reference, memory.places.anchor_enu_m
    is_beside = situation.pad is not None and not is_fix_old(situation, config)
    if memory.progress.phase is not Phase.ABORT or reference is None or anchor is None or not is_beside:
        return memory
    x, y, _ = stopping_point(reference)
    return replace(memory, places=replace(memory.places, anchor_enu_m=np.array([x, y, anchor[2]])))


def _slew_yaw_rad(memory: StepMemory, pad: PadPath | None, dt_s: float, config: CompanionConfig) -> float:
    """Turn towards the vehicle's heading while it is followed, at a bounded rate."""
    phase, yaw_rad = memory.progress.phase, memory.model.yaw_setpoint_rad
    follows = phase in LANDING_PHASES | STATION_PHASES or phase is Phase.TOUCHDOWN
    if not (follows and config.setpoints.follows_heading) or pad is None or pad.yaw_rad is None:
        return yaw_rad
    turn_max_rad = config.setpoints.yaw_rate_max_rad_s * dt_s
    turn_rad = wrap_angle(pad.yaw_rad - yaw_rad)
    return wrap_angle(yaw_rad + min(max(turn_rad, -turn_max_rad), turn_max_rad))
