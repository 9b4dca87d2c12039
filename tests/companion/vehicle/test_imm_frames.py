"""What is known of two frames that move against each other: laws of the wandering, and whose doubt counts."""

import math

import numpy as np
import pytest

from companion.config.estimation import EstimatorKind, ImmConfig, ReceiversConfig
from companion.core.data import Array, Measurement, Quantity
from companion.vehicle.imm import ImmModel
from companion.vehicle.imm_frames import horizontal_variance_m2, wandering
from companion.vehicle.imm_numbers import Deck, numbers_of
from companion.vehicle.imm_state import OFFSET, ImmState, start_state
from companion.vehicle.imm_swing import SIZE
from link.records import replace
from tests.companion.vehicle.drives import NOMINAL, straight
from tests.companion.vehicle.rides import arrivals, estimator, now_ns

RECEIVERS = ReceiversConfig()
FIX_STD_M = 0.02
PLACED = np.eye(SIZE)[:2]


def _started(std_m: float = FIX_STD_M) -> ImmState:
    place = Measurement(t_ns=0, quantity=Quantity.POSITION, value=np.zeros(3), covariance=std_m**2 * np.eye(3))
    config = ImmConfig()
    return start_state(place, config, numbers_of(config, Deck()))


def _sighting() -> Measurement:
    return Measurement(t_ns=0, quantity=Quantity.PAD, value=np.zeros(3), covariance=0.03**2 * np.eye(3))


def _height_variance_m2(state: ImmState) -> float:
    _, covariances, weights = state.modes
    return float(weights @ covariances[:, 14, 14])


@pytest.mark.parametrize("step_s", [0.1, 0.02])
def test_height_that_was_told_is_doubted_as_a_rate_that_lasts_moves_it(step_s: float) -> None:
    model = ImmModel(config=ImmConfig(), deck=Deck())
    state = model.update(_started(), _sighting())
    assert state is not None
    told, after_s = state.state, 1.0
    later = told
    for _ in range(round(after_s / step_s)):
        later = model.predict(later, step_s)
    grown_m2 = _height_variance_m2(later) - _height_variance_m2(told)
    # Of the integral of a Gauss-Markov rate (Ornstein-Uhlenbeck) of the time constant T: 2 s^2 T (t - T (1 - e^(-t/T)))
    time_s = RECEIVERS.own_height_rate_time_s
    moved_s = math.sqrt(2.0 * time_s * (after_s - time_s * (1.0 - math.exp(-after_s / time_s))))
    assert math.sqrt(grown_m2) == pytest.approx(RECEIVERS.own_height_rate_std_m_s * moved_s, rel=0.1)


def test_height_whose_rate_was_told_goes_no_farther_than_the_rate_lasts() -> None:
    """As after a launch, when the drone has left the pad that its range finder saw; its own height comes back."""
    model = ImmModel(config=ImmConfig(), deck=Deck())
    state, rate_m_s, step_s = _started(), 0.1, 0.1
    for index in range(30):
        seen = replace(_sighting(), value=np.array([0.0, 0.0, rate_m_s * index * step_s]))
        told = model.update(state, seen)
        assert told is not None
        state = model.predict(told.state, step_s)
    left_m = model.describe(state, 0).position_enu_m[2]
    for _ in range(300):
        state = model.predict(state, step_s)
    gone_m = model.describe(state, 0).position_enu_m[2] - left_m
    assert 0.05 < gone_m < 1.2 * rate_m_s * RECEIVERS.own_height_rate_time_s


def test_height_that_was_not_told_for_long_is_doubted_no_more() -> None:
    soon, late, never = (
        wandering(replace(_started(), height_age_s=age_s), RECEIVERS)[2] for age_s in (1.0, 100.0, math.inf)
    )
    assert soon > 5e-4
    assert late < 1e-6
    assert never == 0.0


@pytest.mark.parametrize(("apart_m2", "std_m"), [(0.0, FIX_STD_M), (0.25, 0.5), (math.inf, 1.0)])
def test_place_is_as_good_as_the_fixes_where_the_frames_are_one(apart_m2: float, std_m: float) -> None:
    _, covariances, weights = _started().modes
    assert math.sqrt(horizontal_variance_m2(PLACED, weights, covariances, apart_m2)) == pytest.approx(std_m, rel=0.01)


def test_place_that_sightings_tell_is_as_good_as_they_are_whatever_the_frames() -> None:
    _, covariances, weights = _started().modes
    seen = covariances.copy()
    for place, offset in ((0, 12), (1, 13)):
        seen[:, place, place], seen[:, offset, offset], seen[:, place, offset] = 0.03**2, 0.03**2, 0.0
    assert math.sqrt(horizontal_variance_m2(PLACED, weights, seen, math.inf)) == pytest.approx(0.03)


STEP_M = np.array([2.0, -3.0, 0.7])


def _step(seen_m: Array, told_m: Array, t_s: float) -> Measurement:
    covariance = np.diag([0.06**2] * 3 + [0.0] * 3)
    return Measurement(
        t_ns=now_ns(t_s), quantity=Quantity.FRAME_STEP, value=np.concatenate([seen_m, told_m]), covariance=covariance
    )


def _moved(one: Measurement, after_s: float, seen_m: Array, told_m: Array) -> Measurement:
    """What is measured in a frame that has stepped before."""
    if one.t_ns <= now_ns(after_s) or one.quantity not in {Quantity.PAD, Quantity.POSITION}:
        return one
    return replace(one, value=one.value + (seen_m if one.quantity is Quantity.PAD else told_m))


@pytest.mark.parametrize("told_m", [np.zeros(3), STEP_M], ids=["corrected", "origin"])
@pytest.mark.parametrize("sees", [True, False])
def test_frame_that_steps_takes_what_is_seen_along_and_leaves_what_stands_on_the_ground(
    told_m: Array, sees: bool
) -> None:
    chosen, at_s = estimator(EstimatorKind.IMM), 8.05
    sensors = replace(NOMINAL, frame_offset_m=0.5, pad_rate_hz=30.0 if sees else 0.0)
    still = arrivals(straight(5.0, 20.0), sensors, 3)
    moved = [_moved(one, at_s, STEP_M, told_m) for one in still] + [_step(STEP_M, told_m, at_s)]
    health = chosen.health(chosen.fuse(None, moved))
    assert (sum(health.rejected), health.recoveries, health.moves_to_sightings) == (0, 0, 0)
    for t_ns in (now_ns(8.06), now_ns(8.3), now_ns(12.0)):
        before, now = (
            chosen.estimate(chosen.fuse(None, [one for one in said if one.t_ns <= t_ns]), t_ns)
            for said in (still, moved)
        )
        assert before is not None
        assert now is not None
        shift_m = now.position_enu_m - before.position_enu_m
        np.testing.assert_allclose(shift_m, STEP_M if sees else told_m, atol=0.06)


@pytest.mark.parametrize("kind", [EstimatorKind.LKF, EstimatorKind.LKF_REPORT, EstimatorKind.UKF])
def test_filter_that_knows_fixes_alone_moves_with_the_ground_and_not_with_the_drone(kind: EstimatorKind) -> None:
    chosen, at_s, then_ns = estimator(kind), 8.05, now_ns(8.06)
    said = [one for one in arrivals(straight(5.0, 20.0), NOMINAL, 3) if one.t_ns <= then_ns]
    before = chosen.estimate(chosen.fuse(None, said), then_ns)
    for told_m in (np.zeros(3), STEP_M):
        after = chosen.estimate(chosen.fuse(None, [*said, _step(STEP_M, told_m, at_s)]), then_ns)
        assert before is not None
        assert after is not None
        np.testing.assert_allclose(after.position_enu_m - before.position_enu_m, told_m, atol=1e-6)


def test_frame_that_steps_takes_a_vehicle_along_that_is_only_seen() -> None:
    model = ImmModel(config=ImmConfig(), deck=Deck(), placed_by=Quantity.PAD)
    moved = model.move_frame(model.start(_sighting()), _step(STEP_M, np.zeros(3), 0.0))
    np.testing.assert_allclose(model.describe(moved, 0).position_enu_m, STEP_M)
    assert _offset(moved) == pytest.approx(0.0)


def _offset(state: ImmState) -> float:
    means, _, weights = state.modes
    return float(np.abs((weights @ means)[OFFSET]).max())


def _fix(t_s: float, std_m: float, value: Array) -> Measurement:
    covariance = std_m**2 * np.eye(3)
    return Measurement(t_ns=round(t_s * 1e9), quantity=Quantity.POSITION, value=value, covariance=covariance)


def _driven(state: ImmState, std_m: float, lasts_s: float) -> ImmState:
    """After fixes at 10 Hz of a vehicle that stands where it is, of which the receiver states so much error."""
    model, rng = ImmModel(config=ImmConfig(), deck=Deck()), np.random.default_rng(5)
    for step in range(round(10 * lasts_s)):
        state = model.predict(state, 0.1)
        update = model.update(state, _fix(0.1 * step, std_m, rng.normal(0.0, FIX_STD_M, 3)))
        assert update is not None
        state = update.state
    return state


def _frames_apart(state: ImmState) -> tuple[Array, Array]:
    means, covariances, weights = state.modes
    return weights @ means[:, OFFSET], weights @ covariances[:, OFFSET, OFFSET]


@pytest.mark.parametrize(("coarse_m", "lasts_s"), [(2.5, 0.1), (2.5, 60.0), (1.2, 30.0), (20.0, 6.0)])
def test_a_receiver_that_comes_to_be_corrected_leaves_the_frames_as_apart_as_before_any_fix(
    coarse_m: float, lasts_s: float
) -> None:
    state = _driven(_driven(_started(coarse_m), coarse_m, lasts_s), FIX_STD_M, 3.0)
    mean_m, variance_m2 = _frames_apart(state)
    assert np.abs(mean_m).max() < 0.1
    assert variance_m2 == pytest.approx(np.full(3, RECEIVERS.frame_offset_std_m**2), rel=0.1)
    assert np.abs((state.modes[2] @ state.modes[0])[:2]).max() < 0.05
    assert state.modes[1][:, 15, 15].max() == 0.0  # corrected fixes are dated without an error


def test_an_offset_that_sightings_told_outlasts_an_outage_of_the_corrections() -> None:
    model = ImmModel(config=ImmConfig(), deck=Deck())
    seen = model.update(_started(), replace(_sighting(), value=np.array([0.4, -0.3, 0.1])))
    assert seen is not None
    mean_m, variance_m2 = _frames_apart(_driven(_driven(seen.state, 0.8, 4.0), FIX_STD_M, 2.0))
    assert mean_m[:2] == pytest.approx([0.4, -0.3], abs=0.25)
    assert variance_m2[:2].max() < 0.3 * RECEIVERS.frame_offset_std_m**2


def test_a_slow_error_that_becomes_smaller_without_corrections_ends_nothing() -> None:
    coarse = _driven(_started(2.0), 2.0, 2.0)
    assert (_frames_apart(_driven(coarse, 0.9, 1.0))[1] > 0.9 * _frames_apart(coarse)[1]).all()
