import numpy as np
import pytest
from scipy.linalg import solve_discrete_are

from companion.config.estimation import LkfConfig, LkfReportConfig
from companion.core.data import Array, Measurement, Quantity
from companion.vehicle.filter_step import Gaussian
from companion.vehicle.lkf import LkfModel, LkfNoise, ReportNoise, WhiteJerkNoise, transition
from tests.companion.vehicle.rides import now_ns

REPORT = LkfModel(noise=ReportNoise(config=LkfReportConfig()))
WHITE_JERK = LkfModel(noise=WhiteJerkNoise(config=LkfConfig()))
SEEN = np.hstack([np.eye(3), np.zeros((3, 6))])


def fix(t_s: float, value: Array, std_m: float = 0.1) -> Measurement:
    return Measurement(t_ns=now_ns(t_s), quantity=Quantity.POSITION, value=value, covariance=std_m**2 * np.eye(3))


def settled(model: LkfModel, dt_s: float, steps: int) -> Gaussian:
    state = model.start(fix(0.0, np.zeros(3)))
    for i in range(1, steps):
        state = model.predict(state, dt_s)
        update = model.update(state, fix(i * dt_s, np.zeros(3)))
        assert update is not None
        state = update.state
    return state


def steady_covariance(noise: LkfNoise, dt_s: float, R: Array) -> Array:
    P = solve_discrete_are(transition(dt_s).T, SEEN.T, noise.process(dt_s), R)
    K = P @ SEEN.T @ np.linalg.inv(SEEN @ P @ SEEN.T + R)
    return np.asarray((np.eye(9) - K @ SEEN) @ P)


@pytest.mark.slow
@pytest.mark.parametrize(("model", "dt_s"), [(REPORT, 0.01), (WHITE_JERK, 0.1)])
def test_covariance_settles_at_the_solution_of_the_riccati_equation(model: LkfModel, dt_s: float) -> None:
    expected = steady_covariance(model.noise, dt_s, 0.01 * np.eye(3))
    assert settled(model, dt_s, 1500).covariance == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_report_filter_has_the_reports_numbers() -> None:
    start = REPORT.start(fix(0.0, np.array([1.0, 2.0, 3.0]), std_m=0.7))
    assert np.array_equal(start.covariance, 10.0 * np.eye(9))
    assert REPORT.noise.process(0.01) == pytest.approx(0.01 * np.eye(9))
    assert REPORT.noise.sensor(fix(0.0, np.zeros(3), std_m=0.7)) == pytest.approx(0.01 * np.eye(3))


def test_report_filter_takes_positions_only() -> None:
    start = REPORT.start(fix(0.0, np.zeros(3)))
    velocity = Measurement(t_ns=now_ns(0.1), quantity=Quantity.VELOCITY, value=np.ones(3), covariance=np.eye(3))
    assert REPORT.update(start, velocity) is None
    assert WHITE_JERK.update(start, velocity) is not None


def test_uniform_acceleration_without_noise_is_found_exactly() -> None:
    p, v, a = np.array([3.0, -8.0, 1.0]), np.array([4.0, 2.5, 0.0]), np.array([-0.7, 0.4, 0.1])
    state = WHITE_JERK.start(fix(0.0, p, 1e-6))
    for i in range(1, 8):
        t = 0.1 * i
        update = WHITE_JERK.update(WHITE_JERK.predict(state, 0.1), fix(t, p + v * t + 0.5 * a * t**2, 1e-6))
        assert update is not None
        state = update.state
    t = 0.7
    truth = np.concatenate([p + v * t + 0.5 * a * t**2, v + a * t, a])
    assert state.mean == pytest.approx(truth, abs=1e-3)


def test_white_jerk_noise_of_two_steps_is_that_of_one_long_step() -> None:
    Q, F = WHITE_JERK.noise.process(0.3), transition(0.3)
    assert pytest.approx(WHITE_JERK.noise.process(0.6)) == F @ Q @ F.T + Q


def test_forecast_spread_is_that_of_the_filters_own_prediction() -> None:
    state = settled(WHITE_JERK, 0.1, 30)
    forecast = WHITE_JERK.forecast(state, now_ns(3.0), np.array([0.0, 0.7, 2.3]))
    for i, offset_s in enumerate(forecast.offset_s):
        predicted = WHITE_JERK.predict(state, float(offset_s))
        assert forecast.position_std_m[i] == pytest.approx(np.sqrt(predicted.covariance.diagonal()[:3]))
        assert forecast.position_enu_m[i] == pytest.approx(predicted.mean[:3])


def test_report_forecast_spread_is_that_of_its_many_small_steps() -> None:
    state = settled(REPORT, 0.01, 300)
    forecast = REPORT.forecast(state, now_ns(3.0), np.array([1.5]))
    for _ in range(150):
        state = REPORT.predict(state, 0.01)
    assert forecast.position_std_m[0] == pytest.approx(np.sqrt(state.covariance.diagonal()[:3]), rel=0.02)
