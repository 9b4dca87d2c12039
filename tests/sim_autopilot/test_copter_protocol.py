"""What client programs of ArduCopter meet on the wire: how items are asked for, parts of a mission, texts, versions."""

import pytest

from link.mavlink.dialect import mavlink
from tests.sim_autopilot.copter import AUTO, GUIDED, ardupilot, copter_in_the_air, mode
from tests.sim_autopilot.pilot import Pilot, command
from tests.sim_autopilot.planner import download, item, plan_messages, upload

pytestmark = pytest.mark.slow

WAYPOINT, SPEED = mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_CMD_DO_CHANGE_SPEED
NUMBERS = (0.0, 0.0, 0.0, 0.0)
PLACE = (3.0, 5.0, 10.0)
ACCEPTED, DENIED, FAILED, ERROR = 0, 2, 4, 1


def texts(pilot: Pilot) -> list[str]:
    return [message.text for message in pilot.all("STATUSTEXT")]


def waypoints(count: int) -> list[mavlink.MAVLink_message]:
    return [item(index, WAYPOINT, PLACE, NUMBERS) for index in range(count)]


def test_items_are_asked_for_by_mission_request() -> None:
    pilot = Pilot(ardupilot())
    (asked,) = plan_messages(pilot.step(mavlink.MAVLink_mission_count_message(1, 1, 2, 0)))
    assert (asked.get_type(), asked.seq) == ("MISSION_REQUEST", 0)
    (asked,) = plan_messages(pilot.step(item(0, WAYPOINT, PLACE, NUMBERS)))
    assert (asked.get_type(), asked.seq) == ("MISSION_REQUEST", 1)


def test_a_part_of_a_mission_is_written_anew_and_the_rest_stays() -> None:
    pilot = Pilot(ardupilot())
    assert upload(pilot, waypoints(4)) == ACCEPTED
    (asked,) = plan_messages(pilot.step(mavlink.MAVLink_mission_write_partial_list_message(1, 1, 2, 2, 0)))
    assert asked.seq == 2
    (answer,) = plan_messages(pilot.step(item(2, WAYPOINT, (3.0, 5.0, 25.0), NUMBERS)))
    assert answer.type == ACCEPTED
    assert [kept.z for kept in download(pilot)[1:]] == [10.0, 25.0, 10.0]
    (answer,) = plan_messages(pilot.step(mavlink.MAVLink_mission_write_partial_list_message(1, 1, 2, 9, 0)))
    assert answer.type == ERROR


def test_turns_splines_and_climbs_of_a_mission_are_flown_as_the_like_of_them() -> None:
    pilot = copter_in_the_air()
    commands = (WAYPOINT, mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT, mavlink.MAV_CMD_NAV_LOITER_TURNS)
    items = [item(index, number, PLACE, NUMBERS) for index, number in enumerate(commands)]
    items += [item(3, mavlink.MAV_CMD_NAV_LOITER_TO_ALT, (3.0, 5.0, 14.0), NUMBERS)]
    assert upload(pilot, items) == ACCEPTED
    pilot.step(mode(AUTO))
    pilot.run_until(lambda: pilot.position[2] > 13.5, 90.0)


def test_a_mode_without_the_flag_is_denied_and_an_unknown_one_named() -> None:
    pilot = Pilot(ardupilot())
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_MODE, 0.0, float(GUIDED))) == [DENIED]
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, 99.0)) == [FAILED]
    assert texts(pilot) == ["No such mode 99"]
