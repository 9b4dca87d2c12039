"""PX4's follow-me: the drone keeps behind whoever tells by FOLLOW_TARGET where he is."""

from math import hypot, nan

import pytest

from link.mavlink.dialect import Message, mavlink
from tests.sim_autopilot.pilot import HOLD, Pilot, arm, px4, set_mode
from tests.sim_autopilot.planner import EAST_M, LATITUDE, LONGITUDE, NORTH_M

pytestmark = pytest.mark.slow

FOLLOW = 0x08040000
ABOVE_SEA_M = 89.0
REJECTED = 1


def word(east_m: float, north_m: float, velocity_ned: tuple[float, float, float], above_m: float = 0.0) -> Message:
    """A FOLLOW_TARGET, as MAVSDK sends it."""
    x, y = round(LATITUDE + north_m * NORTH_M), round(LONGITUDE + east_m * EAST_M)
    nothing, level = [0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]
    height_m = ABOVE_SEA_M + above_m
    return mavlink.MAVLink_follow_target_message(
        0, 3, x, y, height_m, list(velocity_ned), nothing, level, nothing, nothing, 0
    )


def following(**parameters: float) -> Pilot:
    """A drone 8 m above home that has been told to follow, and whom it does not know yet."""
    pilot = Pilot(px4(parameters=parameters))
    pilot.take_off(8.0)
    assert pilot.acknowledged(set_mode(4, 8)) == [0, 0]
    return pilot


def walk(pilot: Pilot, speed_east_m_s: float, duration_s: float, from_east_m: float = 0.0) -> float:
    """Let the leader walk east, telling of it once a second; return how far east he comes."""
    east_m = from_east_m
    for _ in range(round(duration_s)):
        pilot.step(word(east_m, 0.0, (0.0, speed_east_m_s, 0.0)))
        pilot.run(0.99)
        east_m += speed_east_m_s
    return east_m


def test_it_holds_its_place_until_it_knows_whom_to_follow() -> None:
    pilot = following()
    pilot.run(5.0)
    assert pilot.custom_mode() == FOLLOW
    assert pilot.position == pytest.approx((0.0, 0.0, 8.0), abs=0.3)


def test_it_keeps_eight_metres_behind_one_who_walks_and_looks_at_him() -> None:
    pilot = following()
    east_m = walk(pilot, 2.0, 25.0)
    x, y, z = pilot.position
    assert (east_m - x, y, z) == pytest.approx((8.0, 0.0, 8.0), abs=0.6)
    assert pilot.node.memory.now.yaw_rad == pytest.approx(0.0, abs=0.1)
    assert pilot.node.state.velocity_enu_m_s[0] == pytest.approx(2.0, abs=0.2)


def test_the_parameters_set_distance_height_and_side() -> None:
    pilot = following(FLW_TGT_DST=12.0, FLW_TGT_HT=10.0, FLW_TGT_FA=90.0)
    east_m = walk(pilot, 2.0, 30.0)
    x, y, z = pilot.position
    assert (east_m - x, y, z) == pytest.approx((0.0, -12.0, 10.0), abs=0.8)  # to his right, who walks east


def test_one_who_falls_silent_is_believed_to_have_stopped() -> None:
    pilot = following()
    east_m = walk(pilot, 3.0, 15.0)
    pilot.run(12.0)
    assert hypot(*pilot.node.state.velocity_enu_m_s[:2]) < 0.1
    assert pilot.position[0] == pytest.approx(east_m - 1.0 * 3.0 + 3.0 * 3.0 - 8.0, abs=0.8)  # three seconds on


def test_words_that_are_no_numbers_or_from_nowhere_change_nothing() -> None:
    pilot = following()
    pilot.step(word(0.0, 10.0, (nan, 0.0, 0.0)))
    pilot.step(word(0.0, 10.0, (0.0, 0.0, 0.0), above_m=nan))
    pilot.step(word(3e6, 0.0, (0.0, 0.0, 0.0)))
    assert pilot.node.memory.heard.leader is None


def test_it_does_not_arm_in_follow_and_another_mode_ends_it() -> None:
    pilot = Pilot()
    pilot.acknowledged(set_mode(4, 8))
    assert pilot.acknowledged(arm()) == [REJECTED]
    flying = following()
    walk(flying, 2.0, 5.0)
    flying.acknowledged(set_mode(4, 3))
    flying.run(3.0)
    assert flying.custom_mode() == HOLD
    assert hypot(*flying.node.state.velocity_enu_m_s[:2]) < 0.1
