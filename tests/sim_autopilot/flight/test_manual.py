from collections.abc import Callable
from math import degrees, hypot

import pytest

from link.frames.rotations import roll_pitch_yaw_of
from link.mavlink.dialect import Message, mavlink
from tests.sim_autopilot.pilot import HOLD, OFFBOARD, POSITION, RTL, Pilot, set_mode

pytestmark = pytest.mark.slow


def sticks(pitch: int = 0, roll: int = 0, throttle: int = 500, yaw: int = 0) -> Callable[[float], Message]:
    message = mavlink.MAVLink_manual_control_message(1, pitch, roll, throttle, yaw, 0)
    return lambda _t: message


def flying(main: int) -> Pilot:
    pilot = Pilot()
    pilot.take_off(10.0)
    pilot.run(0.2, sticks())
    pilot.acknowledged(set_mode(main))
    return pilot


def tilt(pilot: Pilot) -> tuple[float, float, float]:
    roll, pitch, yaw = roll_pitch_yaw_of(pilot.node.state.orientation_wxyz.tolist())
    return degrees(roll), degrees(pitch), degrees(yaw)


def test_position_mode_flies_the_sticks_velocity_and_holds_when_they_are_centred() -> None:
    pilot = flying(3)
    pilot.run(6.0, sticks(pitch=550))
    assert hypot(*pilot.node.state.velocity_enu_m_s[:2]) == pytest.approx(5.0, abs=0.15)  # half of MPC_VEL_MANUAL
    pilot.run(4.0, sticks())
    stopped = pilot.position.copy()
    pilot.run(2.0, sticks())
    assert pilot.position == pytest.approx(stopped, abs=0.1)
    assert pilot.custom_mode() == POSITION


def test_altitude_mode_keeps_height_while_the_drone_leans() -> None:
    pilot = flying(2)
    pilot.run(2.0, sticks(roll=300))
    assert tilt(pilot)[0] == pytest.approx(0.3 * 35.0, abs=1.0)  # MPC_MAN_TILT_MAX
    assert pilot.position[2] == pytest.approx(10.0, abs=0.3)


def test_stabilised_thrust_is_the_sticks_and_its_middle_hovers() -> None:
    pilot = flying(7)
    pilot.run(1.0, sticks())
    assert abs(pilot.node.state.velocity_enu_m_s[2]) < 0.5
    pilot.run(1.0, sticks(throttle=700))
    assert pilot.node.state.velocity_enu_m_s[2] > 2.0


def test_the_yaw_stick_turns_clockwise() -> None:
    pilot = flying(2)
    before = tilt(pilot)[2]
    pilot.run(1.0, sticks(yaw=200))
    assert (before - tilt(pilot)[2]) % 360.0 == pytest.approx(150.0 / 9.0, abs=4.0)  # a tenth beyond the dead zone


def test_channels_do_what_the_sticks_do() -> None:
    pilot = flying(2)
    channels = mavlink.MAVLink_rc_channels_override_message(1, 1, 1650, 1500, 1500, 1500, 0, 0, 0, 0)
    pilot.run(2.0, lambda _t: channels)
    assert tilt(pilot)[0] == pytest.approx(0.3 * 35.0, abs=1.0)


def test_moved_sticks_take_over_from_the_modes_that_the_parameter_names() -> None:
    pilot = flying(4)
    pilot.acknowledged(set_mode(4, 3))
    pilot.run(0.2, sticks())
    assert pilot.custom_mode() == HOLD
    pilot.run(0.2, sticks(pitch=600))
    assert pilot.custom_mode() == POSITION  # COM_RC_OVERRIDE 1
    hovering = Pilot()
    hovering.take_off(3.0)
    hovering.step(sticks()(0.0))
    hovering.step(sticks(pitch=600)(0.0))
    assert hovering.custom_mode() == OFFBOARD


def test_sticks_that_are_let_go_of_are_waited_for_in_hold_and_then_bring_it_home() -> None:
    pilot = flying(3)
    pilot.step(mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3))
    pilot.run(0.4)
    assert pilot.custom_mode() == POSITION
    pilot.run(0.3)
    assert (pilot.custom_mode(), pilot.node.memory.modes.failsafe) == (HOLD, True)
    assert pilot.last("STATUSTEXT").text == "Failsafe activated: entering Hold for 5 seconds\t"
    pilot.run(4.0, sticks())  # they are back, which changes nothing
    assert pilot.custom_mode() == HOLD
    pilot.run(1.0)
    assert pilot.custom_mode() == RTL


def test_a_mode_that_is_asked_for_ends_the_wait_for_the_sticks() -> None:
    pilot = flying(3)
    pilot.run(1.0)
    pilot.acknowledged(set_mode(4, 3))
    pilot.run(6.0)
    assert (pilot.custom_mode(), pilot.node.memory.modes.failsafe) == (HOLD, False)
