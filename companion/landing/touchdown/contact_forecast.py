"""The forecast of the contact that a descent leads to if it goes on, made ten times a second or more; pure."""

import math

import numpy as np

from companion.core.data import Quantity
from companion.forecast.branches import make_events
from companion.forecast.chances import sum_up
from companion.forecast.draws import draws
from companion.forecast.drivers import update_drivers
from companion.forecast.gusts import Gusts, forget_push, update_gusts
from companion.forecast.rollout import roll_out
from companion.forecast.samples import Descent, Samples
from companion.landing.decisions.waiting import is_moment_quiet
from companion.landing.state.memory import ForecastMemory, StepMemory
from companion.landing.state.step_data import StepInputs, System
from companion.landing.touchdown.rollout_errors import as_driven, climbs_m_s, draw_deck, draw_errors, relearns_hz
from companion.landing.touchdown.rollout_inputs import (
    course_of,
    deviation_now,
    follower_of,
    rules_of,
    way_to_contact,
)
from companion.situation.phases import Phase
from companion.situation.situation import Situation, vehicle_stands
from link.messages import ContactForecast
from link.records import replace

_PERIOD_S = 0.1  # between two of them above the commit height; below it each step that knows of a brake counts
_TURNING = frozenset({Quantity.HEADING, Quantity.YAW_RATE})
_UNSEEN_MAX = 0.5  # of the ways on wait or break off: then most of what a contact would be is not seen yet
_RISK_MEAN_S = 0.5  # in which some five new fixes make an estimate's errors others
_AGE_MAX_S = 1.0  # of data, beyond which the landing is broken off anyway


def update_forecast(memory: StepMemory, situation: Situation, inputs: StepInputs, system: System) -> StepMemory:
    """Return the memory with the forecast of this step, None in a phase that does not descend."""
    now_ns, known = situation.monotonic_ns, _update_known(memory, situation, inputs)
    if memory.progress.phase is not Phase.DESCEND:
        none = replace(known, contact=None, made_ns=None, is_committed=False, has_begun=False, risk=None)
        return replace(memory, forecast=none)
    relative = situation.approach
    is_low = relative is not None and relative.height_m < system.config.descent.commit_height_m
    if not is_low and known.made_ns is not None and now_ns - known.made_ns < round(_PERIOD_S * 1e9):
        return replace(memory, forecast=known)
    memory = replace(memory, forecast=replace(known, made_ns=now_ns, is_committed=is_low))
    contact = forecast_contact(memory, situation, inputs, system)
    risk = _risk(known.risk, contact, situation)
    begins = known.has_begun or (risk is not None and is_moment_quiet(risk, situation, system.config))
    return replace(memory, forecast=replace(memory.forecast, contact=contact, risk=risk, has_begun=begins))


def _risk(before: float | None, contact: ContactForecast | None, situation: Situation) -> float | None:
    """Return the risk of a contact, if it comes to one, None while most ways on end before it.

    An estimate's own errors have it go up and down by half of itself. Whoever begins as soon as it is small enough once
    takes an error for a quiet moment, so it is a mean, but over a deck that swings: there moments are short.
    """
    if contact is None or contact.broken_off > _UNSEEN_MAX:
        return None
    now = contact.unsafe / (1.0 - contact.broken_off)
    swings = situation.pad is not None and situation.pad.swing is not None
    return now if before is None or swings else before + _PERIOD_S / _RISK_MEAN_S * (now - before)


def _update_known(memory: StepMemory, situation: Situation, inputs: StepInputs) -> ForecastMemory:
    """Return what forecasts are made from, with what this step shows of driver, gusts and inertial unit."""
    before = memory.forecast
    told = {one.quantity for one in inputs.vehicle.measurements}
    return replace(
        before,
        drivers=update_drivers(before.drivers, memory.vehicle.hindsight.driving.driven),
        gusts=_gusts(memory, inputs),
        acceleration_ns=situation.monotonic_ns if Quantity.ACCELERATION in told else before.acceleration_ns,
        turning_ns=situation.monotonic_ns if told & _TURNING else before.turning_ns,
    )


def _gusts(memory: StepMemory, inputs: StepInputs) -> Gusts:
    """Return the gusts after this step; in a chase what looks like a push is what no model knows of a hard flight."""
    gusts, tracking, reference = memory.forecast.gusts, memory.model.tracking, memory.model.reference
    flies_evenly = memory.progress.phase in (Phase.ALIGN, Phase.DESCEND) and bool(tracking.deviation.any())
    if not flies_evenly or tracking.compared_ns is None or inputs.response is None or reference is None:
        return gusts
    losses = tracking.losses
    if losses is not None and losses.newest_ns == tracking.compared_ns:
        gusts = forget_push(gusts)  # from here on it is estimated anew
    path_m_s2 = reference.acceleration_enu_m_s2[:2]
    return update_gusts(gusts, tracking.compared_ns, tracking.deviation, path_m_s2, inputs.response)


def forecast_contact(
    memory: StepMemory, situation: Situation, inputs: StepInputs, system: System
) -> ContactForecast | None:
    """Return the forecast, None while too little is known for one or the pad is too far below."""
    pad, relative, config = situation.pad, situation.approach, system.config
    newest_ns = system.estimator.newest_fix_ns(memory.vehicle.estimator)
    if pad is None or relative is None or inputs.response is None or newest_ns is None:
        return None
    age_s = max((inputs.t_ns - newest_ns) * 1e-9, 0.0)
    then = system.estimator.estimate(memory.vehicle.estimator, newest_ns)
    way_down = way_to_contact(memory, situation, config)
    if then is None or way_down is None or age_s > _AGE_MAX_S:
        return None
    deviation = deviation_now(memory, inputs, pad)
    course = course_of(memory, relative, pad, way_down, deviation)
    numbers = draws()
    stands = vehicle_stands(situation, config.chase)
    deviates = inputs.response.covariance_in(memory.forecast.gusts.push_std_m_s2)
    driving = memory.vehicle.hindsight.driving
    errors = draw_errors(then, pad, climbs_m_s(then, pad, driving), deviates, numbers)
    deck = draw_deck(pad, way_down.contact_s, numbers.tilts)
    late_s = memory.vehicle.hindsight.lateness_s or age_s
    jitter_s = inputs.link_delay.std_s * errors.late
    delay_s = late_s + 0.5 / config.setpoints.rate_hz + inputs.link_delay.mean_s + jitter_s
    vehicle = as_driven(errors.vehicle, driving, course.direction[0], stands=stands)
    error_std_m_s = math.sqrt(float(np.mean(np.square(vehicle[:, 1]))))
    drone = follower_of(memory, situation, inputs, config, relearns_hz=relearns_hz(then), error_std_m_s=error_std_m_s)
    events = make_events(
        numbers,
        memory.forecast.drivers,
        within_s=age_s + way_down.lasts_s,
        unseen_s=2.0 * max(drone.trails_s, 0.0),  # for so long a trailing antenna has not turned more than before
        speed_m_s=float(course.speed_m_s[0]),
        left_m_s2=float(course.left_m_s2[0]),
        stands=stands,
    )
    samples = Samples(
        vehicle=vehicle,
        kind=events.kind,
        event=events.event,
        delay_s=np.maximum(delay_s, 0.0),
        ahead_s=inputs.ahead_s(config) + jitter_s,
        deviation=deviation + errors.deviation,
        vertical=errors.vertical,
        deck=deck,
        pushes=numbers.pushes,
    )
    descent = Descent(course=course, drone=drone, rules=rules_of(relative, inputs, config))
    ends = roll_out(samples, descent, age_s)
    return sum_up(ends, events.weight, max(relative.pad_half_width_m - config.touchdown.foot_radius_m, 0.0))
