from itertools import pairwise
from math import dist, hypot, nan

import numpy as np
import pytest

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.boot import initial_memory
from sim_autopilot.memory import AutopilotInputs
from sim_autopilot.runtime.node import STEP_NS
from sim_autopilot.step import autopilot_step
from tests.sim_autopilot.pilot import (
    DATUM,
    HOLD,
    LAND,
    OFFBOARD,
    POSITION,
    POSITION_VELOCITY,
    RTL,
    START_NS,
    STILL_AIR,
    TAKEOFF,
    VELOCITY_ONLY,
    Pilot,
    arm,
    command,
    px4,
    set_mode,
    setpoint,
)

ACCEPTED, REJECTED = 0, 1
ON_GROUND, IN_AIR = mavlink.MAV_LANDED_STATE_ON_GROUND, mavlink.MAV_LANDED_STATE_IN_AIR


def landed_state(pilot: Pilot) -> int:
    pilot.run(0.2)
    return int(pilot.last("EXTENDED_SYS_STATE").landed_state)


def landed_state_now(pilot: Pilot) -> int:
    return int(pilot.last("EXTENDED_SYS_STATE").landed_state)


def with_parameters(**values: float) -> Pilot:
    return Pilot(px4(parameters=values))


def at(x: float, y: float, z: float) -> Message:
    return setpoint((x, y, z))


def test_the_same_memory_and_inputs_give_the_same_step() -> None:
    config = px4()
    memory = initial_memory(config, START_NS)
    inputs = AutopilotInputs(t_ns=START_NS + STEP_NS, messages=(arm(),), deck=None, wind_enu_m_s=STILL_AIR)
    (one, first), (two, second) = autopilot_step(memory, inputs, config), autopilot_step(memory, inputs, config)
    assert [m.to_dict() for m in first.messages] == [m.to_dict() for m in second.messages]
    assert one.armed_ns == two.armed_ns is not None
    assert memory.armed_ns is None


def test_it_stands_still_until_it_is_told_to_fly() -> None:
    pilot = Pilot()
    before = pilot.position.copy()
    pilot.run(5.0)
    assert np.allclose(pilot.position, before, atol=0.01)
    assert landed_state(pilot) == ON_GROUND


@pytest.mark.slow
def test_it_takes_off_by_a_setpoint_above() -> None:
    pilot = Pilot()
    pilot.run(0.5, lambda _t: at(0.0, 0.0, -5.0))
    pilot.step(set_mode(6), arm())
    in_air_s = pilot.run_until(lambda: landed_state_now(pilot) == IN_AIR, 5.0, lambda _t: at(0.0, 0.0, -5.0))
    reached_s = in_air_s + pilot.run_until(lambda: pilot.position[2] > 4.7, 10.0, lambda _t: at(0.0, 0.0, -5.0))
    assert 1.5 <= in_air_s <= 2.5  # measured on PX4
    assert reached_s == pytest.approx(5.5, abs=0.7)  # measured on PX4
    pilot.run(2.0, lambda _t: at(0.0, 0.0, -5.0))
    assert pilot.position[2] == pytest.approx(5.0, abs=0.1)
    assert landed_state(pilot) == IN_AIR


def test_mode_and_arming_come_in_any_order() -> None:
    pilot = Pilot()
    pilot.run(0.5, lambda _t: at(0.0, 0.0, -3.0))
    pilot.acknowledged(arm())
    pilot.run(0.2, lambda _t: at(0.0, 0.0, -3.0))
    pilot.step(set_mode(6))
    pilot.run_until(lambda: pilot.position[2] > 2.5, 8.0, lambda _t: at(0.0, 0.0, -3.0))


def test_the_first_climb_grows_smoothly_to_the_climb_limit() -> None:
    pilot, climbs = Pilot(), []
    pilot.run(0.5, lambda _t: at(0.0, 0.0, -20.0))
    pilot.step(set_mode(6), arm())
    for _ in range(300):
        pilot.run(0.02, lambda _t: at(0.0, 0.0, -20.0))
        climbs.append(float(pilot.node.state.velocity_enu_m_s[2]))
    assert max(climbs) == pytest.approx(3.0, abs=0.15)  # MPC_Z_VEL_MAX_UP, which the integral overshoots after the ramp
    assert all(abs(later - earlier) < 0.1 for earlier, later in pairwise(climbs))


@pytest.mark.slow
def test_a_setpoint_below_keeps_it_on_the_ground_until_it_disarms_by_itself() -> None:
    pilot = Pilot()
    pilot.run(0.5, lambda _t: at(0.0, 0.0, 1.0))
    pilot.step(set_mode(6), arm())
    idle_s = pilot.run_until(lambda: not pilot.is_armed(), 15.0, lambda _t: at(0.0, 0.0, 1.0))
    assert idle_s == pytest.approx(11.0, abs=0.1)  # measured on PX4
    assert pilot.position[2] < 0.13


@pytest.mark.slow
def test_a_plain_disarm_in_the_air_is_refused_and_a_forced_one_stops_the_motors() -> None:
    pilot = Pilot()
    pilot.take_off(10.0)
    assert pilot.acknowledged(arm(armed=False)) == [REJECTED]
    assert pilot.is_armed()
    assert pilot.acknowledged(arm(armed=False, force=True)) == [ACCEPTED]
    assert not pilot.is_armed()
    pilot.run(0.3)
    assert pilot.last("EXTENDED_SYS_STATE").landed_state == ON_GROUND  # reported while it falls, as PX4 does
    assert pilot.position[2] > 1.0
    pilot.run(0.7)
    assert pilot.node.state.velocity_enu_m_s[2] < -5.0


@pytest.mark.slow
def test_setpoints_are_held_and_not_extrapolated() -> None:
    pilot = Pilot()
    pilot.take_off()
    held = setpoint((3.0, 0.0, -5.0), (0.5, 0.0, 0.0), mask=POSITION_VELOCITY)
    pilot.run(6.0, lambda _t: held)
    settled = float(pilot.position[1])
    pilot.run(3.0, lambda _t: held)
    assert float(pilot.position[1]) == pytest.approx(settled, abs=0.1)  # extrapolated it would be 1.5 m on


@pytest.mark.slow
def test_velocity_feed_forward_removes_most_of_the_lag() -> None:
    def lag_m(mask: int) -> float:
        pilot = Pilot()
        pilot.take_off()
        began_s = pilot.t_s
        pilot.run(15.0, lambda t: setpoint((5.0 * (t - began_s), 0.0, -5.0), (5.0, 0.0, 0.0), mask=mask))
        return 5.0 * (pilot.t_s - began_s) - float(pilot.position[1])

    assert lag_m(POSITION_VELOCITY) < 0.5  # PX4: 0.4 m
    assert 3.0 < lag_m(0b1001_1111_1000) < 7.0  # PX4: 5.5 m, position alone


@pytest.mark.slow
def test_speed_and_descent_keep_to_the_parameters_silently() -> None:
    pilot = Pilot(px4(parameters={"MPC_XY_VEL_MAX": 4.0}))
    pilot.take_off(15.0)
    pilot.run(3.0, lambda _t: setpoint(velocity=(9.0, 0.0, 4.0), mask=VELOCITY_ONLY))
    for _ in range(100):
        pilot.run(0.02, lambda _t: setpoint(velocity=(9.0, 0.0, 4.0), mask=VELOCITY_ONLY))
        vx, vy, vz = pilot.node.state.velocity_enu_m_s.tolist()
        assert hypot(vx, vy) == pytest.approx(4.0, abs=0.2)
        assert -vz == pytest.approx(1.5, abs=0.1)  # MPC_Z_VEL_MAX_DN
    assert not pilot.all("STATUSTEXT")


@pytest.mark.slow
def test_silence_brings_a_failsafe_that_brakes_descends_lands_and_disarms() -> None:
    pilot = Pilot()
    pilot.take_off()
    silent_s = pilot.run_until(lambda: pilot.custom_mode() != OFFBOARD, 2.0)
    assert 1.0 <= silent_s <= 1.07  # measured on PX4
    assert pilot.custom_mode() == POSITION
    pilot.run(1.1)
    heartbeat = pilot.last("HEARTBEAT")
    assert (heartbeat.custom_mode, heartbeat.system_status) == (POSITION, mavlink.MAV_STATE_CRITICAL)
    pilot.run_until(lambda: not pilot.is_armed(), 25.0)
    assert pilot.position[2] < 0.13


@pytest.mark.slow
@pytest.mark.parametrize(("action", "mode"), [(0, POSITION), (3, RTL), (4, LAND), (5, HOLD)])
def test_the_parameter_chooses_what_silence_leads_to(action: int, mode: int) -> None:
    pilot = with_parameters(COM_OBL_RC_ACT=action)
    pilot.take_off()
    pilot.run(1.2)
    assert pilot.custom_mode() == mode
    assert pilot.is_armed()


@pytest.mark.slow
def test_the_parameter_can_stop_the_motors_in_flight() -> None:
    pilot = with_parameters(COM_OBL_RC_ACT=7)
    pilot.take_off()
    pilot.run(1.2)
    assert not pilot.is_armed()


@pytest.mark.slow
def test_setpoints_that_resume_are_flown_again_without_a_command() -> None:
    pilot = Pilot()
    pilot.take_off()
    pilot.run(1.5)
    assert pilot.custom_mode() == POSITION
    back_s = pilot.run_until(lambda: pilot.custom_mode() == OFFBOARD, 1.0, lambda _t: at(0.0, 2.0, -5.0))
    assert back_s <= 0.06  # measured on PX4
    pilot.run(4.0, lambda _t: at(0.0, 2.0, -5.0))
    assert pilot.position[0] == pytest.approx(2.0, abs=0.1)


@pytest.mark.slow
def test_setpoints_that_resume_after_the_pilot_took_over_are_not_flown() -> None:
    pilot = Pilot()
    pilot.take_off()
    pilot.run(1.5)
    pilot.step(set_mode(4, 3))
    pilot.run(3.0, lambda _t: at(0.0, 20.0, -5.0))
    assert pilot.custom_mode() == HOLD
    assert abs(pilot.position[0]) < 0.1


@pytest.mark.slow
def test_just_over_one_setpoint_a_second_holds_offboard_and_just_under_does_not() -> None:
    def drops(period_s: float) -> bool:
        pilot = Pilot()
        pilot.take_off()
        for _ in range(6):
            pilot.step(at(0.0, 0.0, -5.0))
            pilot.run(period_s - 0.02)
            if pilot.custom_mode() != OFFBOARD:
                return True
        return False

    assert not drops(1.0 / 1.2)
    assert drops(1.0 / 0.9)


@pytest.mark.slow
def test_current_mode_tells_the_intended_mode_in_a_failsafe() -> None:
    pilot = Pilot()
    pilot.take_off()
    pilot.acknowledged(command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, 436.0, 50_000.0))
    pilot.run(1.2)
    message = pilot.last("CURRENT_MODE")
    assert (message.custom_mode, message.intended_custom_mode) == (POSITION, OFFBOARD)


@pytest.mark.slow
def test_hold_brakes_without_jerking_and_stays() -> None:
    pilot = Pilot()
    pilot.take_off()
    began_s = pilot.t_s
    pilot.run(6.0, lambda t: setpoint((5 * (t - began_s), 0.0, -5.0), (5.0, 0.0, 0.0), mask=POSITION_VELOCITY))
    pilot.step(set_mode(4, 3))
    pilot.run(5.0)
    stopped = pilot.position.copy()
    pilot.run(3.0)
    assert dist(pilot.position, stopped) < 0.15  # the integral forgets the drag within Kv / Ki = 4.5 s
    assert float(np.linalg.norm(pilot.node.state.velocity_enu_m_s)) < 0.05


@pytest.mark.slow
def test_landing_ends_on_the_ground_disarmed_two_seconds_after_it_was_detected() -> None:
    pilot = Pilot()
    pilot.take_off(6.0)
    pilot.step(set_mode(4, 6))
    pilot.run(1.0)
    assert landed_state(pilot) == mavlink.MAV_LANDED_STATE_LANDING
    pilot.run_until(lambda: pilot.position[2] < 0.13, 20.0)
    to_landed_s = pilot.run_until(lambda: pilot.node.memory.course.landing.landed, 5.0)
    to_disarmed_s = pilot.run_until(lambda: not pilot.is_armed(), 5.0)
    assert to_landed_s == pytest.approx(1.5, abs=0.5)  # measured on PX4
    assert to_disarmed_s == pytest.approx(2.0, abs=0.05)  # COM_DISARM_LAND
    assert pilot.custom_mode() == OFFBOARD  # asked for last of the modes that let arm


@pytest.mark.slow
def test_a_landing_from_hold_leaves_a_mode_that_arms_and_land_itself_does_not() -> None:
    pilot = Pilot()
    pilot.take_off(3.0)
    pilot.step(set_mode(4, 3))
    pilot.step(set_mode(4, 6))
    pilot.run_until(lambda: not pilot.is_armed(), 20.0)
    assert pilot.custom_mode() == HOLD
    pilot.acknowledged(set_mode(4, 6))
    assert pilot.acknowledged(arm()) == [1]
    pilot.acknowledged(set_mode(4, 3))
    assert pilot.acknowledged(arm()) == [0]


@pytest.mark.slow
def test_a_landing_by_setpoints_needs_a_velocity_downwards() -> None:
    def lands(message: Message) -> bool:
        pilot = Pilot()
        pilot.take_off(2.0)
        pilot.run(3.0, lambda _t: setpoint((0.0, 0.0, -0.4)))
        pilot.run(10.0, lambda _t: message)
        return not pilot.is_armed()

    assert not lands(setpoint((0.0, 0.0, 1.0)))
    assert not lands(setpoint((0.0, 0.0, 1.0), (0.0, 0.0, 0.2), mask=POSITION_VELOCITY))
    assert lands(setpoint((0.0, 0.0, 1.0), (0.0, 0.0, 0.5), mask=POSITION_VELOCITY))


@pytest.mark.slow
def test_a_plain_disarm_works_once_it_has_landed() -> None:
    pilot = with_parameters(COM_DISARM_LAND=-1.0)
    pilot.take_off(2.0)
    pilot.step(set_mode(4, 6))
    pilot.run_until(lambda: pilot.node.memory.course.landing.landed, 20.0)
    pilot.run(5.0)
    assert pilot.is_armed()
    assert pilot.acknowledged(arm(armed=False)) == [ACCEPTED]


def test_takeoff_goes_to_the_parameters_height_and_holds() -> None:
    pilot = Pilot()
    pilot.acknowledged(arm())
    assert pilot.acknowledged(command(mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, nan, nan, nan, nan)) == [ACCEPTED]
    assert pilot.custom_mode() == TAKEOFF
    pilot.run_until(lambda: pilot.custom_mode() == HOLD, 15.0)
    pilot.run(3.0)
    assert pilot.position[2] == pytest.approx(2.5 + 0.12, abs=0.2)  # MIS_TAKEOFF_ALT


@pytest.mark.slow
def test_takeoff_goes_to_the_altitude_above_the_sea_that_the_command_says() -> None:
    pilot = Pilot()
    pilot.acknowledged(arm())
    pilot.step(command(mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, nan, nan, nan, DATUM.altitude_m + 7.0))
    pilot.run_until(lambda: pilot.custom_mode() == HOLD, 15.0)
    pilot.run(3.0)
    assert pilot.position[2] == pytest.approx(7.0, abs=0.3)


@pytest.mark.slow
def test_a_takeoff_in_the_air_climbs_by_the_parameters_height() -> None:
    pilot = Pilot()
    pilot.take_off(4.0)
    pilot.step(set_mode(4, 2))
    pilot.run_until(lambda: pilot.custom_mode() == HOLD, 15.0)
    pilot.run(3.0)
    assert pilot.position[2] == pytest.approx(4.0 + 2.5, abs=0.3)


@pytest.mark.slow
def test_return_climbs_comes_home_and_lands() -> None:
    pilot = with_parameters(RTL_RETURN_ALT=12.0)
    pilot.take_off()
    pilot.run(8.0, lambda _t: at(25.0, 10.0, -5.0))
    pilot.step(set_mode(4, 5))
    pilot.run_until(lambda: pilot.position[2] > 11.0, 20.0)
    assert hypot(pilot.position[0], pilot.position[1]) > 20.0
    pilot.run_until(lambda: not pilot.is_armed(), 60.0)
    assert hypot(pilot.position[0], pilot.position[1]) < 0.7


@pytest.mark.slow
def test_a_moved_origin_moves_the_local_frame_under_the_vehicle() -> None:
    pilot = Pilot()
    pilot.take_off()
    pilot.run(0.1)
    before, resets = pilot.last("LOCAL_POSITION_NED"), pilot.last("ODOMETRY").reset_counter
    origin = pilot.node.memory.places.origin.frame.origin
    # 3 m north: 3 / (a meridian's 111.2 km to a degree)
    latitude = round(np.degrees(origin.latitude_rad) * 1e7 + 3.0 / 111_250.0 * 1e7)
    longitude = round(np.degrees(origin.longitude_rad) * 1e7)
    place = (latitude, longitude, round(origin.altitude_m * 1e3))
    pilot.step(mavlink.MAVLink_set_gps_global_origin_message(1, *place))
    pilot.run(0.1)
    after = pilot.last("LOCAL_POSITION_NED")
    assert before.x - after.x == pytest.approx(3.0, abs=0.02)
    assert pilot.last("ODOMETRY").reset_counter == resets + 1
    assert pilot.last("GPS_GLOBAL_ORIGIN").latitude == latitude
    pilot.run(5.0, lambda _t: at(0.0, 0.0, -5.0))
    assert pilot.position[1] == pytest.approx(3.0, abs=0.1)
