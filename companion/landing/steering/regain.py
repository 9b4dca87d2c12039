"""Where the virtual model goes on when the drone has lost it: at the drone; pure numerics.

An autopilot that makes a path of its own of the setpoints (ArduPilot) follows none whose acceleration changes faster
than its jerk. What its path is late by, for setpoints that were lost, it makes up for late, and overdoes. The response
is then not that of `autopilots.response`, and a model that leads the drone by it swings: about a car at a steady 7 m/s
by 3 m. From the drone's own motion on, a plan within the limits is one that the path follows.
"""

import math

import numpy as np

from companion.autopilots.response import STATES, ResponseModel
from companion.landing.steering.flown_plan import extrapolate
from companion.landing.steering.losing import add_loss
from companion.landing.steering.virtual_model import BREAK_S, Tracking, state_then
from companion.planning.guidance import ReferenceState
from link.records import replace

_LOST_CHI2 = 13.8  # of place and velocity: what gusts alone make in one report of a thousand
_STEP_S = 0.02  # between two states of the past, between which it is straight


def has_lost(tracking: Tracking, response: ResponseModel) -> bool:
    """Return whether the drone deviates from the model along an axis by more than gusts make it."""
    return float(np.max(response.chi2(tracking.deviation))) > _LOST_CHI2


def regain(tracking: Tracking, response: ResponseModel, monotonic_ns: int) -> Tracking:
    """Return the tracking with the model at a drone that has lost it, since its newest report; heights stay.

    From that report on the drone goes on as it accelerated then, as far as its lean shows. The result is as given where
    nothing is lost, and where the report is so old that nothing tells how the drone has flown since.

    Args:
        tracking: with the model up to where the newest setpoint leads.
        response: of the autopilot.
        monotonic_ns: now.
    """
    since_ns = tracking.compared_ns
    is_old = since_ns is None or (monotonic_ns - since_ns) * 1e-9 > BREAK_S
    if since_ns is None or is_old or not has_lost(tracking, response):
        return tracking
    drone = _drone(tracking, since_ns)
    until_ns = max(tracking.past[-1][0], since_ns + round(_STEP_S * 1e9))
    count = math.ceil((until_ns - since_ns) * 1e-9 / _STEP_S)
    times_ns = [since_ns + (until_ns - since_ns) * index // count for index in range(count + 1)]
    past = tuple(
        (t_ns, _moved_as(state_then(tracking, t_ns), extrapolate(drone, (t_ns - since_ns) * 1e-9))) for t_ns in times_ns
    )
    deviation = np.zeros((STATES, 2))
    if not response.cascade.is_led:
        deviation[2] = drone.acceleration_enu_m_s2[:2]
    losses = add_loss(tracking.losses, since_ns, drone.velocity_enu_m_s[:2], tracking.deviation[1])
    return replace(tracking, past=past, deviation=deviation, losses=losses)


def _drone(tracking: Tracking, t_ns: int) -> ReferenceState:
    """Return how the drone moves at its newest report, at `t_ns`, at the model's height."""
    model, (place, velocity, *_) = state_then(tracking, t_ns), tracking.deviation
    leans = tracking.holds_enu_m_s2 - tracking.air_enu_m_s2
    return ReferenceState(
        position_enu_m=model.position_enu_m + np.append(place, 0.0),
        velocity_enu_m_s=model.velocity_enu_m_s + np.append(velocity, 0.0),
        acceleration_enu_m_s2=model.acceleration_enu_m_s2 + np.append(leans, 0.0),
    )


def _moved_as(model: ReferenceState, drone: ReferenceState) -> ReferenceState:
    """Return the model with the drone's horizontal motion."""
    return ReferenceState(
        position_enu_m=np.append(drone.position_enu_m[:2], model.position_enu_m[2]),
        velocity_enu_m_s=np.append(drone.velocity_enu_m_s[:2], model.velocity_enu_m_s[2]),
        acceleration_enu_m_s2=np.append(drone.acceleration_enu_m_s2[:2], model.acceleration_enu_m_s2[2]),
    )
