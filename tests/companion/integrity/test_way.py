"""A fix is elsewhere on the vehicle's way by its stamp, beside it by its receiver, and as expected by a slow link."""

import math

import numpy as np
import pytest

from companion.config.estimation import EstimatorConfig, EstimatorKind
from companion.core.data import Quantity
from companion.integrity.way import WayError, way_error
from companion.situation.phases import Phase
from companion.vehicle.estimator import Estimator
from link.records import replace
from scenarios.catalogue.catalogue import load_scenario
from scenarios.faults.flight import FaultFlight
from tests.companion.vehicle.drives import NOMINAL, drive
from tests.companion.vehicle.rides import arrivals, estimator, now_ns

SPEED_M_S = 8.0
ALIGNED_S = 8.0


def error_of(stamp_off_s: float = 0.0, north_m: float = 0.0, speed_m_s: float = SPEED_M_S) -> WayError | None:
    """Of the first fix after `ALIGNED_S` whose stamp is off, or that is off itself."""
    chosen: Estimator = estimator(EstimatorKind.IMM, EstimatorConfig())
    sent = arrivals(drive(14.0, lambda _: speed_m_s, lambda _: 0.0), NOMINAL, 3)
    known = chosen.fuse(None, [one for one in sent if one.t_ns < now_ns(ALIGNED_S)])
    fix = next(one for one in sent if one.quantity is Quantity.POSITION and one.t_ns >= now_ns(ALIGNED_S))
    moved = replace(fix, t_ns=fix.t_ns + round(stamp_off_s * 1e9), value=fix.value + np.array([0.0, north_m, 0.0]))
    return way_error(chosen, known, [moved])


@pytest.mark.parametrize("stamp_off_s", [-0.076, 0.0, 0.13])
def test_stamp_that_is_late_puts_the_vehicle_behind_on_its_way(stamp_off_s: float) -> None:
    error = error_of(stamp_off_s)
    assert error is not None
    assert error.ahead_s == pytest.approx(-stamp_off_s, abs=0.01)
    assert error.across_m < 0.1
    assert error.speed_m_s == pytest.approx(SPEED_M_S, abs=0.2)


def test_receiver_that_steps_puts_it_beside() -> None:
    error = error_of(north_m=0.7)
    assert error is not None
    assert math.hypot(error.across_m, error.ahead_s * error.speed_m_s) == pytest.approx(0.7, abs=0.1)


def test_vehicle_that_stands_and_fixes_that_are_not_new_tell_nothing() -> None:
    assert error_of(speed_m_s=0.1) is None
    assert error_of(stamp_off_s=-3.0) is None


@pytest.mark.slow
@pytest.mark.parametrize(("back_after_s", "is_off"), [(0.5, False), (3.0, False), (math.inf, True)])
def test_stamps_that_step_and_go_back_leave_both_receivers_in_one_frame(back_after_s: float, *, is_off: bool) -> None:
    flight = FaultFlight(load_scenario("straight_10"), 1)
    flight.fly_to(Phase.CHASE)
    flight.set_vehicle_clock(-0.076, 0.0)
    flight.fly(min(back_after_s, 4.0))
    if math.isfinite(back_after_s):
        flight.set_vehicle_clock(0.076, 0.0)
        flight.fly(0.5)
    phases = flight.companion.memory.vehicle.phases
    assert (phases.stamps_off_s != 0.0) is is_off
    assert not phases.has_vehicle_stepped
