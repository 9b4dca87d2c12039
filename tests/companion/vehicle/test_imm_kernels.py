import math

import numpy as np
import pytest
from filterpy.kalman import update as filterpy_update
from scipy.integrate import solve_ivp
from scipy.linalg import expm, solve_continuous_lyapunov
from scipy.stats import multivariate_normal

from companion.core.data import Array
from companion.vehicle import imm_forecast as forecasts
from companion.vehicle import imm_judgement as judgement
from companion.vehicle import imm_kernels as kernels
from companion.vehicle import imm_mixing as mixing
from companion.vehicle import imm_noise as noises
from companion.vehicle import imm_sensors as sensors
from companion.vehicle.imm_swing import SIZE, heave_step, smooth_step
from companion.vehicle.small_matrices import correct

TAU_S = 3.0
ROLL, PITCH = (2.0 * math.pi * 1.1, 0.25, 0.03), (2.0 * math.pi * 0.8, 0.15, 0.02)
MOTION = np.array([TAU_S, 2.0 * math.pi * 0.75, 0.3, 0.04, 180.0, -0.7, 0.1, 0.3, 1.4, 5.0, *ROLL, *PITCH, 10.0, 60.0])
NOISE = np.array(
    [12.0, 0.005, 20.0, 3.0, 1e-4, 0.003, 1e-5, 2e-3, 1e-7, 0.1, 0.0, 0.5, 10.0, 1e-5, 0.15, 0.0, 4e-3, 1e-5]
)
LEVER = MOTION[5:9]
HEAVE = np.array([[1.0, 0.097, 0.004], [0.0, 0.91, 0.08], [0.0, -1.7, 0.69]])
TILT = np.array([[[0.85, 0.07], [-3.1, 0.6]], [[0.93, 0.09], [-1.2, 0.8]]])
TILT_NOISE = np.array([[[2e-6, 1e-6], [1e-6, 3e-4]], [[1e-6, 0.0], [0.0, 2e-4]]])


def a_state(seed: int) -> Array:
    rng = np.random.default_rng(seed)
    x = np.zeros(SIZE)
    x[: kernels.LEAK] = rng.standard_normal(kernels.LEAK)
    x[2:4] = rng.uniform(2.0, 9.0, 2)
    x[4:6] = rng.uniform(-1.5, 1.5, 2)
    x[6] = rng.uniform(-0.08, 0.08)
    x[kernels.CLOCK] = rng.uniform(-0.1, 0.1)
    x[9], x[kernels.BEND] = rng.uniform(-0.12, 0.12), rng.uniform(-0.006, 0.006)
    x[kernels.LEAK] = rng.uniform(-1.0, 1.0)
    x[kernels.LEAK + 1 :] = rng.uniform(-0.05, 0.05, SIZE - kernels.LEAK - 1)
    return x


def a_covariance(seed: int, n: int = SIZE) -> Array:
    root = np.random.default_rng(seed).standard_normal((n, n))
    return np.asarray(root @ root.T + 0.1 * np.eye(n))


def motion(_: float, s: Array, curvature: float) -> Array:
    """The module's equations as they stand, with `w = k |v|` at every instant."""
    _, _, vx, vy, bx, by, _ = s
    w = curvature * math.hypot(vx, vy)
    return np.array([vx, vy, bx - w * vy, by + w * vx, -w * by - bx / TAU_S, w * bx - by / TAU_S, w])


@pytest.mark.parametrize("seed", range(4))
def test_motion_solves_its_differential_equation(seed: int) -> None:
    x = a_state(seed)
    after, _ = kernels.advance(x, 0.1, TAU_S, HEAVE, TILT)
    flow = solve_ivp(motion, (0.0, 0.1), [*x[:6], x[7]], args=(x[6],), rtol=1e-10, atol=1e-12).y[:, -1]
    assert after[[0, 1, 2, 3, 4, 5, 7]] == pytest.approx(flow, abs=2e-3)


def test_motion_without_acceleration_is_a_circle_exactly() -> None:
    x = np.zeros(SIZE)
    x[2], x[6] = 8.0, 1.0 / 20.0
    after, _ = kernels.advance(x, 0.5, TAU_S, HEAVE, TILT)
    turned = 8.0 * 0.5 / 20.0
    assert after[:2] == pytest.approx([20.0 * math.sin(turned), 20.0 * (1.0 - math.cos(turned))], abs=1e-12)
    assert after[7] == pytest.approx(turned)


@pytest.mark.parametrize("seed", range(4))
def test_jacobian_is_the_derivative_of_the_motion(seed: int) -> None:
    x = a_state(seed)
    _, F = kernels.advance(x, 0.05, TAU_S, HEAVE, TILT)
    numeric = np.empty((SIZE, SIZE))
    for i in range(SIZE):
        step = 1e-6 * np.eye(SIZE)[i]
        up, down = (kernels.advance(x + side * step, 0.05, TAU_S, HEAVE, TILT)[0] for side in (1.0, -1.0))
        numeric[:, i] = (up - down) / 2e-6
    assert pytest.approx(numeric, abs=2e-3) == F


@pytest.mark.parametrize("kind", range(8))
def test_jacobian_is_the_derivative_of_what_a_sensor_reads(kind: int) -> None:
    x = a_state(7)
    _, H = sensors.observe(kind, x, LEVER, True)
    for i in range(SIZE):
        step = 1e-6 * np.eye(SIZE)[i]
        up, down = sensors.observe(kind, x + step, LEVER, True)[0], sensors.observe(kind, x - step, LEVER, True)[0]
        assert H[:, i] == pytest.approx((up - down) / 2e-6, abs=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_kinematics_jacobian_is_the_derivative_of_the_kinematics(seed: int) -> None:
    x = a_state(seed)
    G = forecasts.kinematics_jacobian(x, MOTION)
    numeric = np.empty((9, SIZE))
    for i in range(SIZE):
        step: Array = 1e-6 * np.outer([1.0, -1.0], np.eye(SIZE)[i])
        around = np.hstack(forecasts.kinematics(x + step, MOTION))
        numeric[:, i] = (around[0] - around[1]) / 2e-6
    assert pytest.approx(numeric, abs=1e-5) == G


def test_braking_stops_where_the_fading_acceleration_stops_it() -> None:
    x = np.zeros(SIZE)
    x[2], x[4] = 0.4, -6.0
    after, _ = kernels.advance(x, 0.1, TAU_S, HEAVE, TILT)
    stop = solve_ivp(
        lambda t, s: [s[1], -6.0 * math.exp(-t / TAU_S)],
        (0.0, 0.1),
        [0.0, 0.4],
        events=_at_standstill,
        rtol=1e-10,
        atol=1e-12,
    )
    assert after[2:6] == pytest.approx(np.zeros(4), abs=1e-12)
    assert stop.y_events is not None
    assert after[0] == pytest.approx(stop.y_events[0][0][0], abs=1e-9)


def test_vehicle_at_rest_whose_heading_is_unknown_is_forecast_as_it_is() -> None:
    state = a_state(3)
    state[2:4] = 0.0
    np.testing.assert_array_equal(forecasts.braked_straight(state, 4.0, 1.0, False), state)


def _at_standstill(_: float, s: Array) -> float:
    return float(s[1])


@pytest.mark.parametrize("seed", range(3))
def test_update_equals_that_of_filterpy(seed: int) -> None:
    rng = np.random.default_rng(seed)
    x, P, R = rng.standard_normal(SIZE), a_covariance(seed), a_covariance(seed + 50, 3)
    H, z = rng.standard_normal((3, SIZE)), rng.standard_normal(3)
    mean, covariance, nis, log_likelihood = correct(x, P, z - H @ x, H, R)
    other_mean, other_covariance, y, _, S, _ = filterpy_update(x, P, z, R, H, return_all=True)
    assert mean == pytest.approx(other_mean)
    assert covariance == pytest.approx(other_covariance)
    assert nis == pytest.approx(y @ np.linalg.solve(S, y))
    assert log_likelihood == pytest.approx(multivariate_normal.logpdf(y, cov=S))


@pytest.mark.parametrize("seed", range(3))
def test_compiled_kernels_equal_their_python(seed: int) -> None:
    x, P = a_state(seed), a_covariance(seed)
    noise = noises.process_noise(x, 0.07, NOISE, 1e-4 * np.eye(3), TILT_NOISE)
    assert noise == pytest.approx(noises.process_noise.py_func(x, 0.07, NOISE, 1e-4 * np.eye(3), TILT_NOISE), rel=1e-12)
    for mine, python in zip(
        kernels.advance(x, 0.07, TAU_S, HEAVE, TILT), kernels.advance.py_func(x, 0.07, TAU_S, HEAVE, TILT), strict=True
    ):
        assert mine == pytest.approx(python, rel=1e-12, abs=1e-14)
    for kind in (*range(6), sensors.TILT):
        for mine, python in zip(
            sensors.observe(kind, x, LEVER, True), sensors.observe.py_func(kind, x, LEVER, True), strict=True
        ):
            assert mine == pytest.approx(python, rel=1e-12)
    steps = mixing.steps_of(0.33, MOTION)
    glided, python_glided = mixing.glide(x, P, steps, NOISE, MOTION), mixing.glide.py_func(x, P, steps, NOISE, MOTION)
    for mine, python in zip(glided, python_glided, strict=True):
        assert mine == pytest.approx(python, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("speed_m_s", [0.0, 2.0, 7.0])
def test_curvature_stays_as_uncertain_as_a_vehicle_can_steer(speed_m_s: float) -> None:
    std, dt_s, x = NOISE[noises.CURVATURE_STD], 0.1, np.zeros(SIZE)
    x[2] = speed_m_s
    left = noises.curvature_left(speed_m_s, dt_s, NOISE)
    fed = noises.process_noise(x, dt_s, NOISE, np.zeros((3, 3)), TILT_NOISE)[6, 6]
    assert left**2 * std**2 + fed == pytest.approx(std**2)
    assert fed > 0.0


def test_heading_of_a_vehicle_at_rest_is_fed_by_no_noise() -> None:
    Q = noises.process_noise(np.zeros(SIZE), 0.1, NOISE, np.zeros((3, 3)), TILT_NOISE)
    assert np.abs(Q[7]).max() == 0.0


def test_process_noise_is_positive_and_lies_along_the_track() -> None:
    x = a_state(3)
    assert np.linalg.eigvalsh(noises.process_noise(x, 0.1, NOISE, 1e-6 * np.eye(3), TILT_NOISE)).min() > -1e-15
    Q = noises.process_noise(x, 0.1, np.where(np.arange(len(NOISE)) == 2, 0.0, NOISE), 1e-6 * np.eye(3), TILT_NOISE)
    along = x[2:4] / np.hypot(*x[2:4])
    across = np.array([-along[1], along[0]])
    assert along @ Q[4:6, 4:6] @ along == pytest.approx(12.0 * 0.1)
    assert across @ Q[4:6, 4:6] @ across == pytest.approx(0.005 * 0.1)


def test_heave_is_a_damped_oscillator_of_the_given_steady_size() -> None:
    w, damping, std = MOTION[1:4]
    A = np.array([[0.0, 1.0], [-(w**2), -2.0 * damping * w]])
    step, noise = heave_step(0.13, w, damping, std)
    assert step == pytest.approx(expm(0.13 * A))
    push = np.diag([0.0, 4.0 * damping * w**3 * std**2])
    steady = solve_continuous_lyapunov(A, -push)
    assert steady == pytest.approx(np.diag([std**2, (std * w) ** 2]))
    assert step @ steady @ step.T + noise == pytest.approx(steady)


@pytest.mark.parametrize("w", [0.6, 4.7, 20.0])
def test_heave_moves_a_place_by_a_rate_that_is_such_an_oscillator(w: float) -> None:
    damping, std_m_s, dt_s = 0.3, 0.2, 0.1
    A = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -(w**2), -2.0 * damping * w]])
    push = np.diag([0.0, 0.0, 4.0 * damping * w**3 * std_m_s**2])
    van_loan = expm(dt_s * np.block([[-A, push], [np.zeros((3, 3)), A.T]]))  # Van Loan 1978
    step, noise = smooth_step(dt_s, w, damping, std_m_s)
    assert step == pytest.approx(van_loan[3:, 3:].T)
    expected = van_loan[3:, 3:].T @ van_loan[:3, 3:]
    scale = np.sqrt(np.diag(expected))
    assert noise / np.outer(scale, scale) == pytest.approx(expected / np.outer(scale, scale), abs=0.025)


def test_switching_is_a_markov_chain_in_continuous_time() -> None:
    begins_after_s = np.array([0.4, 6.0, 2.0])
    rates = np.array([[-2 / 3, 1 / 6, 1 / 2], [2.5, -3.0, 1 / 2], [2.5, 1 / 6, -8 / 3]])  # from row to column, 1/s
    unchanged, begun = mixing.switching(begins_after_s, 0.7)
    assert unchanged * np.eye(3) + begun == pytest.approx(expm(0.7 * rates))


def test_mixing_keeps_mean_and_covariance_of_the_mixture() -> None:
    means, weights = np.stack([a_state(1), a_state(2), a_state(5)]), np.array([0.2, 0.7, 0.1])
    covariances = np.stack([a_covariance(1), a_covariance(2), a_covariance(5)])
    before = mixing.combine(means, covariances, weights)
    switched = mixing.switching(np.array([1.0, 6.0, 2.0]), 0.2)
    after = mixing.combine(*mixing.mix((means, covariances, weights), *switched))
    assert after[0] == pytest.approx(before[0])
    assert after[1] == pytest.approx(before[1])


def test_mode_that_was_ruled_out_comes_back() -> None:
    means = np.stack([a_state(1), a_state(1)])
    means[1, 0] += 5.0
    covariances = np.stack([1e-2 * np.eye(SIZE), 1e-2 * np.eye(SIZE)])
    value = sensors.observe(sensors.POSITION, means[1], LEVER, True)[0]
    modes, reading = (means, covariances, np.array([1.0, 0.0])), (sensors.POSITION, value, 1e-4 * np.eye(3))
    (_, _, weights), nis, gate_nis = judgement.update_modes(modes, reading, LEVER, True)
    assert weights[1] > 0.99
    assert nis > 100.0
    assert gate_nis == pytest.approx(0.0, abs=1e-9)
