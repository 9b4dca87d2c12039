from math import cos, hypot, nan, sin

import pytest

from link.mavlink.dialect import mavlink
from tests.sim_autopilot.pilot import HOLD, Pilot, command, set_mode
from tests.sim_autopilot.planner import EAST_M, LATITUDE, LONGITUDE, NORTH_M

pytestmark = pytest.mark.slow

ACCEPTED, REJECTED, DENIED = 0, 1, 2
REPOSITION = mavlink.MAV_CMD_DO_REPOSITION
ABOVE_SEA_M = 89.0


def goes(pilot: Pilot, east_m: float, north_m: float, above_home_m: float, yaw_rad: float = nan) -> list[int]:
    x, y = round(LATITUDE + north_m * NORTH_M), round(LONGITUDE + east_m * EAST_M)
    message = mavlink.MAVLink_command_int_message(
        1, 1, mavlink.MAV_FRAME_GLOBAL_INT, REPOSITION, 0, 0, -1.0, 1.0, 0.0, yaw_rad, x, y, above_home_m + ABOVE_SEA_M
    )
    return pilot.acknowledged(message)


def test_a_reposition_goes_there_at_cruise_speed_and_holds() -> None:
    pilot = Pilot()
    pilot.take_off()
    assert goes(pilot, 30.0, 10.0, 8.0, 0.0) == [ACCEPTED]
    assert pilot.custom_mode() == HOLD
    pilot.run(4.0)
    assert hypot(*pilot.node.state.velocity_enu_m_s[:2]) == pytest.approx(5.0, abs=0.1)  # MPC_XY_CRUISE
    pilot.run(8.0)
    assert pilot.position == pytest.approx((30.0, 10.0, 8.0), abs=0.25)


def test_a_reposition_to_nowhere_in_particular_keeps_place_and_changes_height() -> None:
    pilot = Pilot()
    pilot.take_off()
    assert pilot.acknowledged(command(REPOSITION, -1.0, 1.0, 0.0, nan, nan, nan, ABOVE_SEA_M + 9.0)) == [ACCEPTED]
    pilot.run(5.0)
    assert pilot.position == pytest.approx((0.0, 0.0, 9.0), abs=0.25)


def test_a_reposition_on_the_ground_only_changes_the_mode_and_to_another_continent_is_refused() -> None:
    pilot = Pilot()
    pilot.acknowledged(set_mode(3))
    assert goes(pilot, 5.0, 5.0, 5.0) == [ACCEPTED]
    assert pilot.custom_mode() == HOLD
    pilot.take_off()
    assert goes(pilot, 5e5, 0.0, 5.0) == [REJECTED]


def test_a_change_of_speed_holds_for_the_way_under_way() -> None:
    pilot = Pilot()
    pilot.take_off()
    goes(pilot, 60.0, 0.0, 5.0)
    pilot.run(3.0)
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_CHANGE_SPEED, 1.0, 2.0, -1.0)) == [ACCEPTED]
    pilot.run(3.0)
    assert pilot.node.state.velocity_enu_m_s[0] == pytest.approx(2.0, abs=0.1)


def test_a_circle_is_flown_about_its_place_with_the_nose_to_it() -> None:
    pilot = Pilot()
    pilot.take_off()
    orbit = command(mavlink.MAV_CMD_DO_ORBIT, 8.0, 3.0, 0.0, nan, LATITUDE * 1e-7, LONGITUDE * 1e-7, ABOVE_SEA_M + 6.0)
    assert pilot.acknowledged(orbit) == [ACCEPTED]
    assert pilot.custom_mode() == 3 << 16 | 1 << 24
    pilot.run(15.0)
    for _ in range(4):
        pilot.run(2.0)
        x, y, z = pilot.position
        vx, vy = pilot.node.state.velocity_enu_m_s[:2]
        assert (hypot(x, y), z) == pytest.approx((8.0, 6.0), abs=0.4)
        assert (vx * y - vy * x) / hypot(x, y) == pytest.approx(3.0, abs=0.3)  # clockwise
        yaw = pilot.node.memory.now.yaw_rad
        assert (x * cos(yaw) + y * sin(yaw)) / hypot(x, y) == pytest.approx(-1.0, abs=0.05)


def test_a_circle_about_no_place_is_flown_about_the_drone() -> None:
    pilot, nowhere = Pilot(), 2**31 - 1
    pilot.take_off()
    message = mavlink.MAVLink_command_int_message(
        1, 1, mavlink.MAV_FRAME_GLOBAL_INT, mavlink.MAV_CMD_DO_ORBIT, 0, 0, 8.0, 2.0, 0.0, nan, nowhere, nowhere, nan
    )
    assert pilot.acknowledged(message) == [ACCEPTED]
    pilot.run(15.0)
    assert hypot(*pilot.position[:2]) == pytest.approx(8.0, abs=0.4)


def test_home_is_put_where_the_command_says() -> None:
    pilot = Pilot()
    x, y = LATITUDE + 5 * NORTH_M, LONGITUDE + 3 * EAST_M
    there = command(mavlink.MAV_CMD_DO_SET_HOME, 0.0, 0.0, 0.0, 0.0, x * 1e-7, y * 1e-7, ABOVE_SEA_M + 2.0)
    assert pilot.acknowledged(there) == [ACCEPTED]
    assert pilot.node.memory.places.home_enu_m == pytest.approx((3.0, 5.0, 2.0), abs=0.6)  # floats of the wire
    assert pilot.last("HOME_POSITION").altitude == pytest.approx(91_000, abs=10)
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_HOME, 1.0)) == [ACCEPTED]
    assert pilot.node.memory.places.home_enu_m == pytest.approx(tuple(pilot.position), abs=0.01)
