"""What client programs of ArduCopter meet on the wire: how items are asked for, parts of a mission, texts, versions."""

import pytest

from link.mavlink.dialect import mavlink
from tests.sim_autopilot.copter import AUTO, GUIDED, ardupilot, copter_in_the_air, mode
from tests.sim_autopilot.pilot import Pilot, command
from tests.sim_autopilot.planner import download, item, plan_messages, upload

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


def test_a_mission_is_told_as_it_comes_and_as_it_is_flown() -> None:
    pilot = copter_in_the_air()
    speed = item(2, SPEED, PLACE, (1.0, 3.0, 0.0, 0.0))
    assert upload(pilot, [*waypoints(2), speed, item(3, WAYPOINT, (3.0, 9.0, 10.0), NUMBERS)]) == ACCEPTED
    pilot.received.clear()
    pilot.step(mode(AUTO))
    pilot.run_until(lambda: "Reached command #3" in texts(pilot), 60.0)
    told = ["Mission: 1 WP", "Reached command #1", "Mission: 2 ChangeSpeed", "Mission: 3 WP", "Reached command #3"]
    assert texts(pilot) == told


def test_an_uploaded_mission_is_acknowledged_in_words_and_told_without_home() -> None:
    pilot = Pilot(ardupilot())
    upload(pilot, waypoints(3))
    assert "Flight plan received" in texts(pilot)
    assert pilot.last("MISSION_CURRENT").total == 2


def test_turns_splines_and_climbs_of_a_mission_are_flown_as_the_like_of_them() -> None:
    pilot = copter_in_the_air()
    commands = (WAYPOINT, mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT, mavlink.MAV_CMD_NAV_LOITER_TURNS)
    items = [item(index, number, PLACE, NUMBERS) for index, number in enumerate(commands)]
    items += [item(3, mavlink.MAV_CMD_NAV_LOITER_TO_ALT, (3.0, 5.0, 14.0), NUMBERS)]
    assert upload(pilot, items) == ACCEPTED
    pilot.step(mode(AUTO))
    pilot.run_until(lambda: pilot.position[2] > 13.5, 90.0)


def test_commands_for_every_system_are_answered() -> None:
    ask = command(mavlink.MAV_CMD_REQUEST_MESSAGE, float(mavlink.MAVLINK_MSG_ID_ATTITUDE), system=0)
    assert Pilot(ardupilot()).acknowledged(ask) == [ACCEPTED]


def test_a_banner_follows_the_request_for_all_parameters() -> None:
    pilot = Pilot(ardupilot())
    pilot.step(mavlink.MAVLink_param_request_list_message(1, 1))
    assert texts(pilot)[:1] == ["ArduCopter V4.6.0-dev (c86c3a57)"]
    assert texts(pilot)[-1] == "Frame: QUAD/PLUS"


def test_the_version_tells_the_commit_and_the_board() -> None:
    pilot = Pilot(ardupilot())
    pilot.acknowledged(command(mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES, 1.0))
    version = pilot.last("AUTOPILOT_VERSION")
    assert bytes(version.flight_custom_version) == b"c86c3a57"
    assert bytes(version.uid2[:17]) == b"8d1219c7c4c5404aa"


@pytest.mark.parametrize("kind", [mavlink.MAV_CMD_REQUEST_MESSAGE, mavlink.MAV_CMD_SET_MESSAGE_INTERVAL])
def test_a_message_that_it_has_nothing_to_tell_in_is_accepted(kind: int) -> None:
    pilot = Pilot(ardupilot())
    assert pilot.acknowledged(command(kind, float(mavlink.MAVLINK_MSG_ID_ADSB_VEHICLE), 1e6)) == [ACCEPTED]
    pilot.run(2.0)
    assert not pilot.all("ADSB_VEHICLE")


def test_a_mode_without_the_flag_is_denied_and_an_unknown_one_named() -> None:
    pilot = Pilot(ardupilot())
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_MODE, 0.0, float(GUIDED))) == [DENIED]
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, 99.0)) == [FAILED]
    assert texts(pilot) == ["No such mode 99"]


def test_outputs_with_a_motor_are_not_servos() -> None:
    pilot = Pilot(ardupilot())
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_SERVO, 5.0, 1500.0)) == [ACCEPTED]
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_SERVO, 1.0, 1500.0)) == [FAILED]
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_SERVO, 99.0, 1500.0)) == [FAILED]
    assert texts(pilot) == ["ServoRelayEvent: Channel 1 is already in use"]
