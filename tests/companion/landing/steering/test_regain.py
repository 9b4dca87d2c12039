"""A drone that has lost its model: by how much it does, and where the model goes on."""

import math

import numpy as np

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.core.data import Array, OwnState
from companion.landing.steering.losing import lost_for_s
from companion.landing.steering.regain import has_lost, regain
from companion.landing.steering.virtual_model import Tracking, add_to_past, state_then, update_tracking
from companion.planning.guidance import ReferenceState
from link.records import replace
from tests.companion.world import response_of

RESPONSE = response_of(ArduPilotDriver())
STEP_NS = 20_000_000
LATE_STEPS = 5  # by which reports come late
AHEAD_NS = 100_000_000
REPORTS = 20_000
LEAVES_M_S = 1.5
G = 9.81


def _model(t_ns: int, acceleration_m_s2: float = 0.0, *, since_ns: int = 0, start_m: float = 0.0) -> ReferenceState:
    """A model that accelerates from 5 m/s along x, climbs at 0.2 m/s, and is at `start_m` then."""
    t_s = (t_ns - since_ns) * 1e-9
    return ReferenceState(
        position_enu_m=np.array([start_m + (5.0 + 0.5 * acceleration_m_s2 * t_s) * t_s, 1.0, 4.0 + 0.2e-9 * t_ns]),
        velocity_enu_m_s=np.array([5.0 + acceleration_m_s2 * t_s, 0.0, 0.2]),
        acceleration_enu_m_s2=np.array([acceleration_m_s2, 0.0, 0.0]),
    )


def _own(t_ns: int, place_m: float, speed_m_s: float, acceleration_m_s2: float = 0.0) -> OwnState:
    """A drone that leans by as much as it accelerates along x."""
    half_rad = 0.5 * math.atan(acceleration_m_s2 / G)
    return OwnState(
        t_ns=t_ns,
        position_enu_m=(place_m, 1.0, 4.0),
        velocity_enu_m_s=(speed_m_s, 0.0, 0.2),
        orientation_wxyz=(math.cos(half_rad), 0.0, math.sin(half_rad), 0.0),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
    )


def _followed(steps: int, brakes_m_s2: float = 0.0, after: int = 10**9) -> Tracking:
    """A drone on a steady model, that brakes after so many steps; reports come late, setpoints lead."""
    tracking = Tracking()
    for index in range(1, steps + 1):
        t_ns = index * STEP_NS
        tracking = add_to_past(tracking, t_ns + AHEAD_NS, _model(t_ns + AHEAD_NS))
        reported = index - LATE_STEPS
        if reported * STEP_NS > AHEAD_NS:
            own = _braking(reported * STEP_NS, brakes_m_s2, after * STEP_NS)
            tracking = update_tracking(tracking, reported * STEP_NS, own, RESPONSE, estimates=True)
    return tracking


def _braking(t_ns: int, brakes_m_s2: float, after_ns: int) -> OwnState:
    t_s = max(t_ns - after_ns, 0) * 1e-9
    asked = -brakes_m_s2 if t_s > 0.0 else 0.0
    return _own(t_ns, 5e-9 * t_ns - 0.5 * brakes_m_s2 * t_s**2, 5.0 - brakes_m_s2 * t_s, asked)


def test_gusts_alone_lose_the_model_in_one_report_of_a_thousand() -> None:
    draws = np.random.default_rng(1).multivariate_normal(np.zeros(2), RESPONSE.spread[:2, :2], size=REPORTS)
    lost = [has_lost(Tracking(deviation=_deviation(one)), RESPONSE) for one in draws]
    assert 0.0005 < np.mean(lost) < 0.0015


def _deviation(place_and_velocity: Array) -> Array:
    deviation = np.zeros((4, 2))
    deviation[:2, 1] = place_and_velocity
    return deviation


def test_model_goes_on_from_the_drones_own_motion_at_its_own_height() -> None:
    tracking = _followed(60, brakes_m_s2=4.0, after=30)
    assert has_lost(tracking, RESPONSE)
    since_ns = tracking.compared_ns
    assert since_ns is not None
    regained = regain(tracking, RESPONSE, 60 * STEP_NS)
    np.testing.assert_allclose(regained.deviation, [[0.0, 0.0], [0.0, 0.0], [-4.0, 0.0], [0.0, 0.0]], atol=0.1)
    for later_ns in (0, 50_000_000, 60 * STEP_NS + AHEAD_NS - since_ns):
        own, model = _braking(since_ns + later_ns, 4.0, 30 * STEP_NS), state_then(regained, since_ns + later_ns)
        np.testing.assert_allclose(model.position_enu_m[:2], own.position_enu_m[:2], atol=0.1)
        np.testing.assert_allclose(model.velocity_enu_m_s[:2], own.velocity_enu_m_s[:2], atol=0.25)
        np.testing.assert_allclose(model.position_enu_m[2], _model(since_ns + later_ns).position_enu_m[2])


def test_next_reports_of_a_drone_that_goes_on_deviate_from_it_no_more() -> None:
    tracking = regain(_followed(60, brakes_m_s2=4.0, after=30), RESPONSE, 60 * STEP_NS)
    for index in range(56, 66):
        own = _braking(index * STEP_NS, 4.0, 30 * STEP_NS)
        tracking = update_tracking(tracking, index * STEP_NS, own, RESPONSE, estimates=True)
        assert np.max(np.abs(tracking.deviation[:2])) < 0.15


def test_report_that_is_too_old_moves_nothing() -> None:
    tracking = _followed(60, brakes_m_s2=4.0, after=30)
    assert regain(tracking, RESPONSE, 80 * STEP_NS) is tracking
    assert regain(Tracking(), RESPONSE, 0).compared_ns is None


def test_drone_that_stands_still_loses_its_model_again_and_again() -> None:
    tracking, start_m, lost_s = Tracking(), 0.0, 0.0
    for t_ns in range(STEP_NS, 6_000_000_000, STEP_NS):
        start_m += LEAVES_M_S * STEP_NS * 1e-9
        state = replace(
            _model(0),
            position_enu_m=np.array([start_m, 1.0, 4.0]),
            velocity_enu_m_s=np.array([LEAVES_M_S, 0.0, 0.2]),
        )
        tracking = update_tracking(
            add_to_past(tracking, t_ns, state), t_ns, _own(t_ns, 0.0, 0.0), RESPONSE, estimates=True
        )
        tracking = regain(tracking, RESPONSE, t_ns)
        start_m = float(tracking.past[-1][1].position_enu_m[0])
        lost_s = lost_for_s(tracking.losses, t_ns)
    assert lost_s > 4.0
