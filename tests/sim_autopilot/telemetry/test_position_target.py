"""What ArduCopter tells that it flies to: GUIDED's setpoint as it was sent, carried on since (mode_guided.cpp)."""

import pytest

from link.mavlink.dialect import Message, mavlink
from tests.sim_autopilot.copter import BRAKE, GUIDED, copter_in_the_air, every, mode
from tests.sim_autopilot.pilot import Pilot

pytestmark = pytest.mark.slow

ALL_BUT_YAW = 0b1100_0000_0000
NO_POSITION = 0b0000_0000_0000_0111
TIMEOUT_S = 3.0  # GUID_TIMEOUT by default


def told(pilot: Pilot) -> Message:
    return pilot.last("POSITION_TARGET_LOCAL_NED")


def sent() -> Pilot:
    """One that was sent a single setpoint 0.1 s ago, and tells of it 50 times a second."""
    pilot = copter_in_the_air()
    pilot.step(every(mavlink.MAVLINK_MSG_ID_POSITION_TARGET_LOCAL_NED, 50.0))
    values = (3.0, -2.0, -10.0, 1.5, 0.5, -0.2, 0.4, -0.3, 0.25)
    pilot.step(mavlink.MAVLink_set_position_target_local_ned_message(0, 1, 1, 1, ALL_BUT_YAW, *values, 0.0, 0.0))
    pilot.run(0.1)
    return pilot


def test_position_and_velocity_are_carried_on_and_the_acceleration_is_as_it_was_sent() -> None:
    message = told(sent())
    assert message.type_mask == ALL_BUT_YAW
    assert (message.afx, message.afy, message.afz) == pytest.approx((0.4, -0.3, 0.25), abs=1e-6)
    assert (message.vx, message.vy, message.vz) == pytest.approx((1.54, 0.47, -0.175), abs=0.01)
    assert (message.x, message.y, message.z) == pytest.approx((3.152, -1.951, -10.019), abs=0.05)


def test_after_the_time_out_it_flies_to_where_that_has_come_and_stands_still() -> None:
    pilot = sent()
    pilot.run(TIMEOUT_S + 0.5)
    message = told(pilot)
    assert (message.vx, message.vy, message.vz, message.afx, message.afy, message.afz) == (0.0,) * 6
    assert message.x == pytest.approx(3.0 + 1.5 * TIMEOUT_S + 0.5 * 0.4 * TIMEOUT_S**2, abs=0.1)


def test_one_that_was_told_to_stop_names_no_place_and_in_another_mode_nothing_is_told() -> None:
    pilot = sent()
    pilot.step(mode(BRAKE))
    pilot.run(0.1)
    count = len(pilot.all("POSITION_TARGET_LOCAL_NED"))
    pilot.run(0.5)
    assert len(pilot.all("POSITION_TARGET_LOCAL_NED")) == count
    pilot.step(mode(GUIDED))
    pilot.run(0.1)
    assert told(pilot).type_mask == ALL_BUT_YAW | NO_POSITION
