"""PX4's precision landing by LANDING_TARGET: where it lands, when it waits, searches and gives up."""

from collections.abc import Callable
from math import hypot

import pytest

from link.frames.rotations import ned_from_enu
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.flight.target_stages import Stage
from tests.sim_autopilot.pilot import LAND, Pilot, px4, set_mode

pytestmark = pytest.mark.slow

BODY, LOCAL = int(mavlink.MAV_FRAME_BODY_FRD), int(mavlink.MAV_FRAME_LOCAL_NED)
PRECISION_LAND = 0x09040000
HEIGHT_M = 6.0
BRAKING_M_S2 = 3.0  # MPC_ACC_HOR
UPRIGHT = (1.0, 0.0, 0.0, 0.0)


def told(place: tuple[float, float, float], *, frame: int = LOCAL, valid: int = 1) -> Message:
    ned = ned_from_enu(place)
    return mavlink.MAVLink_landing_target_message(0, 0, frame, 0.0, 0.0, 9.0, 0, 0, *ned, UPRIGHT, 2, valid)


def landing(duration_s: float, make: Callable[[float], Message] | None, **parameters: float) -> Pilot:
    pilot = Pilot(px4(parameters=parameters))
    pilot.take_off(HEIGHT_M)
    pilot.step(set_mode(4, 9))
    assert pilot.custom_mode() == PRECISION_LAND
    began_s = pilot.t_s
    pilot.run(duration_s, None if make is None else lambda t_s: make(t_s - began_s))
    return pilot


def stage(pilot: Pilot) -> Stage:
    flown = pilot.node.memory.course.flight.target_landing
    assert flown is not None
    return flown.stage


def test_it_goes_over_the_target_waits_there_for_2_s_sinks_and_stops_its_motors() -> None:
    pilot = landing(1.0, lambda _t: told((1.5, -1.0, 0.0)))
    while hypot(pilot.position[0] - 1.5, pilot.position[1] + 1.0) > 0.19:
        pilot.run(0.02, lambda _t: told((1.5, -1.0, 0.0)))
    pilot.run(1.5, lambda _t: told((1.5, -1.0, 0.0)))
    assert pilot.position[2] == pytest.approx(HEIGHT_M, abs=0.15)
    pilot.run_until(lambda: not pilot.is_armed(), 30.0, lambda _t: told((1.5, -1.0, 0.0)))
    assert pilot.position[:2] == pytest.approx((1.5, -1.0), abs=0.05)


@pytest.mark.parametrize("speed_m_s", [1.0, 2.0])
def test_it_trails_behind_a_target_that_moves_and_never_sinks(speed_m_s: float) -> None:
    pilot = landing(20.0, lambda t: told((0.0, speed_m_s * t, 0.0)))
    behind_m = 20.0 * speed_m_s - pilot.position[1]
    assert 0.2 < behind_m < 2.0 * speed_m_s
    assert pilot.node.state.velocity_enu_m_s[1] == pytest.approx(speed_m_s, abs=0.1)
    assert pilot.position[2] == pytest.approx(HEIGHT_M, abs=0.15)
    assert stage(pilot) is Stage.APPROACH


@pytest.mark.parametrize(("frame", "valid"), [(BODY, 1), (LOCAL, 0)])
def test_a_place_in_another_frame_or_none_is_not_gone_to(frame: int, valid: int) -> None:
    pilot = landing(1.5, lambda _t: told((3.0, 0.0, 0.0), frame=frame, valid=valid))
    assert stage(pilot) is Stage.START
    assert hypot(*pilot.position[:2]) < 0.1


def test_without_a_target_it_climbs_searches_and_lands_where_it_is() -> None:
    pilot = landing(8.0, None, PLD_SRCH_TOUT=7.0)
    assert stage(pilot) is Stage.SEARCH
    assert pilot.position[2] == pytest.approx(10.0, abs=0.2)
    pilot.run(2.0)
    assert stage(pilot) is Stage.FALLBACK
    pilot.run_until(lambda: not pilot.is_armed(), 40.0)
    assert hypot(*pilot.position[:2]) < 0.1


def test_a_target_seen_in_a_search_ends_the_climb_and_is_gone_to() -> None:
    pilot = landing(3.0, None)
    assert stage(pilot) is Stage.SEARCH
    height_m, climb_m_s = pilot.position[2], pilot.node.state.velocity_enu_m_s[2]
    pilot.run(3.5, lambda _t: told((2.0, 0.0, 0.0)))
    assert stage(pilot) is Stage.APPROACH
    assert pilot.position[2] < height_m + climb_m_s**2 / (2.0 * BRAKING_M_S2) + 0.2
    assert pilot.position[0] > 1.0


def test_a_search_of_no_time_is_none() -> None:
    assert stage(landing(0.1, None, PLD_SRCH_TOUT=0.0)) is Stage.FALLBACK


def test_a_target_lost_high_up_is_searched_for_and_one_lost_near_the_ground_is_landed_on() -> None:
    pilot = landing(5.0, lambda _t: told((0.5, 0.0, 0.0)), PLD_BTOUT=1.0)
    assert stage(pilot) is Stage.DESCEND
    pilot.run(1.5)
    assert stage(pilot) is Stage.START
    low = landing(5.0, lambda _t: told((0.5, 0.0, 0.0)), PLD_FAPPR_ALT=3.0)
    low.run_until(lambda: low.position[2] < 2.5, 10.0, lambda _t: told((0.5, 0.0, 0.0)))
    low.run(0.7)
    assert stage(low) is Stage.FINAL
    low.run_until(lambda: not low.is_armed(), 20.0)
    assert low.position[:2] == pytest.approx((0.5, 0.0), abs=0.1)


def test_after_the_last_search_it_lands() -> None:
    pilot = landing(5.0, lambda _t: told((0.5, 0.0, 0.0)), PLD_BTOUT=1.0, PLD_MAX_SRCH=0.0)
    pilot.run(1.5)
    assert stage(pilot) is Stage.FALLBACK


def test_another_mode_ends_it_and_it_begins_anew_with_what_is_still_seen() -> None:
    pilot = landing(5.0, lambda _t: told((0.5, 0.0, 0.0)))
    pilot.step(set_mode(4, 6))
    assert pilot.custom_mode() == LAND
    assert pilot.node.memory.course.flight.target_landing is None
    pilot.step(set_mode(4, 9))
    assert stage(pilot) is Stage.APPROACH
