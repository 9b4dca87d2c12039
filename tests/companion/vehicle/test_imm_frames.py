"""What is known of two frames that move against each other: laws of the wandering, and whose doubt counts."""

import math

import numpy as np
import pytest

from companion.config.estimation import ImmConfig, ReceiversConfig
from companion.core.data import Measurement, Quantity
from companion.vehicle.imm import ImmModel
from companion.vehicle.imm_frames import horizontal_variance_m2, wandering
from companion.vehicle.imm_numbers import Deck, numbers_of
from companion.vehicle.imm_state import ImmState, start_state
from companion.vehicle.imm_swing import SIZE
from link.records import replace

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
    assert math.sqrt(grown_m2) == pytest.approx(RECEIVERS.own_height_rate_std_m_s * after_s, rel=0.1)


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
