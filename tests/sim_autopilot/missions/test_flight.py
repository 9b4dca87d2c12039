from math import hypot, nan

import pytest

from link.mavlink.dialect import Message, mavlink
from tests.sim_autopilot.pilot import HOLD, OFFBOARD, RTL, Pilot, arm, command, px4, set_mode
from tests.sim_autopilot.planner import item, upload

pytestmark = pytest.mark.slow

MISSION = 0x04040000
WAYPOINT = mavlink.MAV_CMD_NAV_WAYPOINT
LAND = mavlink.MAV_CMD_NAV_LAND
TAKEOFF = mavlink.MAV_CMD_NAV_TAKEOFF
ACCEPTED, DENIED = 0, 2
ACTIVE, PAUSED, COMPLETE = 3, 4, 5


def planned(*items: Message) -> Pilot:
    pilot = Pilot(px4(parameters={"NAV_ACC_RAD": 1.0}))
    assert upload(pilot, items) == ACCEPTED
    return pilot


def reached(pilot: Pilot) -> list[int]:
    return [m.seq for m in pilot.all("MISSION_ITEM_REACHED")]


def started(pilot: Pilot) -> Pilot:
    assert pilot.acknowledged(command(mavlink.MAV_CMD_MISSION_START)) == [ACCEPTED]
    assert (pilot.custom_mode(), pilot.is_armed()) == (MISSION, True)
    return pilot


def test_a_mission_takes_off_flies_its_waypoints_in_order_and_lands() -> None:
    pilot = started(
        planned(
            item(0, TAKEOFF, (0.0, 0.0, 6.0)),
            item(1, WAYPOINT, (20.0, 0.0, 6.0)),
            item(2, WAYPOINT, (20.0, 12.0, 8.0)),
            item(3, LAND, (10.0, 12.0, 0.0)),
        )
    )
    pilot.run_until(lambda: not pilot.is_armed(), 80.0)
    assert reached(pilot) == [0, 1, 2, 3]
    assert hypot(pilot.position[0] - 10.0, pilot.position[1] - 12.0) < 0.5
    assert pilot.last("MISSION_CURRENT").mission_state == COMPLETE


def test_a_mission_that_is_cleared_in_flight_is_followed_by_hold_which_is_told() -> None:
    pilot = started(planned(item(0, TAKEOFF, (0.0, 0.0, 6.0)), item(1, WAYPOINT, (60.0, 0.0, 6.0))))
    pilot.step(mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3))
    pilot.run_until(lambda: pilot.position[0] > 8.0, 30.0)
    pilot.step(mavlink.MAVLink_mission_clear_all_message(1, 1, 0))
    pilot.run(5.0)
    assert (pilot.custom_mode(), pilot.is_armed()) == (HOLD, True)
    assert "No valid mission available, loitering\t" in [text.text for text in pilot.all("STATUSTEXT")]
    assert hypot(*pilot.node.state.velocity_enu_m_s[:2]) < 0.1


def test_a_mission_without_a_takeoff_rises_before_it_goes() -> None:
    pilot = started(planned(item(0, WAYPOINT, (30.0, 0.0, 10.0))))
    pilot.run_until(lambda: pilot.position[2] > 9.0, 20.0)
    assert hypot(pilot.position[0], pilot.position[1]) < 0.5
    pilot.run_until(lambda: reached(pilot) == [0], 20.0)


def test_a_mission_flies_at_the_speed_that_its_item_asks_for() -> None:
    speed = item(1, mavlink.MAV_CMD_DO_CHANGE_SPEED, None, (1.0, 3.0, -1.0, 0.0))
    pilot = started(planned(item(0, TAKEOFF, (0.0, 0.0, 5.0)), speed, item(2, WAYPOINT, (60.0, 0.0, 5.0))))
    pilot.run_until(lambda: pilot.position[0] > 10.0, 30.0)
    pilot.run(3.0)
    assert pilot.node.state.velocity_enu_m_s[0] == pytest.approx(3.0, abs=0.1)


def test_a_timed_loiter_and_a_waypoints_hold_last_as_long_as_they_say() -> None:
    loiter = item(0, mavlink.MAV_CMD_NAV_LOITER_TIME, (0.0, 0.0, 4.0), (4.0, 0.0, 0.0, nan))
    pilot = started(planned(loiter, item(1, WAYPOINT, (0.5, 0.0, 4.0), (3.0, 0.0, 0.0, nan))))
    pilot.run_until(lambda: len(reached(pilot)) == 2, 40.0)
    (first, _), (second, _) = [(t, m) for t, m in pilot.received if m.get_type() == "MISSION_ITEM_REACHED"]
    assert second - first == pytest.approx(3.0, abs=0.1)


def test_a_paused_mission_goes_on_where_it_was() -> None:
    pilot = started(planned(item(0, TAKEOFF, (0.0, 0.0, 5.0)), item(1, WAYPOINT, (40.0, 0.0, 5.0))))
    pilot.run_until(lambda: pilot.position[0] > 10.0, 30.0)
    pilot.acknowledged(set_mode(4, 3))
    pilot.run(3.0)
    stopped = pilot.position.copy()
    pilot.run(1.2)
    assert pilot.custom_mode() == HOLD
    assert abs(pilot.position[0] - stopped[0]) < 0.1
    assert (pilot.last("MISSION_CURRENT").seq, pilot.last("MISSION_CURRENT").mission_state) == (1, PAUSED)
    pilot.acknowledged(set_mode(4, 4))
    pilot.run_until(lambda: reached(pilot) == [0, 1], 20.0)


def test_the_current_item_can_be_chosen_before_and_in_flight() -> None:
    pilot = planned(*(item(i, WAYPOINT, (15.0 * i, 0.0, 5.0)) for i in range(4)))
    pilot.step(mavlink.MAVLink_mission_set_current_message(1, 1, 2))
    current = pilot.last("MISSION_CURRENT")
    assert (current.seq, current.total) == (2, 4)
    started(pilot)
    pilot.run(6.0)
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_MISSION_CURRENT, 1.0)) == [mavlink.MAV_RESULT_UNSUPPORTED]
    pilot.step(mavlink.MAVLink_mission_set_current_message(1, 1, 1))
    pilot.run_until(lambda: 1 in reached(pilot), 20.0)
    assert 2 not in reached(pilot)


def test_a_return_at_the_end_of_a_mission_is_the_return_mode() -> None:
    back = item(1, mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH, None)
    pilot = started(planned(item(0, TAKEOFF, (0.0, 0.0, 5.0)), back))
    pilot.run_until(lambda: pilot.custom_mode() == RTL, 20.0)
    pilot.run_until(lambda: not pilot.is_armed(), 40.0)


def test_a_jump_is_obeyed_as_often_as_it_says() -> None:
    jump = item(2, mavlink.MAV_CMD_DO_JUMP, None, (0.0, 2.0, 0.0, 0.0))
    near = [item(i, WAYPOINT, (float(i), 0.0, 4.0)) for i in (0, 1)]
    pilot = started(planned(*near, jump, item(3, WAYPOINT, (2.0, 0.0, 4.0))))
    pilot.run_until(lambda: 3 in reached(pilot), 60.0)
    assert [seq for seq in reached(pilot) if seq < 2] == [0, 1] * 3


def test_a_mission_that_is_not_there_is_not_started_nor_armed_for_nor_chosen_in_flight() -> None:
    pilot = Pilot()
    assert pilot.acknowledged(command(mavlink.MAV_CMD_MISSION_START)) == [DENIED]
    pilot.acknowledged(set_mode(4, 4))
    assert pilot.custom_mode() == MISSION
    assert pilot.acknowledged(arm()) != [ACCEPTED]
    pilot.take_off()
    pilot.acknowledged(set_mode(4, 4))
    assert pilot.custom_mode() == OFFBOARD
