from math import hypot, nan

import pytest

from link.mavlink.dialect import Message, mavlink
from tests.sim_autopilot.copter import BRAKE, GUIDED, ardupilot, copter_in_the_air, heartbeat, mode
from tests.sim_autopilot.pilot import Pilot, command, px4
from tests.sim_autopilot.planner import EAST_M, LATITUDE, LONGITUDE, NORTH_M, plan_messages

ACCEPTED, DENIED, UNSUPPORTED, FAILED = 0, 2, 3, 4
REPOSITION, SPEED = mavlink.MAV_CMD_DO_REPOSITION, mavlink.MAV_CMD_DO_CHANGE_SPEED


def reposition(pilot: Pilot, east_m: float, north_m: float, above_home_m: float) -> list[int]:
    x, y = round(LATITUDE + north_m * NORTH_M), round(LONGITUDE + east_m * EAST_M)
    frame = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT
    message = mavlink.MAVLink_command_int_message(
        1, 1, frame, REPOSITION, 0, 0, -1.0, 1.0, 0.0, nan, x, y, above_home_m
    )
    return pilot.acknowledged(message)


@pytest.mark.slow
def test_a_reposition_flies_in_guided_from_any_mode() -> None:
    pilot = copter_in_the_air()
    pilot.acknowledged(mode(BRAKE))
    assert reposition(pilot, 12.0, 16.0, 8.0) == [ACCEPTED]
    assert heartbeat(pilot)[1] == GUIDED
    pilot.run(14.0)
    assert pilot.position == pytest.approx((12.0, 16.0, 8.1), abs=0.3)


def test_a_reposition_of_an_unarmed_drone_only_changes_the_mode() -> None:
    pilot = Pilot(ardupilot())
    assert reposition(pilot, 12.0, 16.0, 8.0) == [ACCEPTED]
    assert heartbeat(pilot)[1] == GUIDED


def _single_item(current: int, east_m: float, north_m: float, above_home_m: float) -> Message:
    """What DroneKit's `simple_goto` sends."""
    return mavlink.MAVLink_mission_item_message(
        1,
        1,
        0,
        mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
        mavlink.MAV_CMD_NAV_WAYPOINT,
        current,
        0,
        *(0.0, 0.0, 0.0, 0.0),
        (LATITUDE + north_m * NORTH_M) * 1e-7,
        (LONGITUDE + east_m * EAST_M) * 1e-7,
        above_home_m,
    )


@pytest.mark.slow
def test_a_single_item_is_flown_to_in_guided_and_refused_in_another_mode() -> None:
    pilot = copter_in_the_air()
    (answer,) = plan_messages(pilot.step(_single_item(2, 12.0, 16.0, 8.0)))
    assert answer.type == mavlink.MAV_MISSION_ACCEPTED
    pilot.run(14.0)
    assert pilot.position == pytest.approx((12.0, 16.0, 8.1), abs=0.5)
    pilot.acknowledged(mode(BRAKE))
    (answer,) = plan_messages(pilot.step(_single_item(2, 0.0, 0.0, 8.0)))
    assert answer.type == mavlink.MAV_MISSION_ERROR


def test_a_single_item_that_changes_the_height_is_accepted_and_px4_knows_none() -> None:
    (answer,) = plan_messages(Pilot(ardupilot()).step(_single_item(3, 0.0, 0.0, 8.0)))
    assert answer.type == mavlink.MAV_MISSION_ACCEPTED
    (answer,) = plan_messages(Pilot(px4()).step(_single_item(2, 0.0, 0.0, 8.0)))
    assert answer.type == mavlink.MAV_MISSION_ERROR


def test_a_speed_holds_as_long_as_guided_does_and_brake_takes_none() -> None:
    pilot = copter_in_the_air()
    assert pilot.acknowledged(command(SPEED, 1.0, 2.0, -1.0)) == [ACCEPTED]
    reposition(pilot, 40.0, 0.0, 10.0)
    pilot.run(6.0)
    assert hypot(*pilot.node.state.velocity_enu_m_s[:2]) == pytest.approx(2.0, abs=0.1)
    pilot.acknowledged(mode(BRAKE))
    assert pilot.acknowledged(command(SPEED, 1.0, 2.0, -1.0)) == [FAILED]


def test_commands_that_it_does_not_have_are_answered_as_arducopter_does() -> None:
    pilot = Pilot(ardupilot())
    answers = {
        mavlink.MAV_CMD_DO_SET_RELAY: ACCEPTED,
        mavlink.MAV_CMD_DO_GRIPPER: FAILED,
        mavlink.MAV_CMD_DO_FOLLOW: DENIED,
        mavlink.MAV_CMD_DO_ORBIT: UNSUPPORTED,
        mavlink.MAV_CMD_INJECT_FAILURE: UNSUPPORTED,
    }
    assert {number: pilot.acknowledged(command(number, 1.0)) for number in answers} == {
        number: [result] for number, result in answers.items()
    }
