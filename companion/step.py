"""One step of the companion: estimate the vehicle, decide, plan, and say what the autopilot should do.

Pure: the same memory, inputs and system give the same result, in flight, in simulation and in replay.
"""

import math

import numpy as np

from companion.config.companion import CompanionConfig
from companion.integrity.heights import is_road_elsewhere, update_ground
from companion.integrity.sightings import is_pad_sighted
from companion.integrity.vehicle_data import update_course
from companion.landing.flying import fly
from companion.landing.orders import drive
from companion.landing.outputs import landing_status, news, news_of_sortie, setpoint
from companion.landing.sortie.phases import over_deck
from companion.landing.sortie.riding import place_by_deck
from companion.landing.state.memory import ModelMemory, StepMemory, to_present_frame
from companion.landing.state.step_data import StepInputs, StepOutputs, System
from companion.landing.state.vehicle_update import predict_pad, update_vehicle
from companion.landing.steering.losing import lost_for_s
from companion.landing.steering.regain import regain
from companion.landing.steering.virtual_model import (
    NO_RIDE,
    Ride,
    state_then,
    tracking_error_max_m,
    update_ride,
    update_tracking,
)
from companion.landing.touchdown.contact_forecast import update_forecast
from companion.landing.transitions import take_events
from companion.situation.own_drone import drone_now, lowest_foot, range_carried_m, range_height_m
from companion.situation.phases import FOLLOWING_PHASES, LANDING_PHASES, NEAR_PHASES, STATION_PHASES, Phase
from companion.situation.situation import Below, Following, Situation, VehicleNews, with_pad
from companion.vehicle.pad import PadPath
from link.frames.rotations import yaw_of
from link.records import replace

_GUST_STDS = 3.0


def companion_step(memory: StepMemory, inputs: StepInputs, system: System) -> tuple[StepMemory, StepOutputs]:
    """Return the memory after this step and what is to be sent.

    Args:
        memory: of the step before; `StepMemory()` at the start.
        inputs: what has been received since then.
        system: configuration, estimator and guidance law.
    """
    memory = to_present_frame(memory, inputs.autopilot)
    model, vehicle = _update_model(memory, inputs, system), update_vehicle(memory.vehicle, inputs, system)
    vehicle, pad = predict_pad(memory.progress.phase, vehicle, inputs, system)
    memory = replace(memory, model=model, vehicle=vehicle)
    situation = _situation(memory, pad, inputs, system)
    memory = _look(memory, situation, pad, system.config)
    memory = update_forecast(memory, situation, inputs, system)
    situation = replace(situation, contact=memory.forecast.contact if memory.forecast.is_committed else None)
    before, warned = memory.progress, memory.sortie.warning
    memory, reply = take_events(memory, situation, inputs, system.config)
    phase = memory.progress.phase
    if before.phase is Phase.ON_DECK and phase is Phase.LIFT_OFF:
        memory, situation = _learn_from_deck(memory, situation, inputs, system)
    if phase in FOLLOWING_PHASES and before.phase not in FOLLOWING_PHASES:
        vehicle, pad = predict_pad(phase, memory.vehicle, inputs, system)
        memory, situation = replace(memory, vehicle=vehicle), with_pad(situation, pad)
    memory, plan = fly(memory, situation, inputs, system)
    memory, commands = drive(memory, situation, inputs, system.config)
    outputs = StepOutputs(
        setpoint=setpoint(memory, inputs, situation, system.config, is_planned=plan is not None),
        commands=commands,
        text=news(before, memory.progress) or news_of_sortie(warned, memory.sortie.warning, phase),
        reply=reply,
        status=landing_status(memory, situation, system.config),
        plan=plan,
        pad=situation.pad,
    )
    return memory, outputs


def _learn_from_deck(
    memory: StepMemory, situation: Situation, inputs: StepInputs, system: System
) -> tuple[StepMemory, Situation]:
    """Return what is known once the drone stands on the pad for sure: where that is, and over what of it it rises."""
    vehicle = place_by_deck(memory.vehicle, situation.pad, inputs, system)
    vehicle, pad = predict_pad(memory.progress.phase, vehicle, inputs, system)
    situation = with_pad(situation, pad)
    sortie = over_deck(memory.sortie, situation, system.config)
    return replace(memory, vehicle=vehicle, sortie=sortie), situation


def _update_model(memory: StepMemory, inputs: StepInputs, system: System) -> ModelMemory:
    """Compare the virtual model with where the drone says that it was, and put it there once its path has left it."""
    model, own = memory.model, inputs.own
    if own is None or model.reference is None:
        return model
    follows = memory.progress.phase in LANDING_PHASES | STATION_PHASES
    estimates = follows and system.config.setpoints.corrects_lag
    own_ns = inputs.monotonic_at(own.t_ns)
    tracking = update_tracking(model.tracking, own_ns, own, inputs.response, estimates=estimates)
    is_new, makes_path = tracking is not model.tracking, inputs.shaping is not None
    model = replace(model, tracking=tracking)
    if not (is_new and estimates and makes_path) or inputs.response is None:
        return model
    regained = regain(tracking, inputs.response, inputs.monotonic_ns)
    if regained is tracking:
        return model
    return replace(model, tracking=regained, plan=None, reference=state_then(regained, model.reference_ns))


def _situation(memory: StepMemory, pad: PadPath | None, inputs: StepInputs, system: System) -> Situation:
    vehicle, touchdown = memory.vehicle, system.config.touchdown
    newest_ns = system.estimator.newest_fix_ns(vehicle.estimator)
    yaw_rad = 0.0 if inputs.own is None else yaw_of(inputs.own.orientation_wxyz)
    drone = drone_now(inputs.own, inputs.t_ns, yaw_rad, system.config.abort.own_age_max_s)
    seen, sensor_m = inputs.autopilot.range_down, touchdown.range_finder.height_m
    return Situation(
        t_ns=inputs.t_ns,
        monotonic_ns=inputs.monotonic_ns,
        autopilot=inputs.autopilot,
        drone=drone,
        pad=pad,
        vehicle=VehicleNews(
            fix_age_s=None if newest_ns is None else (inputs.t_ns - newest_ns) * 1e-9,
            fix_age_on_arrival_s=vehicle.fix_stamps.age_on_arrival_s,
            fixes_apart_s=vehicle.fix_stamps.apart_s,
            stamps_stepped_s=vehicle.fix_stamps.stepped_s,
            is_alive=inputs.vehicle.is_alive,
            speed_std_m_s=vehicle.hindsight.speed_std_m_s,
            fix_std_m=vehicle.phases.vehicle_std_m,
            rejected_share=vehicle.contradictions.rejected_share,
            rejected=vehicle.contradictions.rejected,
            is_pad_doubted=inputs.vehicle.is_pad_doubted,
            are_sightings_mixed=vehicle.sightings.are_mixed,
            is_pad_sighted=is_pad_sighted(vehicle.sightings, inputs.monotonic_ns),
            has_unplaced_sightings=inputs.vehicle.has_unplaced_sightings,
            has_receiver_stepped=vehicle.phases.has_stepped,
            has_pad_stepped=vehicle.sightings.has_stepped,
            is_road_elsewhere=bool(vehicle.is_road_elsewhere),
            has_shown_heading=vehicle.course.has_agreed,
        ),
        below=Below(
            range_height_m=range_height_m(inputs.own, seen, sensor_m, inputs.t_ns),
            range_carried_m=range_carried_m(drone, seen, sensor_m, inputs.t_ns),
            ground_enu_m=memory.places.ground_enu_m,
        ),
        feet_offset_m=touchdown.gear_height_m,
        following=Following(
            reference=memory.model.reference,
            error_m=memory.model.tracking.error_m,
            lost_for_s=lost_for_s(memory.model.tracking.losses, inputs.monotonic_ns),
            error_max_m=tracking_error_max_m(
                memory.model.reference, inputs.response, inputs.link_delay.std_s, system.config.abort.tracking_stds_max
            ),
            late_s=inputs.link_delay.mean_s + inputs.link_delay.std_s,
            unanswered_s=inputs.link_delay.unanswered_s,
            answering_s=inputs.link_delay.answering_s,
            rides_m=memory.model.ride.above_m,
            pushed_m_s2=_pushed_m_s2(memory),
            takes_m_s2=_takes_m_s2(memory, pad),
        ),
        waiting_point_enu_m=memory.places.waiting_point_enu_m,
        rival=inputs.rival,
        limits=inputs.limits,
        speed_limited_by=() if inputs.driver is None else inputs.driver.speed_parameters,
    )


def _pushed_m_s2(memory: StepMemory) -> float:
    """Return how hard the air pushes the drone in such a gust as is felt once in some minutes."""
    steady_m_s2 = math.hypot(*memory.model.tracking.air_enu_m_s2.tolist())
    return steady_m_s2 + _GUST_STDS * memory.forecast.gusts.push_std_m_s2


def _takes_m_s2(memory: StepMemory, pad: PadPath | None) -> float:
    """Return what it takes to accelerate as the pad does and to hold against the air."""
    turns = np.zeros(2) if pad is None else pad.acceleration_enu_m_s2[0, :2]
    return math.hypot(*(turns + memory.model.tracking.holds_enu_m_s2).tolist())


def _look(memory: StepMemory, situation: Situation, pad: PadPath | None, config: CompanionConfig) -> StepMemory:
    """Take what this step shows of the vehicle's course, of the ground and of how the drone flies on its setpoints."""
    phase, vehicle = memory.progress.phase, memory.vehicle
    vehicle = replace(
        vehicle,
        course=update_course(vehicle.course, situation.monotonic_ns, pad, vehicle.hindsight.speed_std_m_s, config),
        is_road_elsewhere=is_road_elsewhere(vehicle.is_road_elsewhere, phase, situation, config),
    )
    places = replace(memory.places, ground_enu_m=update_ground(memory.places.ground_enu_m, phase, situation))
    ride = _ride(memory, situation, config)
    model = memory.model if ride is memory.model.ride else replace(memory.model, ride=ride)
    return replace(memory, vehicle=vehicle, places=places, model=model)


def _ride(memory: StepMemory, situation: Situation, config: CompanionConfig) -> Ride:
    """Return how high the drone flies on its setpoints; near the pad, which may hold it up, as it did before."""
    ride, relative, reference = memory.model.ride, situation.approach, memory.model.reference
    phase, drone = memory.progress.phase, situation.drone
    if phase not in NEAR_PHASES:
        return ride if phase is Phase.TOUCHDOWN else NO_RIDE
    if relative is None or reference is None or drone is None or relative.height_m <= config.touchdown.height_max_m:
        return ride
    above_m = float(drone.position_enu_m[2] - reference.position_enu_m[2])
    foot_below_m, _ = lowest_foot(drone, config.touchdown)
    return update_ride(ride, situation.monotonic_ns, above_m, foot_below_m)
