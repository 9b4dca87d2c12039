"""A vehicle that turns about its pad, and an antenna that swings out behind it."""

import math

import numpy as np
import pytest

from companion.config.estimation import EstimatorKind
from companion.core.data import Array
from companion.vehicle import imm_forecast as forecasts
from companion.vehicle import imm_kernels as kernels
from companion.vehicle import imm_mixing as mixing
from companion.vehicle import imm_noise as noises
from companion.vehicle import imm_sensors as sensors
from companion.vehicle.imm_swing import OWN_RATE, PITCH, ROLL, SIZE, antenna_swing
from link.frames.rotations import quaternion_from_roll_pitch_yaw, quaternion_from_yaw, rotate
from tests.companion.vehicle.drives import NOMINAL, drive
from tests.companion.vehicle.rides import estimator, ride
from tests.companion.vehicle.test_imm_kernels import (
    HEAVE,
    LEVER,
    MOTION,
    NOISE,
    TAU_S,
    TILT,
    TILT_NOISE,
    a_covariance,
    a_state,
)

PLACE = np.array([0, 1, 8])
TILTED = np.arange(18, 24)
QUIET = np.where(np.isin(np.arange(len(NOISE)), (3, noises.CURVATURE_STD, noises.BEND_LENGTH)), NOISE, 0.0)
CURVE_S, SPEED_M_S, RADIUS_M = 8.0, 8.0, 20.0


def pad_place(x: Array) -> Array:
    c, s = math.cos(x[7]), math.sin(x[7])
    return np.array([x[0] + c * LEVER[0] - s * LEVER[1], x[1] + s * LEVER[0] + c * LEVER[1], x[8] + LEVER[0] * x[9]])


@pytest.mark.parametrize("seed", range(3))
def test_pad_moves_as_if_there_were_no_lever_arm(seed: int) -> None:
    x, P = a_state(seed), a_covariance(seed)
    pad = x.copy()
    pad[PLACE] = pad_place(x)
    bare = np.where(np.isin(np.arange(len(MOTION)), (5, 6, 7, 8)), 0.0, MOTION)
    steps = mixing.steps_of(0.33, MOTION)
    turned, straight = mixing.glide(x, P, steps, QUIET, MOTION)[0], mixing.glide(pad, P, steps, QUIET, bare)[0]
    assert pad_place(turned) == pytest.approx(straight[PLACE], abs=1e-12)
    rest = np.delete(np.arange(SIZE), PLACE)
    assert turned[rest] == pytest.approx(straight[rest], abs=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_shift_to_the_pad_is_linear_in_what_it_does_to_the_covariance(seed: int) -> None:
    x, P = a_state(seed), a_covariance(seed)
    numeric = np.eye(SIZE)
    for i in range(SIZE):
        step = 1e-6 * np.eye(SIZE)[i]
        numeric[PLACE, i] = (pad_place(x + step) - pad_place(x - step)) / 2e-6
    y, S = mixing.shifted(x, P, LEVER, 1.0)
    assert pytest.approx(numeric @ P @ numeric.T, abs=1e-6) == S
    back = mixing.shifted(y, S, LEVER, -1.0)
    assert back[0] == pytest.approx(x, abs=1e-12)
    assert back[1] == pytest.approx(P, abs=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_antenna_s_velocity_is_how_fast_its_place_changes(seed: int) -> None:
    x, P = a_state(seed), a_covariance(seed)
    x[TILTED] = 0.0  # that a swung antenna turns with the vehicle as well is left out
    x[OWN_RATE] = 0.0  # which is the drone's
    at = np.array([x, mixing.glide(x, P, mixing.steps_of(1e-4, MOTION), QUIET, MOTION)[0]])
    position, velocity, _ = forecasts.kinematics(at, MOTION)
    assert (position[1] - position[0]) / 1e-4 == pytest.approx(velocity[0], abs=2e-3)
    assert sensors.antenna_velocity(x, np.zeros(4))[0][:2] == pytest.approx(x[2:4])


@pytest.mark.parametrize("seed", range(3))
def test_what_the_curvature_does_within_a_step_is_that_of_many_small_ones(seed: int) -> None:
    x, noise = a_state(seed), np.where(np.arange(len(NOISE)) == 2, NOISE, QUIET)
    whole = noises.process_noise(x, 0.02, noise, np.zeros((3, 3)), TILT_NOISE)
    kick = whole[6, 6] / 50
    _, F = kernels.advance(x, 0.0004, TAU_S, HEAVE, TILT)
    _, through = kernels.advance(x, 0.0002, TAU_S, HEAVE, TILT)
    parts = np.zeros((SIZE, SIZE))
    for _ in range(50):
        parts += kick * np.outer(through[:, 6], through[:, 6])
        through = F @ through
    scale = np.sqrt(np.diag(parts)[: noises.MOTION])
    error = (whole - parts)[: noises.MOTION, : noises.MOTION] / np.outer(scale, scale)
    assert np.abs(error).max() < 0.05


def test_beginning_of_a_curve_is_followed_as_surely_as_is_stated() -> None:
    truth = drive(14.0, lambda _: SPEED_M_S, lambda t: 1.0 / RADIUS_M if t > CURVE_S else 0.0)
    errors, nees = [], []
    for seed in range(5):
        done = ride(
            estimator(EstimatorKind.IMM), truth, NOMINAL, 300 + seed, from_s=CURVE_S + 0.3, until_s=CURVE_S + 1.5
        )
        for t_s, estimate in zip(done.t_s, done.estimates, strict=True):
            error = (estimate.velocity_enu_m_s - truth.at(t_s)[1])[:2]
            errors.append(error)
            nees.append(error @ np.linalg.solve(estimate.covariance[3:5, 3:5], error))
    assert math.sqrt(float(np.mean(np.square(errors)))) < 0.1
    assert float(np.mean(nees)) < 4.0  # of 2 degrees of freedom, just after a manoeuvre


def test_antenna_s_place_is_that_of_a_stiff_body_less_what_the_pad_rises() -> None:
    x, lever = np.zeros(SIZE), np.array([-13.0, -3.0, -6.5, 6.5])
    x[7], x[ROLL], x[PITCH] = 1.3, 0.05, -0.04
    moved, _ = antenna_swing(x, ROLL, lever)
    antenna, pad = (13.0, 3.0, 13.0), (0.0, 0.0, 6.5)
    leaning, level = quaternion_from_roll_pitch_yaw(0.05, -0.04, 1.3), quaternion_from_yaw(1.3)
    expected = np.array(rotate(leaning, antenna)) - rotate(level, antenna)
    expected[2] -= rotate(leaning, pad)[2] - pad[2]
    assert moved == pytest.approx(expected, abs=15.0 * 0.06**3)
