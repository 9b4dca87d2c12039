"""What ArduCopter stores of plans and parameters, and what it refuses to store."""

from math import nan

import pytest

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.interfaces import AutopilotConfig
from tests.sim_autopilot.copter import GUIDED, ardupilot, mode
from tests.sim_autopilot.pilot import Pilot, arm, command, px4
from tests.sim_autopilot.planner import download, item, plan_messages, upload

pytestmark = pytest.mark.slow

WAYPOINT, SPEED, JUMP = mavlink.MAV_CMD_NAV_WAYPOINT, mavlink.MAV_CMD_DO_CHANGE_SPEED, mavlink.MAV_CMD_DO_JUMP
CORNER, CIRCLE = mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION, mavlink.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION
FENCE, RALLY, ALL = 1, 2, 255
ACCEPTED, ERROR, UNSUPPORTED_FRAME, UNSUPPORTED = 0, 1, 2, 3
PLACE = (3.0, 5.0, 10.0)
NUMBERS = (0.0, 0.0, 0.0, 0.0)


def texts(pilot: Pilot) -> list[str]:
    return [message.text for message in pilot.all("STATUSTEXT")]


def waypoints(count: int) -> list[Message]:
    return [item(index, WAYPOINT, PLACE, (2.0, 3.0, 4.0, 90.0)) for index in range(count)]


def corners(count: int, told: float) -> list[Message]:
    places = ((0.0, 0.0, 0.0), (50.0, 0.0, 0.0), (50.0, 50.0, 0.0), (0.0, 50.0, 0.0))[:count]
    return [item(index, CORNER, place, (told, 0.0, 0.0, 0.0), kind=FENCE) for index, place in enumerate(places)]


def values(message: Message) -> tuple[float, ...]:
    return (message.param1, message.param2, message.param3, message.param4)


def test_a_waypoint_keeps_its_stay_and_neither_radius_nor_heading() -> None:
    pilot = Pilot(ardupilot())
    assert upload(pilot, waypoints(2)) == ACCEPTED
    kept = download(pilot)[1]
    assert values(kept) == (2.0, 0.0, 0.0, 0.0)
    assert (kept.z, kept.current) == (10.0, 0)


def test_a_change_of_speed_needs_no_altitude_and_keeps_no_place() -> None:
    pilot = Pilot(ardupilot())
    speed = mavlink.MAVLink_mission_item_int_message(1, 1, 1, 2, SPEED, 0, 1, 1.0, 4.0, -1.0, 0.0, 7, 8, nan, 0)
    assert upload(pilot, [waypoints(1)[0], speed]) == ACCEPTED
    kept = download(pilot)[1]
    assert values(kept) == (1.0, 4.0, -1.0, 0.0)
    assert (kept.frame, kept.x, kept.y, kept.z) == (0, 0, 0, 0.0)


def test_a_fence_and_a_rally_point_keep_what_they_need() -> None:
    pilot = Pilot(ardupilot())
    assert upload(pilot, corners(3, 3.0), FENCE) == ACCEPTED
    assert {(kept.frame, kept.autocontinue, kept.param1) for kept in download(pilot, FENCE)} == {(0, 0, 3.0)}
    point = item(0, mavlink.MAV_CMD_NAV_RALLY_POINT, PLACE, (0.0, 2.0, 0.0, 0.0), kind=RALLY)
    assert upload(pilot, [point], RALLY) == ACCEPTED
    (kept,) = download(pilot, RALLY)
    assert (values(kept), kept.autocontinue, kept.z) == (NUMBERS, 0, 10.0)


@pytest.mark.parametrize(
    "fence",
    [
        corners(2, 2.0),
        corners(2, 3.0),
        corners(3, 4.0),
        [item(0, CIRCLE, PLACE, (0.0, 0.0, 0.0, 0.0), kind=FENCE)],
    ],
)
def test_a_fence_that_encloses_nothing_is_refused_and_the_old_one_stays(fence: list[Message]) -> None:
    pilot = Pilot(ardupilot())
    assert upload(pilot, corners(4, 4.0), FENCE) == ACCEPTED
    assert upload(pilot, fence, FENCE) == ERROR
    assert len(download(pilot, FENCE)) == 4


@pytest.mark.parametrize(("target", "result"), [(0.0, ERROR), (1.0, ACCEPTED), (2.0, ACCEPTED), (3.0, ERROR)])
def test_a_jump_must_lead_to_an_item_that_is_not_home(target: float, result: int) -> None:
    pilot = Pilot(ardupilot())
    assert upload(pilot, [*waypoints(2), item(2, JUMP, None, (target, 1.0, 0.0, 0.0))]) == result


def test_all_plans_at_once_are_cleared_by_px4_only() -> None:
    clear = mavlink.MAVLink_mission_clear_all_message(1, 1, ALL)
    results = []
    for pilot in (Pilot(), Pilot(ardupilot())):
        upload(pilot, corners(3, 3.0), FENCE)
        (answer,) = plan_messages(pilot.step(clear))
        results.append((answer.type, len(download(pilot, FENCE))))
    assert results == [(ACCEPTED, 0), (UNSUPPORTED, 3)]


def test_a_reset_of_the_parameters_acts_with_the_next_boot_and_nothing_is_saved_or_loaded_by_command() -> None:
    pilot = Pilot(ardupilot())
    pilot.step(mavlink.MAVLink_param_set_message(1, 1, b"WPNAV_SPEED", 700.0, 9))
    storage = mavlink.MAV_CMD_PREFLIGHT_STORAGE
    assert [pilot.acknowledged(command(storage, wanted)) for wanted in (0.0, 1.0, 2.0)] == [[2], [2], [ACCEPTED]]
    assert "All parameters reset, reboot board" in texts(pilot)
    assert pilot.node.memory.tuning.values["WPNAV_SPEED"] == 700.0
    pilot.step(command(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1.0))
    pilot.run(1.5)
    assert pilot.node.memory.tuning.values["WPNAV_SPEED"] == 1000.0


def test_a_motor_is_not_tested_in_the_air_and_not_by_px4() -> None:
    pilot = Pilot(ardupilot())
    pilot.step(mode(GUIDED), arm())
    pilot.step(command(mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 3.0))
    pilot.run(8.0)
    test = command(mavlink.MAV_CMD_DO_MOTOR_TEST, 1.0, 0.0, 10.0, 1.0)
    assert pilot.acknowledged(test) == [mavlink.MAV_RESULT_FAILED]
    assert "Motor Test: vehicle not landed" in texts(pilot)
    assert Pilot().acknowledged(test) == [mavlink.MAV_RESULT_UNSUPPORTED]


def test_the_current_item_is_chosen_by_command_too() -> None:
    pilot = Pilot(ardupilot())
    upload(pilot, waypoints(3))
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_MISSION_CURRENT, 2.0)) == [ACCEPTED]
    assert pilot.last("MISSION_CURRENT").seq == 2
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_MISSION_CURRENT, 9.0)) == [mavlink.MAV_RESULT_DENIED]


@pytest.mark.parametrize(("config", "heights"), [(ardupilot(), [30.0, 10.0]), (px4(), [10.0, 10.0])])
def test_items_of_an_upload_that_breaks_off_replace_the_old_ones_with_arducopter_only(
    config: AutopilotConfig, heights: list[float]
) -> None:
    pilot = Pilot(config)
    assert upload(pilot, waypoints(3)) == ACCEPTED
    begun = [item(index, WAYPOINT, (1.0, 1.0, 29.0 + index)) for index in range(2)]
    refused = item(2, WAYPOINT, PLACE, frame=mavlink.MAV_FRAME_LOCAL_NED)
    assert upload(pilot, [*begun, refused]) != ACCEPTED
    assert [kept.z for kept in download(pilot)[1:]] == heights  # item 0 is home with the one


def test_a_waypoint_above_the_terrain_is_kept_as_such_by_arducopter_only() -> None:
    for frame in (mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT, mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT_INT):
        plan = [waypoints(1)[0], item(1, WAYPOINT, PLACE, frame=frame)]
        pilot = Pilot(ardupilot())
        assert upload(pilot, plan) == ACCEPTED
        assert download(pilot)[1].frame == mavlink.MAV_FRAME_GLOBAL_TERRAIN_ALT
        assert upload(Pilot(), plan) == UNSUPPORTED_FRAME


def test_arducopter_cuts_its_mission_off_as_soon_as_a_shorter_one_is_announced() -> None:
    pilot = Pilot(ardupilot())
    assert upload(pilot, waypoints(4)) == ACCEPTED
    pilot.step(mavlink.MAVLink_mission_count_message(1, 1, 2, 0))
    pilot.run(9.0)
    assert len(download(pilot)) == 2


@pytest.mark.parametrize(
    ("number", "copter", "px4_takes"),
    [
        (mavlink.MAV_CMD_NAV_PAYLOAD_PLACE, ACCEPTED, UNSUPPORTED),
        (mavlink.MAV_CMD_DO_SET_RESUME_REPEAT_DIST, ACCEPTED, UNSUPPORTED),
        (mavlink.MAV_CMD_DO_SET_ROI_LOCATION, UNSUPPORTED, ACCEPTED),
        (mavlink.MAV_CMD_SET_CAMERA_MODE, UNSUPPORTED, ACCEPTED),
        (mavlink.MAV_CMD_CONDITION_DELAY, ACCEPTED, ACCEPTED),
    ],
)
def test_each_firmware_takes_its_own_commands_into_a_mission(number: int, copter: int, px4_takes: int) -> None:
    plan = [waypoints(1)[0], item(1, number, None, NUMBERS)]
    assert upload(Pilot(ardupilot()), plan) == copter
    assert upload(Pilot(), plan) == px4_takes
