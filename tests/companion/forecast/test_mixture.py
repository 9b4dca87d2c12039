"""What the vehicle of a sample may be off its estimate: drawn from the models of the estimator, each by its weight."""

import numpy as np
import pytest
from scipy.linalg import solve_continuous_are

from companion.autopilots.response import STATES, ResponseModel
from companion.core.data import Array, Mixture, VehicleEstimate
from companion.forecast.draws import draws
from companion.landing.touchdown.rollout_errors import draw_errors, relearns_hz
from companion.vehicle.pad import FrameOffset
from link.records import replace
from tests.companion.autopilots.test_response import CASCADES, OFFSET_S
from tests.companion.facts import pad_at

CALM, WILD = np.diag([0.02**2] * 3 + [0.05**2] * 6), np.diag([0.02**2] * 3 + [0.05**2] * 3 + [9.0] * 3)
OFF = np.array([0.0] * 6 + [-3.0, 1.0, 0.0])


def _estimate(covariance: Array, mixture: Mixture | None = None) -> VehicleEstimate:
    return VehicleEstimate(
        t_ns=0,
        position_enu_m=np.zeros(3),
        velocity_enu_m_s=np.zeros(3),
        acceleration_enu_m_s2=np.zeros(3),
        covariance=covariance,
        yaw_rad=0.0,
        yaw_rate_rad_s=0.0,
        mixture=mixture,
    )


def _drawn(mixture: Mixture | None, covariance: Array, pad_std_m: float = 0.01) -> Array:
    """Places, velocities and accelerations of the samples, (n, 3, 2)."""
    then = _estimate(covariance, mixture)
    response = ResponseModel(next(iter(CASCADES.values())), OFFSET_S)
    return draw_errors(then, pad_at(std_m=pad_std_m), 0.0, response.covariance, draws()).vehicle


def test_model_that_is_hardly_likely_moves_few_samples_and_leaves_the_others_alone() -> None:
    weight = 0.1
    off = np.stack([np.zeros(9), OFF])
    mixture = Mixture(weight=np.array([1.0 - weight, weight]), off=off, covariance=np.stack([CALM, CALM]))
    drawn = _drawn(mixture, CALM + weight * (1.0 - weight) * np.outer(OFF, OFF))[:, 2]
    moved = np.abs(drawn[:, 0]) > 1.0
    assert moved.mean() == pytest.approx(weight, abs=0.02)
    assert drawn[moved].mean(axis=0) == pytest.approx(OFF[6:8], abs=0.05)
    assert drawn[~moved].std() == pytest.approx(0.05, rel=0.1)


def test_one_model_is_drawn_from_its_covariance() -> None:
    drawn = _drawn(None, WILD)[:, 2]
    assert drawn.std(axis=0) == pytest.approx([3.0, 3.0], rel=0.1)
    one = Mixture(weight=np.ones(1), off=np.zeros((1, 9)), covariance=WILD[None])
    assert _drawn(one, WILD)[:, 2] == pytest.approx(drawn)


def test_models_that_differ_in_place_spread_it_once() -> None:
    off = np.stack([np.zeros(9), np.array([1.0] + [0.0] * 8)])
    off -= 0.5 * off[1]
    mixture = Mixture(weight=np.array([0.5, 0.5]), off=off, covariance=np.stack([CALM, CALM]))
    total = CALM + np.mean([np.outer(one, one) for one in off], axis=0)
    drawn = _drawn(mixture, total, pad_std_m=float(np.sqrt(total[0, 0])))[:, 0]
    assert drawn[:, 0].std() == pytest.approx(np.sqrt(total[0, 0]), rel=0.05)


@pytest.mark.parametrize("jerk_psd_m2_s5", [0.1, 4.0])
def test_error_of_the_velocity_is_learnt_anew_as_fast_as_a_steady_filters_errors_forget(jerk_psd_m2_s5: float) -> None:
    # Kalman and Bucy's filter of velocity and acceleration, which measures the velocity: e' = (A - K C) e + noise, so
    # that the correlation of e with what it was before begins to fall by (A - K C) P.
    motion, seen, noise = np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[1.0, 0.0]]), 0.01
    P = solve_continuous_are(motion.T, seen.T, np.diag([0.0, jerk_psd_m2_s5]), np.array([[noise]]))
    errors = motion - P @ seen.T @ seen / noise
    falls_hz = -float((errors @ P)[0, 0]) / float(P[0, 0])
    covariance = 0.1 * np.eye(9)
    for axis in range(3):
        covariance[np.ix_([3 + axis, 6 + axis], [3 + axis, 6 + axis])] = P
    assert relearns_hz(_estimate(covariance)) == pytest.approx(falls_hz)


def test_velocity_whose_error_has_nothing_to_do_with_the_accelerations_keeps_it() -> None:
    assert relearns_hz(_estimate(CALM)) == 0.0


@pytest.mark.parametrize(("is_confirmed", "std_m"), [(False, 0.1), (True, 0.02)])
def test_frames_that_are_one_are_apart_by_what_receivers_differ_until_sightings_tell(
    *, is_confirmed: bool, std_m: float
) -> None:
    covariance, apart_m = CALM.copy(), 0.5
    covariance[:2, :2] = np.eye(2) * apart_m**2
    pad = replace(pad_at(), frame_offset=FrameOffset(std_m=apart_m, is_confirmed=is_confirmed))
    place = draw_errors(_estimate(covariance), pad, 0.0, np.zeros((STATES, STATES)), draws()).vehicle[:, 0]
    assert place.std(axis=0) == pytest.approx(np.full(2, std_m), rel=0.15)
