"""What client programs ask of ArduCopter besides flying: headings, the fence switch, home, calibration, reboot."""

from math import degrees, inf, nan

import pytest

from link.mavlink.dialect import mavlink
from sim_autopilot.missions.items import RALLY
from tests.sim_autopilot.copter import AUTO, GUIDED, ardupilot, copter_in_the_air, heartbeat, mode
from tests.sim_autopilot.pilot import VELOCITY_ONLY, Pilot, arm, command, setpoint
from tests.sim_autopilot.planner import RELATIVE, download, item, upload

pytestmark = pytest.mark.slow

FAILED, UNSUPPORTED, INVALID_PARAM2, INVALID_PARAM4 = 4, 3, 7, 9
WAYPOINT, TAKEOFF, RETURN = 16, 22, 20
NUMBERS = (0.0, 0.0, 0.0, 0.0)


def test_a_heading_is_turned_to_and_by_in_guided() -> None:
    pilot = copter_in_the_air()
    for parameters, heading in (((200.0, 20.0, 1.0, 0.0), 200.0), ((50.0, 20.0, -1.0, 1.0), 150.0)):
        assert pilot.acknowledged(command(mavlink.MAV_CMD_CONDITION_YAW, *parameters)) == [0]
        pilot.run(6.0)
        assert 90.0 - degrees(pilot.node.memory.now.yaw_rad) % 360.0 == pytest.approx(heading - 360.0, abs=2.0)


def test_the_fence_is_switched_by_a_command_where_there_is_one() -> None:
    pilot = Pilot(ardupilot(parameters={"FENCE_TYPE": 4}))
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_FENCE_ENABLE, 1.0)) == [FAILED]
    pilot = Pilot(ardupilot())
    for switch in (1.0, 0.0):
        assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_FENCE_ENABLE, switch)) == [0]
        assert pilot.node.memory.tuning.values["FENCE_ENABLE"] == switch


def test_item_0_is_home_whatever_was_uploaded() -> None:
    pilot = Pilot(ardupilot())
    away = (50.0, 60.0, 9.0)
    assert upload(pilot, [item(0, WAYPOINT, away, NUMBERS), item(1, WAYPOINT, away, NUMBERS)]) == 0
    home, first = download(pilot)
    assert (home.x, home.y, home.frame) == (524_733_000, 134_017_000, 0)
    assert home.z == pytest.approx(89.12, abs=0.01)
    assert first.x > home.x + 4000


def test_a_missions_value_that_is_no_number_is_refused_by_its_place() -> None:
    pilot = Pilot(ardupilot())
    assert upload(pilot, [item(0, WAYPOINT, (0.0, 0.0, 5.0), (0.0, nan, 0.0, 0.0))]) == INVALID_PARAM2
    jump = item(0, mavlink.MAV_CMD_DO_JUMP, (0.0, 0.0, 5.0), (1.0, 1.0, 0.0, nan))
    assert upload(pilot, [jump]) == INVALID_PARAM4
    rally = item(0, mavlink.MAV_CMD_NAV_RALLY_POINT, (0.0, 5.0, 20.0), (0.0, 0.0, 0.0, nan), kind=RALLY, frame=RELATIVE)
    assert upload(pilot, [rally], RALLY) == 0


def test_a_waypoint_without_a_heading_is_taken_as_mavsdk_sends_it() -> None:
    pilot = Pilot(ardupilot())
    assert upload(pilot, [item(0, WAYPOINT, (0.0, 0.0, 5.0), (0.0, 0.0, 0.0, nan))]) == 0
    assert upload(pilot, [item(0, WAYPOINT, (0.0, 0.0, 5.0), (0.0, 0.0, 0.0, -inf))]) == INVALID_PARAM4


def test_a_mission_that_returns_stays_in_auto_until_the_motors_stop_and_after() -> None:
    pilot = copter_in_the_air(height_m=12.0)
    place = (3.0, 25.0, 12.0)
    items = [item(0, WAYPOINT, place, NUMBERS), item(1, WAYPOINT, place, NUMBERS), item(2, RETURN)]
    items[2].param4 = 0.0
    assert upload(pilot, items) == 0
    assert pilot.acknowledged(mode(AUTO)) == [0]
    pilot.run_until(lambda: not pilot.is_armed(), 120.0)
    assert {beat.custom_mode for beat in pilot.all("HEARTBEAT")[-20:]} == {AUTO}
    assert abs(pilot.position[1]) < 1.0
    assert heartbeat(pilot)[1] == AUTO


def test_a_reboot_keeps_parameters_and_plans_and_begins_time_anew() -> None:
    pilot = Pilot(ardupilot())
    upload(pilot, [item(0, WAYPOINT, (0.0, 0.0, 5.0), NUMBERS), item(1, TAKEOFF, (0.0, 0.0, 5.0), NUMBERS)])
    pilot.step(mavlink.MAVLink_param_set_message(1, 1, b"WPNAV_SPEED", 700.0, 9), mode(GUIDED))
    pilot.run(3.0)
    assert pilot.acknowledged(command(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1.0)) == [0]
    pilot.run(1.5)
    memory = pilot.node.memory
    assert memory.now.boot_ns < 2_000_000_000
    assert memory.tuning.values["WPNAV_SPEED"] == 700.0
    assert heartbeat(pilot)[1] == 0
    assert len(download(pilot)) == 2
    pilot.step(mode(GUIDED))
    assert pilot.acknowledged(arm()) == [0]


def test_a_reboot_is_refused_while_armed() -> None:
    pilot = Pilot(ardupilot())
    pilot.step(mode(GUIDED), arm())
    assert pilot.acknowledged(command(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1.0)) == [FAILED]
    pilot.run(1.0)
    assert pilot.is_armed()


def test_a_mission_that_has_not_begun_has_home_as_its_current_item() -> None:
    pilot = Pilot(ardupilot())
    upload(pilot, [item(index, WAYPOINT, (0.0, 5.0, 5.0), NUMBERS) for index in range(3)])
    assert pilot.last("MISSION_CURRENT").seq == 0
    pilot.step(mavlink.MAVLink_mission_set_current_message(1, 1, 2))
    assert pilot.last("MISSION_CURRENT").seq == 2
    pilot.step(mavlink.MAVLink_mission_clear_all_message(1, 1, 0))
    assert pilot.last("MISSION_CURRENT").seq == 0


def test_only_guided_pauses_and_auto_and_guided_go_on() -> None:
    pause, resume = (command(mavlink.MAV_CMD_DO_PAUSE_CONTINUE, value) for value in (0.0, 1.0))
    pilot = Pilot(ardupilot())
    assert pilot.acknowledged(resume) == [FAILED]
    assert pilot.last("STATUSTEXT").text == "Failed to resume"
    flying = copter_in_the_air()
    flying.step(setpoint(velocity=(3.0, 0.0, 0.0), mask=VELOCITY_ONLY))
    flying.run(2.0)
    assert flying.acknowledged(pause) == [0]
    flying.run(4.0)
    assert flying.node.memory.now.speed_m_s < 0.1
    assert flying.acknowledged(resume) == [0]
