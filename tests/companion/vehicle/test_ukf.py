import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from companion.config.estimation import LkfConfig, UkfConfig
from companion.core.data import Array, Measurement, Quantity
from companion.vehicle.filter_step import Gaussian
from companion.vehicle.ukf import Car, UkfModel
from companion.vehicle.ukf_motion import drive, drive_all, kinematics, process_noise
from tests.companion.vehicle.rides import now_ns

MODEL = UkfModel(config=UkfConfig(), point_config=LkfConfig())
DECAY_S = 3.0


def motion(t: float, s: Array, acceleration: float, curvature: float) -> list[float]:
    _, _, heading, speed = s
    return [
        speed * math.cos(heading),
        speed * math.sin(heading),
        curvature * speed,
        acceleration * math.exp(-t / DECAY_S),
    ]


@pytest.mark.parametrize("seed", range(4))
def test_motion_solves_its_differential_equation(seed: int) -> None:
    rng = np.random.default_rng(seed)
    state = np.array(
        [1.0, -2.0, rng.uniform(-3, 3), rng.uniform(3, 9), rng.uniform(-1, 1), rng.uniform(-0.1, 0.1), 0, 0]
    )
    after = drive(state, 1.3, DECAY_S)
    flow = solve_ivp(motion, (0.0, 1.3), state[:4], args=(state[4], state[5]), rtol=1e-10, atol=1e-12).y[:, -1]
    assert after[:4] == pytest.approx(flow, abs=1e-7)


@pytest.mark.parametrize(("speed", "acceleration"), [(4.0, -6.0), (-4.0, 6.0)])
def test_brake_ends_at_standstill_in_either_direction(speed: float, acceleration: float) -> None:
    state = np.array([0.0, 0.0, 0.7, speed, acceleration, 0.03, 0.0, 0.0])
    late, later = drive(state, 2.0, DECAY_S), drive(state, 9.0, DECAY_S)
    assert late == pytest.approx(later)
    assert late[3:5] == pytest.approx([0.0, 0.0])


def test_motion_is_compiled_from_the_python_that_is_read() -> None:
    states = np.array([[1.0, 2.0, 0.3, 7.0, -0.4, 0.05, 1.0, 0.1], [0.0, 1.0, 2.3, 3.0, -6.0, -0.02, 0.0, 0.0]])
    python = np.array([[drive.py_func(state, t, DECAY_S) for state in states] for t in (0.2, 1.7)])
    assert drive_all(states, np.array([0.2, 1.7]), DECAY_S) == pytest.approx(python, rel=1e-12)


def test_acceleration_is_the_derivative_of_velocity_along_the_motion() -> None:
    state = np.array([0.0, 0.0, 0.4, 6.0, 0.8, 0.06, 0.0, 0.0])
    around = kinematics(np.stack([drive(state, 0.001, DECAY_S), state]))
    assert (around[0, 3:6] - around[1, 3:6]) / 0.001 == pytest.approx(around[1, 6:], abs=2e-3)


def test_process_noise_at_rest_leaves_the_heading_alone() -> None:
    psd = np.array([5.0, 3.0, 3.0, 1e-4, 0.3])
    state = np.array([0.0, 0.0, 0.4, 0.0, 0.0, 0.06, 0.0, 0.0])
    Q = process_noise(state, 0.1, psd)
    assert Q[2, 2] == 0.0
    assert np.linalg.eigvalsh(Q).min() > -1e-15


def test_steps_do_not_depend_on_what_the_filter_did_before() -> None:
    car = Car(mean=np.array([1.0, 2.0, 0.3, 7.0, -0.4, 0.05, 1.0, 0.1]), covariance=0.1 * np.eye(8))
    other = Car(mean=np.full(8, 0.2), covariance=0.3 * np.eye(8))
    first = MODEL.predict(car, 0.13)
    MODEL.predict(other, 0.07)
    second = MODEL.predict(car, 0.13)
    assert np.array_equal(first.mean, second.mean)
    assert np.array_equal(first.covariance, second.covariance)


def test_heading_is_fused_the_short_way_round() -> None:
    car = Car(mean=np.array([0.0, 0.0, 3.1, 5.0, 0.0, 0.0, 0.0, 0.0]), covariance=0.01 * np.eye(8))
    measured = Measurement(
        t_ns=now_ns(0.0), quantity=Quantity.HEADING, value=np.array([-3.1]), covariance=0.01 * np.eye(1)
    )
    update = MODEL.update(car, measured)
    assert update is not None
    assert update.state.mean[2] == pytest.approx(3.1 + 0.5 * (math.tau - 6.2))


def test_point_becomes_a_car_when_its_course_is_known() -> None:
    fix = Measurement(
        t_ns=now_ns(0.0), quantity=Quantity.POSITION, value=np.array([4.0, 1.0, 2.0]), covariance=1e-4 * np.eye(3)
    )
    point = MODEL.start(fix)
    assert isinstance(point, Gaussian)
    velocity = Measurement(
        t_ns=now_ns(0.0), quantity=Quantity.VELOCITY, value=np.array([-3.0, 4.0, 0.1]), covariance=1e-4 * np.eye(3)
    )
    update = MODEL.update(point, velocity)
    assert update is not None
    assert isinstance(update.state, Car)
    assert update.state.mean[[2, 3]] == pytest.approx([math.atan2(4.0, -3.0), 5.0], abs=1e-3)
