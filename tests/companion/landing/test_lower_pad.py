"""A pad that is lower than the vehicle says: the descent ends, and says why."""

from dataclasses import dataclass

import pytest

from companion.core.reasons import Reason
from companion.landing.state.step_data import StepOutputs
from companion.situation.phases import Phase
from link.records import replace
from tests.companion.world import CONFIG, GEAR_M, Flight, configured

DESCENT_LIMIT_S = 15.0  # from the alignment's height down, and the hold of the test


@dataclass
class LowerPad(Flight):
    """The deck that holds the drone is `lower_m` below where the estimate has it."""

    lower_m: float = 0.0

    def _fly(self, outputs: StepOutputs) -> None:
        told = self.vehicle
        x_m, y_m, z_m = told.start_enu_m
        self.vehicle = replace(told, start_enu_m=(x_m, y_m, z_m - self.lower_m))
        super()._fly(outputs)
        self.vehicle = told


@pytest.mark.slow
def test_descent_that_touches_nothing_is_broken_off_each_time_until_no_retry_is_left() -> None:
    retries = 2
    flight = LowerPad(lower_m=0.8, config=configured({"abort": {"retries_max": retries}}))
    flight.start_and_reach(Phase.DESCEND)
    for approach in range(retries + 1):
        flight.run_until(Phase.ABORT, limit_s=DESCENT_LIMIT_S)
        assert flight.reason is Reason.NOTHING_TOUCHED
        flight.run_until(Phase.DESCEND if approach < retries else Phase.HOLD)
    assert flight.reason is Reason.NO_RETRY_LEFT


@pytest.mark.slow
def test_pad_that_is_a_hand_lower_is_landed_on() -> None:
    flight = LowerPad(lower_m=0.15)
    flight.start_and_reach(Phase.SECURED)
    assert Phase.ABORT not in flight.history


@pytest.mark.slow
def test_drone_stays_above_the_lower_deck_while_nothing_is_touched() -> None:
    flight = LowerPad(lower_m=1.4)
    flight.start_and_reach(Phase.DESCEND)
    lowest_m = 10.0
    while flight.phase is Phase.DESCEND:
        flight.step()
        told_m = float(flight.vehicle.at(flight.t_ns)[2])
        lowest_m = min(lowest_m, flight.own.position_enu_m[2] - GEAR_M - told_m)
    assert -CONFIG.descent.sink.press_depth_m <= lowest_m < -CONFIG.touchdown.lost.missed_depth_m
