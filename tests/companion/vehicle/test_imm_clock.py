"""The vehicle's clock is off, the drone errs about its own place: the estimate learns the one and admits both."""

import math

import numpy as np
import pytest

from companion.config.estimation import EstimatorKind
from companion.core.data import Array, Measurement, Quantity, VehicleEstimate
from link.records import replace
from tests.companion.vehicle.drives import DEGRADED, NOMINAL, Drive, Sensors, circle, straight
from tests.companion.vehicle.rides import arrivals, estimator, now_ns

COARSE = replace(DEGRADED, pad_rate_hz=10.0, pad_delay_s=0.15, frame_offset_m=1.2)
RTK = replace(NOMINAL, pad_rate_hz=30.0, frame_offset_m=0.5)


def stamped(measurement: Measurement, ahead_s: float) -> Measurement:
    """What a vehicle whose clock is ahead stamps; sightings are dated by the drone."""
    if measurement.quantity is Quantity.PAD:
        return measurement
    return replace(measurement, t_ns=measurement.t_ns + round(ahead_s * 1e9))


def estimated(
    truth: Drive, sensors: Sensors, seed: int, *, ahead_s: float, seen_s: float, at_s: float
) -> VehicleEstimate:
    """The vehicle at `at_s` from what came until then, the last sighting at `seen_s`."""
    chosen = estimator(EstimatorKind.IMM)
    memory = chosen.fuse(None, [])
    for measurement in arrivals(truth, sensors, seed):
        is_seen = measurement.quantity is not Quantity.PAD or measurement.t_ns < now_ns(seen_s)
        if is_seen and measurement.t_ns < now_ns(at_s):
            memory = chosen.fuse(memory, [stamped(measurement, ahead_s)])
    estimate = chosen.estimate(memory, now_ns(at_s))
    assert estimate is not None
    return estimate


def horizontal_error(estimate: VehicleEstimate, truth: Drive, at_s: float) -> Array:
    return np.asarray((estimate.position_enu_m - truth.at(at_s)[0])[:2])


def spread_m(estimate: VehicleEstimate) -> float:
    return math.sqrt(float(np.diag(estimate.covariance)[:2].max()))


@pytest.mark.parametrize("ahead_s", [-0.1, 0.07])
def test_clock_is_learnt_in_a_curve_from_sightings_and_stays_learnt(ahead_s: float) -> None:
    truth, at_s = circle(8.0), 15.0
    errors = [
        horizontal_error(estimated(truth, COARSE, seed, ahead_s=ahead_s, seen_s=12.0, at_s=at_s), truth, at_s)
        for seed in (3, 4, 5)
    ]
    unlearnt_m = abs(ahead_s) * 8.0 * 2.0 * math.sin(0.5 * 8.0 / 20.0 * (at_s - 12.0))
    assert np.sqrt(np.mean(np.square(errors))) < 0.4 * unlearnt_m


@pytest.mark.parametrize("seen_s", [10.0, 12.0, 14.0])
def test_between_coarse_fixes_a_place_that_is_no_longer_seen_is_less_sure_every_second(seen_s: float) -> None:
    truth = straight(7.0)
    spreads = [
        spread_m(estimated(truth, COARSE, 6, ahead_s=0.0, seen_s=seen_s, at_s=seen_s + passed))
        for passed in (0.2, 2, 6)
    ]
    assert spreads[0] < 0.15
    assert spreads[1] > math.hypot(spreads[0], 0.1)
    assert spreads[2] > math.hypot(spreads[1], 0.15)


def test_fixes_with_corrections_hold_a_place_that_is_no_longer_seen() -> None:
    truth = straight(7.0)
    after = spread_m(estimated(truth, RTK, 6, ahead_s=0.0, seen_s=10.0, at_s=16.0))
    assert after < 0.1
