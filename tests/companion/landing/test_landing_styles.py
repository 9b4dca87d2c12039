"""The report's ways: straight at the pad's centre, without estimating the lag, at the heading of the start."""

import numpy as np
import pytest

from companion.config.companion import CompanionConfig
from companion.landing.state.step_data import StepOutputs
from companion.situation.phases import Phase
from link.frames.rotations import yaw_of
from link.records import replace
from tests.companion.world import PAD_HEIGHT_M, STEP_NS, UTC_AHEAD_NS, Flight, configured

DIRECT = configured({"guidance": {"style": "direct"}})


class TrailingFlight(Flight):
    """The drone is 0.3 m behind its setpoint."""

    def _fly(self, outputs: StepOutputs) -> None:
        super()._fly(outputs)
        x, y, z = self.own.position_enu_m
        self.own = replace(self.own, position_enu_m=(x - 0.3, y, z))


@pytest.mark.slow
def test_direct_landing_chases_the_pads_centre_and_nothing_else() -> None:
    flight = Flight(config=DIRECT)
    flight.start_and_reach(Phase.CHASE)
    flight.run(12.0)
    assert flight.phase is Phase.CHASE
    assert flight.memory.model.reference is not None
    wanted = flight.vehicle.at(flight.memory.model.reference_ns + UTC_AHEAD_NS) + np.array(
        [0.0, 0.0, DIRECT.touchdown.gear_height_m]
    )
    assert flight.memory.model.reference.position_enu_m == pytest.approx(wanted, abs=0.05)


def test_staged_chase_keeps_above_the_pad() -> None:
    flight = Flight()
    flight.start_and_reach(Phase.CHASE)
    while flight.phase is Phase.CHASE:
        flight.step()
        assert flight.memory.model.reference is not None
        assert flight.memory.model.reference.position_enu_m[2] > PAD_HEIGHT_M + 1.0


@pytest.mark.slow
@pytest.mark.parametrize("corrects_lag", [True, False])
def test_deviation_from_the_setpoint_is_estimated_only_where_wanted(corrects_lag: bool) -> None:
    flight = TrailingFlight(config=configured({"setpoints": {"corrects_lag": corrects_lag}}, DIRECT))
    flight.start_and_reach(Phase.CHASE)
    flight.run(1.0)
    assert bool(np.any(flight.memory.model.tracking.deviation)) is corrects_lag


@pytest.mark.slow
@pytest.mark.parametrize("follows", [True, False])
def test_heading_of_the_vehicle_is_followed_only_where_wanted(follows: bool) -> None:
    config: CompanionConfig = configured({"setpoints": {"follows_heading": follows}}, DIRECT)
    flight = Flight(config=config)
    start_rad = yaw_of(flight.own.orientation_wxyz)
    flight.start_and_reach(Phase.CHASE)
    flight.run(4.0)
    wanted_rad = flight.vehicle.yaw_rad if follows else start_rad
    assert flight.memory.model.yaw_setpoint_rad == pytest.approx(wanted_rad)


@pytest.mark.slow
@pytest.mark.parametrize("step_ns", [STEP_NS, 2 * STEP_NS, 4 * STEP_NS])
def test_drone_turns_at_its_rate_however_often_steps_are_made(step_ns: int) -> None:
    flight = Flight(config=DIRECT)
    flight.start_and_reach(Phase.CHASE)
    flight.run(4.0)
    assert flight.vehicle.yaw_rad is not None
    flight.vehicle = replace(flight.vehicle, yaw_rad=flight.vehicle.yaw_rad + 2.0)
    before_rad = flight.memory.model.yaw_setpoint_rad
    for _ in range(5):
        flight.t_ns += step_ns - STEP_NS
        flight.step()
    turned_rad = flight.memory.model.yaw_setpoint_rad - before_rad
    assert turned_rad == pytest.approx(5 * step_ns * 1e-9 * DIRECT.setpoints.yaw_rate_max_rad_s)
