"""One step of the companion: estimate the vehicle, decide, plan, and say what the autopilot should do.

Pure: the same memory, inputs and system give the same result, in flight, in simulation and in replay.
"""

from companion.autopilots.driver import AutopilotCommand, Desire
from companion.config.companion import CompanionConfig
from companion.core.data import Forecast, OwnState
from companion.integrity.contradictions import counted
from companion.integrity.course import watched, without_contradicted_heading
from companion.integrity.fix_stamps import with_newest
from companion.integrity.ground import ground_enu_m, is_road_elsewhere
from companion.integrity.pad_height import pad_raised_m, with_pad_raised
from companion.landing.condition import holds
from companion.landing.contact import may_force_motors_off, signs_of
from companion.landing.contact_tests import HELD_UP
from companion.landing.flying import fly, has_free_place, setpoint
from companion.landing.shifts import in_present_frame
from companion.landing.status import landing_status
from companion.landing.step_data import StepInputs, StepMemory, StepOutputs, System
from companion.landing.targets import HORIZON_OFFSETS_S
from companion.landing.transitions import transitions
from companion.landing.virtual_model import compare
from companion.planning.requests import are_finite
from companion.situation.phases import FOLLOWING_PHASES, LANDING_PHASES, Phase
from companion.situation.situation import Situation, drone_now, range_carried_m, range_height_m
from companion.vehicle.pad import PadPath, pad_path
from companion.vehicle.surprise import looked_back
from link.frames.rotations import yaw_of
from link.records import replace

_DISARM_MAX_S = 1.0  # it takes 0.6 s where the plain one is refused; the companion waits for 1.5 s before it ends
_PRESENT_OFFSETS_S = HORIZON_OFFSETS_S[:2]  # a second point tells how the lever arm turns


def companion_step(memory: StepMemory, inputs: StepInputs, system: System) -> tuple[StepMemory, StepOutputs]:
    """Return the memory after this step and what is to be sent.

    Args:
        memory: of the step before; `StepMemory()` at the start.
        inputs: what has been received since then.
        system: configuration, estimator and guidance law.
    """
    memory = _estimate(memory, inputs, system)
    memory, pad = _pad(memory, inputs, system)
    course = watched(memory.course, pad, memory.surprise.speed_std_m_s, system.config)
    situation = _situation(memory, pad, inputs, system)
    raised_m = pad_raised_m(memory.pad_raised_m, memory.phase, situation, system.config)
    memory = replace(
        memory,
        course=course,
        pad_raised_m=raised_m,
        ground_enu_m=ground_enu_m(memory.ground_enu_m, memory.phase, situation),
        is_road_elsewhere=is_road_elsewhere(memory.is_road_elsewhere, memory.phase, situation, system.config),
    )
    situation = with_pad_raised(situation, memory.pad_raised_m)
    before = memory
    memory, reply = transitions(memory, situation, inputs, system.config)
    if memory.phase in FOLLOWING_PHASES and before.phase not in FOLLOWING_PHASES:
        memory, pad = _pad(memory, inputs, system)
        situation = replace(situation, pad=pad)
    memory, plan = fly(memory, situation, inputs, system)
    memory, commands = _drive(memory, situation, inputs, system.config)
    outputs = StepOutputs(
        setpoint=setpoint(memory, inputs, system.config, plan),
        commands=commands,
        text=_news(before, memory),
        reply=reply,
        status=landing_status(memory, situation, system.config),
        plan=plan,
    )
    return memory, outputs


def _news(before: StepMemory, memory: StepMemory) -> str | None:
    """Return what the pilot is told of this step, None when there is nothing new."""
    if memory.phase is not before.phase:
        return f"{memory.phase.value}: {memory.reason}"
    told = memory.obstacle
    is_new = told is not None and (before.obstacle is None or before.obstacle[0] != told[0])
    return f"{memory.phase.value}: {told[1]}" if told is not None and is_new else None


def _estimate(memory: StepMemory, inputs: StepInputs, system: System) -> StepMemory:
    """Fuse what the vehicle sent; when the local frame has moved, everything in it starts anew."""
    memory = in_present_frame(memory, inputs.autopilot)
    estimator, tracking = memory.estimator, memory.tracking
    if inputs.measurements:
        estimator = system.estimator.fuse(estimator, inputs.measurements)
    if inputs.own is not None and memory.reference is not None:
        flies_place = memory.phase in LANDING_PHASES and not has_free_place(memory, inputs, system.config)
        learn = system.config.corrects_lag and flies_place
        tracking = compare(tracking, inputs.own, learn=learn)
    surprise = looked_back(memory.surprise, system.estimator, estimator, inputs.t_ns, system.config.descent)
    stamps = with_newest(memory.fix_stamps, system.estimator.newest_fix_ns(estimator), inputs.t_ns)
    if memory.contradictions.is_due(inputs.t_ns):
        health = system.estimator.health(estimator)
        memory = replace(memory, contradictions=counted(memory.contradictions, health, inputs.t_ns))
    return replace(memory, estimator=estimator, tracking=tracking, surprise=surprise, fix_stamps=stamps)


def _pad(memory: StepMemory, inputs: StepInputs, system: System) -> tuple[StepMemory, PadPath | None]:
    """Return the pad as far ahead as the phase looks; an estimate that is not finite is given up and starts anew."""
    offset_s = HORIZON_OFFSETS_S if memory.phase in FOLLOWING_PHASES else _PRESENT_OFFSETS_S
    forecast = system.estimator.forecast(memory.estimator, inputs.t_ns, offset_s)
    if forecast is None:
        return memory, None
    if _is_finite(forecast):
        return memory, without_contradicted_heading(pad_path(forecast, inputs.pad), memory.course)
    return replace(memory, estimator=None), None


def _is_finite(forecast: Forecast) -> bool:
    path = (forecast.position_enu_m, forecast.velocity_enu_m_s, forecast.acceleration_enu_m_s2)
    return are_finite(*path, forecast.position_std_m, *(() if forecast.yaw_rad is None else (forecast.yaw_rad,)))


def _situation(memory: StepMemory, pad: PadPath | None, inputs: StepInputs, system: System) -> Situation:
    newest_ns = system.estimator.newest_fix_ns(memory.estimator)
    drone = drone_now(inputs.own, inputs.t_ns, _own_yaw_rad(inputs.own), system.config.abort.own_age_max_s)
    seen, sensor_m = inputs.autopilot.range_down, system.config.touchdown.range_finder_height_m
    return Situation(
        t_ns=inputs.t_ns,
        autopilot=inputs.autopilot,
        drone=drone,
        pad=pad,
        feet_offset_m=system.config.touchdown.gear_height_m,
        fix_age_s=None if newest_ns is None else (inputs.t_ns - newest_ns) * 1e-9,
        fix_age_on_arrival_s=memory.fix_stamps.age_on_arrival_s,
        vehicle_alive=inputs.vehicle_alive,
        reference=memory.reference,
        tracking_error_m=memory.tracking.error_m,
        waiting_point_enu_m=memory.waiting_point_enu_m,
        speed_std_m_s=memory.surprise.speed_std_m_s,
        ground_enu_m=memory.ground_enu_m,
        is_road_elsewhere=memory.is_road_elsewhere,
        rejected_share=memory.contradictions.rejected_share,
        limits=inputs.limits,
        speed_limited_by=() if inputs.driver is None else inputs.driver.speed_parameters,
        range_height_m=range_height_m(inputs.own, seen, sensor_m, inputs.t_ns),
        range_carried_m=range_carried_m(drone, seen, sensor_m, inputs.t_ns),
    )


def _own_yaw_rad(own: OwnState | None) -> float:
    return 0.0 if own is None else yaw_of(own.orientation_wxyz)


def _drive(
    memory: StepMemory, situation: Situation, inputs: StepInputs, config: CompanionConfig
) -> tuple[StepMemory, tuple[AutopilotCommand, ...]]:
    """Return the memory and the commands that bring the autopilot to what the phase needs."""
    if inputs.driver is None:
        return memory, ()
    driver_memory = memory.driver
    for command, result in inputs.acknowledgements:
        driver_memory = inputs.driver.acknowledged(driver_memory, command, result)
    hands_over = inputs.leaving and not _finishes_disarm(memory, situation)
    desire = Desire(release=True) if hands_over else _desire(memory, situation, config)
    driver_memory, commands = inputs.driver.act(driver_memory, inputs.autopilot, desire, inputs.t_ns)
    if driver_memory is not memory.driver:
        memory = replace(memory, driver=driver_memory)
    return memory, commands


def _finishes_disarm(memory: StepMemory, situation: Situation) -> bool:
    """Return whether the motors are being switched off: an autopilot that hovers by itself would leave the pad."""
    return memory.phase is Phase.TOUCHDOWN and (situation.t_ns - memory.phase_since_ns) * 1e-9 < _DISARM_MAX_S


def _desire(memory: StepMemory, situation: Situation, config: CompanionConfig) -> Desire:
    match memory.phase:
        case Phase.TAKEOFF:
            return Desire(control=True, armed=True, takeoff_height_m=config.takeoff.waiting_height_m)
        case Phase.TOUCHDOWN:
            since_s = (situation.t_ns - memory.phase_since_ns) * 1e-9
            # Without accelerations in its setpoints an autopilot is not pressed down so hard that it would fall.
            held_up = holds(HELD_UP, memory.held, situation.t_ns, config) and not config.position_only
            evidence = may_force_motors_off(
                signs_of(situation), since_s, config, stopped_and_held=memory.stopped_by_pad and held_up
            )
            return Desire(armed=False, force_disarm=evidence)
        case _:
            return Desire()  # control that was had and is lost is not taken back
