"""The model of how a drone deviates from its path: against scipy's integrator, and as a filter of simulated reports."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from companion.autopilots.response import (
    ATTITUDE_LAG_S,
    DRAG_PER_S,
    POSITION_STD_M,
    PUSH_STD_M_S2,
    REPORT_PERIOD_S,
    STATES,
    VELOCITY_STD_M_S,
    Cascade,
    ResponseModel,
)
from companion.core.data import Array
from link.records import replace

OFFSET_S: Array = np.arange(0.0, 4.01, 0.2)
CASCADES = {
    "ardupilot": Cascade(position_per_s=1.0, velocity_per_s=2.0, integral_per_s2=1.0, lead_s=0.0),
    "px4": Cascade(position_per_s=0.95, velocity_per_s=1.8, integral_per_s2=0.4, lead_s=0.03),
}
STATE: Array = np.array([[0.4, -0.1], [-0.3, 0.2], [-0.2, 0.7], [0.8, -0.5]])


@pytest.fixture(params=sorted(CASCADES))
def model(request: pytest.FixtureRequest) -> ResponseModel:
    return ResponseModel(CASCADES[request.param], OFFSET_S)


def integrated(cascade: Cascade, state: Array, accelerations: Array) -> Array:
    """The module's equations, solved by scipy for one axis: (n, 4)."""

    def rate(t_s: float, x: Array) -> list[float]:
        a = accelerations[min(int(t_s / 0.2 + 1e-9), len(accelerations) - 1)]
        wanted = a - cascade.velocity_per_s * (x[1] + cascade.position_per_s * x[0])
        forgets = x[3] * cascade.integral_per_s2 / cascade.velocity_per_s
        return [x[1], x[2] + x[3] - a, (wanted - x[2]) / ATTITUDE_LAG_S, -forgets - DRAG_PER_S * a]

    solved = solve_ivp(rate, (0.0, 4.0), state, t_eval=OFFSET_S.clip(0.0, 4.0), rtol=1e-9, atol=1e-9, max_step=0.05)
    return np.asarray(solved.y.T)


def test_prediction_solves_the_differential_equation(model: ResponseModel) -> None:
    accelerations = np.column_stack((np.sin(OFFSET_S), np.linspace(3.0, -1.0, len(OFFSET_S))))
    predicted = model.predict(STATE, accelerations)
    for axis in range(2):
        expected = integrated(model.cascade, STATE[:, axis], accelerations[:, axis])
        np.testing.assert_allclose(predicted[:, :, axis], expected, atol=2e-5)


def test_carried_state_is_the_predicted_one(model: ResponseModel) -> None:
    accelerates = np.array([0.8, -0.6])
    expected = model.predict(STATE, np.tile(accelerates, (len(OFFSET_S), 1)))[1]
    np.testing.assert_allclose(model.carry(STATE, accelerates, 0.2), expected, atol=5e-3)


def test_steady_path_makes_no_deviation(model: ResponseModel) -> None:
    assert not model.predict(np.zeros((STATES, 1)), np.zeros((len(OFFSET_S), 1))).any()


def test_a_constant_push_is_unlearnt(model: ResponseModel) -> None:
    pushed = np.array([[0.0], [0.0], [0.0], [1.0]])
    far = np.linalg.matrix_power(model.predict(np.eye(STATES), np.zeros((len(OFFSET_S), STATES)))[-1], 5) @ pushed
    assert np.abs(far).max() < 0.02


DRONES = 20
"""Flown at once, each along an axis of its own, which is quicker than one for as long as all of them together."""
SETTLING = 500
"""Reports after which a drone, and the estimate of it, has forgotten how it began."""


def drones(
    model: ResponseModel, seed: int, duration_s: float, push_std_m_s2: float = PUSH_STD_M_S2
) -> tuple[Array, Array]:
    """Drones that the model describes, in such gusts, and their reports: states (n, 4, k) and (n, 2, k)."""
    random, dt_s = np.random.default_rng(seed), REPORT_PERIOD_S
    forgets_hz = model.cascade.integral_per_s2 / model.cascade.velocity_per_s
    errs = np.array([[POSITION_STD_M], [VELOCITY_STD_M_S]])
    state, states, reports = np.zeros((STATES, DRONES)), [], []
    for _ in range(SETTLING + round(duration_s / DRONES / dt_s)):
        state = model.carry(state, np.zeros(DRONES), dt_s)
        state[3] += random.normal(size=DRONES) * push_std_m_s2 * np.sqrt(2.0 * forgets_hz * dt_s)
        states.append(state.copy())
        reports.append(state[:2] + random.normal(size=(2, DRONES)) * errs)
    return np.array(states), np.array(reports)


def estimated(model: ResponseModel, reports: Array) -> Array:
    """The filter's states (n, 4, k) after each report."""
    state, states = np.zeros((STATES, DRONES)), []
    for report in reports:
        state = model.update(state, report, np.zeros(DRONES), REPORT_PERIOD_S)
        states.append(state)
    return np.array(states)


@pytest.mark.parametrize("push_std_m_s2", [0.0, 0.2, PUSH_STD_M_S2, 1.5])
def test_estimate_errs_by_its_covariance_in_any_gusts(model: ResponseModel, push_std_m_s2: float) -> None:
    truth, reports = drones(model, 1, 200.0, push_std_m_s2)
    error = (estimated(model, reports) - truth)[SETTLING:]
    ratio = error.std(axis=(0, 2)) / np.sqrt(np.diag(model.covariance_in(push_std_m_s2)))
    assert ratio == pytest.approx(np.ones(STATES), abs=0.2)


def test_gain_is_made_for_the_gusts_of_its_covariance(model: ResponseModel) -> None:
    assert np.allclose(model.covariance_in(PUSH_STD_M_S2), model.covariance)
    assert np.all(np.linalg.eigvalsh(model.report_covariance) >= -1e-9)


def test_drone_spreads_as_far_as_the_model_says(model: ResponseModel) -> None:
    truth, _ = drones(model, 2, 2000.0)
    ratio = truth[SETTLING:].std(axis=(0, 2)) / np.sqrt(np.diag(model.spread))
    assert ratio == pytest.approx(np.ones(STATES), abs=0.2)


@pytest.mark.parametrize("dt_s", [0.004, 0.02, 0.1, 0.25])
def test_estimate_that_the_reports_confirm_is_the_prediction(model: ResponseModel, dt_s: float) -> None:
    fine_s = np.arange(0.0, dt_s + 1e-9, dt_s / 50)
    accelerates = np.array([2.0, -0.7])
    way = ResponseModel(model.cascade, fine_s).predict(STATE, np.tile(accelerates, (len(fine_s), 1)))
    state = STATE
    for earlier, later in pairwise(way):
        state = model.update(state, 0.5 * (earlier + later)[:2], accelerates, dt_s / 50)
    np.testing.assert_allclose(state, way[-1], atol=2e-3)


LED = Cascade(
    position_per_s=0.95,
    velocity_per_s=1.8,
    integral_per_s2=0.4,
    lead_s=0.01,
    derivative=0.2,
    attitude_lag_s=0.3,
    is_led=True,
)


def swaying(t_s: float) -> tuple[float, float]:
    """A path's acceleration and jerk, as on a circle of 20 m at 8 m/s."""
    return 3.2 * np.cos(0.4 * t_s), -0.4 * 3.2 * np.sin(0.4 * t_s)


def led(cascade: Cascade, until_s: Array) -> Array:
    """A drone of PX4's own equations, whose lean lags, behind led setpoints; solved by scipy for one axis: (n, 4)."""

    def rate(t_s: float, x: Array) -> list[float]:
        path_m_s2, jerk_m_s3 = swaying(t_s)
        asked = cascade.lead(np.array([path_m_s2]), np.array([jerk_m_s3]))[0]
        wanted = asked - cascade.velocity_per_s * (x[1] + cascade.position_per_s * x[0]) - cascade.derivative * x[2]
        forgets = x[3] * cascade.integral_per_s2 / cascade.velocity_per_s
        pushed = -forgets - DRAG_PER_S * path_m_s2
        return [x[1], x[2] + x[3] - path_m_s2, (wanted - x[2]) / cascade.attitude_lag_s, pushed]

    solved = solve_ivp(rate, (0.0, until_s[-1]), [0.0, 0.0, 3.2, 0.0], t_eval=until_s, rtol=1e-9, atol=1e-9)
    return np.asarray(solved.y.T)


def test_led_setpoints_leave_a_drone_only_the_deviation_that_drag_makes() -> None:
    fine_s = np.arange(0.0, 4.0, 0.02)
    path_m_s2 = np.array([[swaying(float(t_s))[0]] for t_s in fine_s])
    predicted = ResponseModel(LED, fine_s).predict(np.zeros((STATES, 1)), path_m_s2)[:, :, 0]
    flown = led(LED, fine_s)
    np.testing.assert_allclose(predicted[:, :2], flown[:, :2], atol=0.01)
    np.testing.assert_allclose(predicted[:, 2] + path_m_s2[:, 0], flown[:, 2], atol=0.02)


def test_a_lag_that_is_not_led_adds_to_the_deviation() -> None:
    steps = np.full((len(OFFSET_S), 1), 3.0)
    as_it_comes = ResponseModel(replace(LED, is_led=False), OFFSET_S).predict(np.zeros((STATES, 1)), steps)
    ahead = ResponseModel(LED, OFFSET_S).predict(np.zeros((STATES, 1)), steps)
    assert (np.abs(ahead[1:4, 0, 0]) < 0.6 * np.abs(as_it_comes[1:4, 0, 0])).all()
