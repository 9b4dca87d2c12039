"""Fixes that go on elsewhere: the filter follows them, and tells that it did and by how much."""

import numpy as np
import pytest

from companion.config.estimation import EstimatorConfig, EstimatorKind
from companion.core.data import Measurement, Quantity
from companion.vehicle.estimator import BufferHealth, Estimator
from link.records import replace
from tests.companion.vehicle.drives import NOMINAL, drive, straight
from tests.companion.vehicle.rides import arrivals, estimator, now_ns

BEGINS_S = 8.0


def moved(one: Measurement, by_m: float) -> Measurement:
    """A fix that is off to the north from a moment on."""
    if one.quantity is not Quantity.POSITION or one.t_ns < now_ns(BEGINS_S):
        return one
    return replace(one, value=one.value + np.array([0.0, by_m, 0.0]))


def health_after(by_m: float, *, silent_s: float = 0.0) -> BufferHealth:
    chosen: Estimator = estimator(EstimatorKind.IMM, EstimatorConfig())
    sent = [
        moved(one, by_m)
        for one in arrivals(straight(8.0), NOMINAL, 3)
        if not BEGINS_S <= (one.t_ns - now_ns(0.0)) * 1e-9 < BEGINS_S + silent_s
    ]
    return chosen.health(chosen.fuse(None, sent))


@pytest.mark.parametrize("by_m", [0.5, 1.4, -4.2])
def test_fixes_that_go_on_elsewhere_are_one_step_of_the_place(by_m: float) -> None:
    count, moved_m = health_after(by_m).place_step
    assert count == 1
    assert moved_m == pytest.approx(abs(by_m), rel=0.1)


def test_fixes_that_go_on_as_expected_are_none() -> None:
    assert health_after(0.0).place_step == (0, 0.0)


def test_vehicle_that_leaves_at_once_has_not_stepped() -> None:
    leaves = drive(14.0, lambda t_s: 5.0 if t_s > BEGINS_S else 0.0, lambda _: 0.0)
    chosen: Estimator = estimator(EstimatorKind.IMM, EstimatorConfig())
    health = chosen.health(chosen.fuse(None, arrivals(leaves, NOMINAL, 3)))
    assert health.recoveries > 0
    assert health.place_step == (0, 0.0)


def test_what_happened_in_a_silence_is_none() -> None:
    assert health_after(30.0, silent_s=3.0).place_step == (0, 0.0)
