"""What a step learns of the vehicle: its data are fused and watched, and its pad is predicted; pure."""

import math

import numpy as np

from companion.config.integrity import ReceiverFrames
from companion.core.data import Array, Forecast, Measurement, Quantity, RangeReading
from companion.integrity.contradictions import Contradictions, update_contradictions
from companion.integrity.frames import (
    are_frames_one,
    has_lost_fix,
    update_fixed_phases,
    with_place_step,
    with_slide,
    without_place_step,
)
from companion.integrity.sightings import SightingWatch, forget_agreement, forget_step, update_sightings
from companion.integrity.slide import FixSlide, update_slide
from companion.integrity.stamps import FixStamps, is_step_of_stamps, update_fix_stamps
from companion.integrity.vehicle_data import without_contradicted_heading
from companion.integrity.way import way_error
from companion.landing.state.memory import VehicleMemory, between
from companion.landing.state.step_data import StepInputs, System
from companion.landing.steering.targets import HORIZON_OFFSETS_S
from companion.planning.guidance import are_finite
from companion.situation.phases import FOLLOWING_PHASES, LANDING_PHASES, Phase
from companion.vehicle.crest import Crest, crest_above_m, update_crest
from companion.vehicle.hindsight import forget_instants, update_hindsight
from companion.vehicle.pad import PadPath, pad_path
from companion.vehicle.pad_reach import is_agreement_old
from companion.vehicle.range_watch import RangeWatch, moved_up, watch_ranges
from companion.vehicle.surface import higher_by_road_m, surface_measurements
from companion.vehicle.velocity_lag import dated_velocities, learn_lag
from companion.vehicle.velocity_point import VelocityPoint, learn_point, velocities_of_antenna
from link.records import replace

_APPROACHING = LANDING_PHASES | {Phase.ABORT, Phase.TOUCHDOWN}
_SMALL_NS = 200_000_000  # clocks that date coarse fixes are up to 0.1 s off, either way (docs/benchmark.md)
_CORRECTION_MAX_NS = 1_000_000_000  # more is none: UTC was not known before
_PRESENT_OFFSETS_S = HORIZON_OFFSETS_S[:2]  # a second point tells how the lever arm turns


def update_vehicle(vehicle: VehicleMemory, inputs: StepInputs, system: System) -> VehicleMemory:
    """Fuse what the vehicle sent, and compare it with what was known before."""
    vehicle = _in_present_frame(_in_present_utc(vehicle, inputs), inputs, system)
    estimator, now_ns = vehicle.estimator, inputs.monotonic_ns
    lag = learn_lag(vehicle.velocity_lag, inputs.vehicle.measurements)
    is_lag_new = lag.is_known and not vehicle.velocity_lag.is_known
    dated = dated_velocities(lag, inputs.vehicle.measurements)
    point = learn_point(VelocityPoint() if is_lag_new else vehicle.velocity_point, dated)
    was_told_wrong = is_lag_new or (point.is_known and not vehicle.velocity_point.is_known)
    vehicle, seen = _seen_below(vehicle, inputs, system)
    measurements = velocities_of_antenna(point, dated) + seen
    way = way_error(system.estimator, estimator, measurements)
    if measurements:
        estimator = system.estimator.fuse(estimator, measurements)
    sightings, phases, led_astray = vehicle.sightings, vehicle.phases, inputs.vehicle.has_doubted_unit
    contradictions = Contradictions() if led_astray else vehicle.contradictions
    newest_fix_ns, is_of_stamps = system.estimator.newest_fix_ns(estimator), False
    if newest_fix_ns is not None and newest_fix_ns != vehicle.fix_stamps.newest_ns:
        is_of_stamps = is_step_of_stamps(vehicle.fix_stamps, (inputs.t_ns - newest_fix_ns) * 1e-9, way)
        place_step = system.estimator.health(estimator).place_step
        phases = with_place_step(phases, place_step, way if is_of_stamps else None)
    if was_told_wrong or led_astray:
        phases = without_place_step(phases)  # what was told wrong has led the estimate away
    slide = FixSlide() if was_told_wrong or is_of_stamps else vehicle.slide
    slide = update_slide(slide, dated, lag, point)
    if slide.has_slid and not phases.has_vehicle_stepped:
        phases, sightings = with_slide(phases), forget_agreement(sightings)
    if contradictions.is_due(now_ns):
        health = system.estimator.health(estimator)
        contradictions = update_contradictions(contradictions, health, now_ns)
        sightings = update_sightings(sightings, health, now_ns, system.config)
    if has_lost_fix(phases, inputs.autopilot.receiver, now_ns):
        sightings = forget_agreement(sightings)  # dead reckoning takes the drone away from where it has seen the pad
    return replace(
        vehicle,
        estimator=estimator,
        velocity_lag=lag,
        velocity_point=point,
        slide=slide,
        hindsight=update_hindsight(vehicle.hindsight, system.estimator, estimator, inputs.t_ns, monotonic_ns=now_ns),
        fix_stamps=update_fix_stamps(
            vehicle.fix_stamps,
            newest_fix_ns,
            inputs.t_ns,
            now_ns,
            refused_age_s=_refused_age_s(vehicle.fix_stamps, newest_fix_ns, inputs, system),
            way=way,
        ),
        contradictions=contradictions,
        sightings=sightings,
        phases=update_fixed_phases(
            phases,
            inputs.vehicle.measurements,
            now_ns,
            drone=inputs.autopilot.receiver,
            moves=inputs.autopilot.frame_moves,
        ),
    )


def _seen_below(
    vehicle: VehicleMemory, inputs: StepInputs, system: System
) -> tuple[VehicleMemory, tuple[Measurement, ...]]:
    """Return the vehicle with what the drone's range finder has just seen, and what that tells of the roof."""
    seen, estimator = inputs.autopilot.range_down, vehicle.estimator
    if seen is None or estimator is None or not _is_to_be_read(seen, vehicle.ranges, inputs.t_ns):
        return vehicle, ()
    then = system.estimator.forecast(estimator, seen.t_ns, _PRESENT_OFFSETS_S)
    vehicle_up_m = None if then is None else float(then.position_enu_m[0, 2])
    ranges, rises_m = watch_ranges(vehicle.ranges, seen, vehicle_up_m)
    vehicle = replace(vehicle, ranges=ranges)
    if rises_m is None:
        return vehicle, ()
    apart_std_m = 0.0 if _are_frames_one(vehicle, inputs, system) else math.inf
    return vehicle, surface_measurements(seen, rises_m, inputs.t_ns, system.config.touchdown, apart_std_m)


def _refused_age_s(stamps: FixStamps, newest_fix_ns: int | None, inputs: StepInputs, system: System) -> float | None:
    """Return how old a fix was as it came that is refused for its stamp, negative if that is ahead; None without one.

    One that is older than what the estimator keeps tells of a clock that was set back, once no other is accepted.
    """
    if inputs.vehicle.fix_ahead_s is not None:
        return -inputs.vehicle.fix_ahead_s
    if newest_fix_ns is None or newest_fix_ns != stamps.newest_ns:
        return None
    told_ns = max((one.t_ns for one in inputs.vehicle.measurements if one.quantity is Quantity.POSITION), default=None)
    if told_ns is None or newest_fix_ns - told_ns <= system.config.estimator.buffer.keep_s * 1e9:
        return None
    return (inputs.t_ns - told_ns) * 1e-9


def _in_present_utc(vehicle: VehicleMemory, inputs: StepInputs) -> VehicleMemory:
    """Forget what the vehicle's stamps have been compared with, once UTC was set.

    The estimate keeps its times: they are the vehicle's, whose clock is another one, so that nothing that awaits its
    data can be looked back at any more. By a correction the fixes are older or younger from then on, which the stamps
    are to show. A small one leaves the sightings what they were: they go on to place the pad.
    """
    utc_ahead_ns = inputs.t_ns - inputs.monotonic_ns
    set_by_ns = abs(utc_ahead_ns - vehicle.utc_ahead_ns)
    if set_by_ns < _SMALL_NS:
        return vehicle if not set_by_ns else replace(vehicle, utc_ahead_ns=utc_ahead_ns)
    return replace(
        vehicle,
        utc_ahead_ns=utc_ahead_ns,
        hindsight=forget_instants(vehicle.hindsight),
        fix_stamps=vehicle.fix_stamps if set_by_ns < _CORRECTION_MAX_NS else FixStamps(),
        contradictions=Contradictions(),
        sightings=SightingWatch(),
        ranges=RangeWatch(),
    )


def _is_to_be_read(seen: RangeReading, ranges: RangeWatch, now_ns: int) -> bool:
    """Return whether what a range finder saw is another reading than the last, and not from the future."""
    return seen.t_ns != ranges.newest_ns and seen.t_ns <= now_ns


def _in_present_frame(vehicle: VehicleMemory, inputs: StepInputs, system: System) -> VehicleMemory:
    """Return what is known in the frame that the autopilot's positions are in now.

    The estimate restarts where nobody knows by how much that has moved.
    """
    before, now = vehicle.frame_moves, inputs.autopilot.frame_moves
    if now == before:
        return vehicle
    if now.origin_count != before.origin_count:
        vehicle = replace(vehicle, estimator=None, slide=FixSlide(), ranges=RangeWatch())
        return replace(vehicle, crest=Crest(), frame_moves=now)
    estimator, seen_m = vehicle.estimator, between(before.shift_enu_m, now.shift_enu_m)
    if estimator is not None:
        told_m = between(before.origin_shift_enu_m, now.origin_shift_enu_m)
        variance_m2 = now.shift_variance_m2 - before.shift_variance_m2
        # What is seen from the drone steps with its report; the fixes step with the first that comes from now on.
        newest_ns = system.estimator.newest_fix_ns(estimator)
        told_ns = now.stepped_ns if newest_ns is None else newest_ns + 1
        steps = [_frame_step(now.stepped_ns, seen_m, np.zeros(3), variance_m2)] if seen_m.any() else []
        steps += [_frame_step(told_ns, np.zeros(3), told_m, 0.0)] if told_m.any() else []
        estimator = system.estimator.fuse(estimator, steps)
    ranges = moved_up(vehicle.ranges, float(seen_m[2]))
    return replace(vehicle, estimator=estimator, slide=FixSlide(), ranges=ranges, crest=Crest(), frame_moves=now)


def _frame_step(t_ns: int, seen_m: Array, told_m: Array, variance_m2: float) -> Measurement:
    covariance = np.diag(np.concatenate([np.full(3, variance_m2), np.zeros(3)]))
    return Measurement(
        t_ns=t_ns, quantity=Quantity.FRAME_STEP, value=np.concatenate([seen_m, told_m]), covariance=covariance
    )


def predict_pad(
    phase: Phase, vehicle: VehicleMemory, inputs: StepInputs, system: System
) -> tuple[VehicleMemory, PadPath | None]:
    """Return the pad as far ahead as the phase looks; an estimate that is not finite is given up and restarts."""
    offset_s = HORIZON_OFFSETS_S if phase in FOLLOWING_PHASES else _PRESENT_OFFSETS_S
    forecast = system.estimator.forecast(vehicle.estimator, inputs.t_ns, offset_s)
    if forecast is None:
        return vehicle, None
    if _is_finite(forecast):
        has_one_frame = _are_frames_one(vehicle, inputs, system)
        sightings = vehicle.sightings if phase in _APPROACHING else forget_step(vehicle.sightings)
        vehicle = replace(vehicle, sightings=sightings) if sightings is not vehicle.sightings else vehicle
        pad = pad_path(
            forecast,
            inputs.vehicle.pad,
            has_one_frame=has_one_frame,
            is_confirmed=sightings.is_confirmed,
            higher_m=higher_by_road_m(vehicle.ranges, inputs.t_ns, inputs.vehicle.pad, system.config.touchdown),
        )
        if is_agreement_old(pad, system.config):
            vehicle = replace(vehicle, sightings=forget_agreement(sightings))
        if pad.mounting.is_afloat:
            vehicle, pad = _see_crest(vehicle, pad, inputs.monotonic_ns)
        return vehicle, without_contradicted_heading(pad, vehicle.course)
    return replace(vehicle, estimator=None), None


def _see_crest(vehicle: VehicleMemory, pad: PadPath, monotonic_ns: int) -> tuple[VehicleMemory, PadPath]:
    deck_enu_m = float(pad.position_enu_m[0, 2])
    crest = update_crest(vehicle.crest, monotonic_ns, deck_enu_m)
    vehicle = vehicle if crest is vehicle.crest else replace(vehicle, crest=crest)
    return vehicle, replace(pad, crest_above_m=crest_above_m(crest, deck_enu_m))


def _are_frames_one(vehicle: VehicleMemory, inputs: StepInputs, system: System) -> bool:
    """Return whether both receivers have one frame; by their phases alone only where no detector is there to be asked.

    One whose stamps are wrong is there, and what it sees may show that the frames are apart.
    """
    configured = system.config.integrity.receiver_frames
    if configured is ReceiverFrames.AUTO and inputs.vehicle.has_unplaced_sightings:
        return False
    return are_frames_one(vehicle.phases, configured, inputs.monotonic_ns)


def _is_finite(forecast: Forecast) -> bool:
    path = (forecast.position_enu_m, forecast.velocity_enu_m_s, forecast.acceleration_enu_m_s2)
    if math.isnan(forecast.yaw_std_rad) or math.isnan(forecast.frame_offset_std_m):
        return False
    return are_finite(*path, forecast.position_std_m, *(() if forecast.yaw_rad is None else (forecast.yaw_rad,)))
