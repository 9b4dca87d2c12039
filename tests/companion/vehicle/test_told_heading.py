"""A unit whose heading is off alike for long: nobody believes it better than that, and the course tells by how much."""

import math

import numpy as np
import pytest
from scipy import stats

from companion.config.estimation import EstimatorKind, ImmConfig
from companion.core.data import Array, Measurement, Quantity
from companion.vehicle.imm import ImmModel
from companion.vehicle.imm_body import opened_unit
from companion.vehicle.imm_mixing import combine
from companion.vehicle.imm_state import ImmState
from companion.vehicle.imm_swing import UNIT_HEADING
from link.records import replace
from tests.companion.vehicle.drives import NOMINAL, Drive, circle, straight
from tests.companion.vehicle.rides import estimator, now_ns, ride

IMM = EstimatorKind.IMM
SEEN = replace(NOMINAL, heading_std_rad=0.01, pad_rate_hz=10.0, pad_std_m=0.02, frame_offset_m=0.3)
SEEDS = range(8)


def heading(t_s: float, std_rad: float) -> Measurement:
    return Measurement(
        t_ns=now_ns(t_s), quantity=Quantity.HEADING, value=np.array([0.3]), covariance=std_rad**2 * np.eye(1)
    )


def after_a_place() -> ImmState:
    place = Measurement(t_ns=now_ns(0.0), quantity=Quantity.POSITION, value=np.zeros(3), covariance=1e-4 * np.eye(3))
    return ImmModel(config=ImmConfig()).start(place)


def variance_of(state: ImmState, index: int) -> float:
    return float(combine(*state.modes)[1][index, index])


@pytest.mark.parametrize("truth", [straight(8.0), circle()], ids=["straight", "circle"])
@pytest.mark.parametrize("bias_rad", [-0.1, 0.05])
def test_antenna_beside_a_seen_pad_is_known_as_well_as_is_said_though_the_unit_is_turned(
    truth: Drive, bias_rad: float
) -> None:
    nees = []
    for seed in SEEDS:
        done = ride(estimator(IMM), truth, replace(SEEN, heading_bias_rad=bias_rad), seed, from_s=12.0, until_s=12.1)
        error: Array = done.errors(truth)[0][:2]
        nees.append(float(error @ np.linalg.solve(done.estimates[0].covariance[:2, :2], error)))
    assert np.mean(nees) < stats.chi2.ppf(0.975, 2 * len(nees)) / len(nees)


def test_course_shows_that_the_unit_is_turned() -> None:
    truth, bias_rad = straight(8.0), 0.1
    done = ride(estimator(IMM), truth, replace(SEEN, heading_bias_rad=bias_rad), 0, from_s=15.0, until_s=15.1)
    yaw_rad = done.estimates[0].yaw_rad
    assert yaw_rad is not None
    assert abs(yaw_rad - truth.at(15.0)[2]) < 0.4 * bias_rad


def test_standing_vehicle_points_as_vaguely_as_its_unit_says() -> None:
    chosen = estimator(IMM)
    bias_rad = 0.05
    done = ride(chosen, straight(0.0), replace(SEEN, heading_bias_rad=bias_rad), 0, from_s=15.0, until_s=15.1)
    forecast = chosen.forecast(done.memory, now_ns(15.0), np.array([0.0]))
    assert forecast is not None
    assert forecast.yaw_std_rad is not None
    assert forecast.yaw_std_rad > 0.8 * bias_rad


@pytest.mark.parametrize("stated_rad", [0.1, 0.01])
def test_unit_that_comes_to_state_something_else_is_another_one(stated_rad: float) -> None:
    state = after_a_place()
    assert variance_of(state, UNIT_HEADING) == 0.0
    once = opened_unit(state, heading(0.0, 0.05))
    assert variance_of(once, UNIT_HEADING) == pytest.approx(0.05**2)
    assert variance_of(opened_unit(once, heading(0.1, stated_rad)), UNIT_HEADING) == pytest.approx(stated_rad**2)


def test_scatter_of_what_a_unit_states_opens_nothing() -> None:
    """Half as much more in turns, which for each would add a half to the variance."""
    chosen = ImmModel(config=ImmConfig())
    state = after_a_place()
    for i in range(200):
        update = chosen.update(chosen.predict(state, 0.02), heading(0.02 * i, 0.05 if i % 2 else 0.075))
        assert update is not None
        state = update.state
        assert variance_of(state, UNIT_HEADING) <= 0.075**2


def test_error_of_a_unit_stays_as_large_as_it_says_while_nothing_tells_it() -> None:
    model, state = ImmModel(config=ImmConfig()), opened_unit(after_a_place(), heading(0.0, 0.05))
    for _ in range(600):
        state = model.predict(state, 0.1)
    assert math.sqrt(variance_of(state, UNIT_HEADING)) == pytest.approx(0.05, rel=0.01)
