"""Receivers without a common frame: what one look at the pad teaches, and how it ages between fine fixes."""

import math

import numpy as np
import pytest

from companion.config.estimation import EstimatorConfig, EstimatorKind
from companion.core.data import Measurement, Quantity
from companion.vehicle.imm import ImmModel
from companion.vehicle.imm_state import OFFSET, ImmState
from link.records import replace
from tests.companion.vehicle.drives import NOMINAL, straight
from tests.companion.vehicle.rides import arrivals, estimator, now_ns

FINE_STD_M = 0.08
STANDS_STD_M = 0.1
APART = replace(NOMINAL, frame_offset_m=0.5)
MODEL = ImmModel(config=EstimatorConfig().imm)


def place_of(quantity: Quantity, std_m: float) -> Measurement:
    return Measurement(t_ns=now_ns(0.0), quantity=quantity, value=np.zeros(3), covariance=std_m**2 * np.eye(3))


def offset_std_m(state: ImmState) -> float:
    return math.sqrt(float(state.modes[1][0, OFFSET[0], OFFSET[0]]))


def seen(quantity: Quantity = Quantity.PAD) -> ImmState:
    """The filter after a fix and, by default, one look at the pad."""
    state = MODEL.start(place_of(Quantity.POSITION, FINE_STD_M))
    if quantity is Quantity.POSITION:
        return state
    update = MODEL.update(state, place_of(quantity, STANDS_STD_M))
    assert update is not None
    return update.state


def after(state: ImmState, time_s: float) -> ImmState:
    for _ in range(round(time_s)):
        state = MODEL.predict(state, 1.0)
    return state


@pytest.mark.parametrize("time_s", [10.0, 60.0, 600.0])
def test_frames_wander_apart_by_what_two_gauss_markov_errors_change(time_s: float) -> None:
    receivers, before = MODEL.config.receivers, seen()
    walk_m2 = receivers.frame_offset_walk_m2_s * time_s
    changed_m2 = 4.0 * FINE_STD_M**2 * (1.0 - math.exp(-time_s / receivers.fix_bias_time_s))
    expected_m = math.sqrt(offset_std_m(before) ** 2 + walk_m2 + changed_m2)
    assert offset_std_m(after(before, time_s)) == pytest.approx(expected_m, rel=0.02)


def test_frames_that_were_never_compared_are_as_far_apart_as_they_may_be_from_the_start() -> None:
    before = seen(Quantity.POSITION)
    walk_m2 = MODEL.config.receivers.frame_offset_walk_m2_s * 60.0
    assert offset_std_m(after(before, 60.0)) ** 2 == pytest.approx(offset_std_m(before) ** 2 + walk_m2, rel=1e-6)


def test_one_look_places_the_vehicle_in_the_drones_frame_for_as_long_as_both_frames_stay() -> None:
    truth, chosen, at_s = straight(5.0, 40.0), estimator(EstimatorKind.IMM), 5.0
    look = Measurement(
        t_ns=now_ns(at_s), quantity=Quantity.PAD, value=truth.pad_at(at_s), covariance=STANDS_STD_M**2 * np.eye(3)
    )
    off_m = {}
    for name, extra in (("never", []), ("once", [look])):
        memory = chosen.fuse(None, [])
        for measurement in sorted([*arrivals(truth, APART, 3), *extra], key=lambda one: one.t_ns):
            memory = chosen.fuse(memory, [measurement])
        estimate = chosen.estimate(memory, now_ns(40.0))
        assert estimate is not None
        off_m[name] = math.hypot(*(estimate.position_enu_m - truth.at(40.0)[0])[:2].tolist())
    assert off_m["never"] == pytest.approx(0.5, abs=0.1)
    assert off_m["once"] < 0.05
