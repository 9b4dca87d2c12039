from math import cos, degrees, nan, radians, sin

import numpy as np
import pytest

from link.frames.rotations import roll_pitch_yaw_of
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.setpoints.attitude import attitude_from_message
from tests.sim_autopilot.pilot import OFFBOARD, POSITION_ONLY, Pilot
from tests.sim_autopilot.planner import EAST_M, LATITUDE, LONGITUDE, NORTH_M

HOVER = 0.5  # MPC_THR_HOVER
RATES_IGNORED, ATTITUDE_IGNORED, THRUST_IGNORED = 7, 128, 64


def target(
    roll: float = 0.0,
    *,
    mask: int = RATES_IGNORED,
    yaw_rate: float = 0.0,
    thrust: float = HOVER,
    w: float | None = None,
) -> Message:
    q = (cos(roll / 2.0) if w is None else w, sin(roll / 2.0), 0.0, 0.0)
    return mavlink.MAVLink_set_attitude_target_message(0, 1, 1, mask, q, 0.0, 0.0, yaw_rate, thrust)


def hovering() -> Pilot:
    pilot = Pilot()
    pilot.take_off(10.0)
    return pilot


@pytest.mark.slow
def test_an_attitude_is_flown_in_its_own_frame() -> None:
    pilot = hovering()
    pilot.run(1.0, lambda _t: target(radians(10.0)))
    roll, pitch, yaw = map(degrees, roll_pitch_yaw_of(pilot.node.state.orientation_wxyz.tolist()))
    assert (roll, pitch, yaw) == pytest.approx((10.0, 0.0, 90.0), abs=0.6)  # its nose to the north
    assert pilot.custom_mode() == OFFBOARD
    assert pilot.node.state.velocity_enu_m_s[0] > 1.0  # it leans to the right of north: east


@pytest.mark.slow
def test_rates_are_flown_without_an_attitude() -> None:
    pilot = hovering()
    pilot.run(1.0, lambda _t: target(mask=ATTITUDE_IGNORED, yaw_rate=0.4))
    assert pilot.node.state.angular_velocity_flu_rad_s == pytest.approx((0.0, 0.0, -0.4), abs=0.03)


@pytest.mark.slow
def test_more_thrust_climbs_and_hover_thrust_holds() -> None:
    pilot = hovering()
    pilot.run(1.0, lambda _t: target())
    assert abs(pilot.node.state.velocity_enu_m_s[2]) < 0.2
    pilot.run(1.0, lambda _t: target(thrust=0.6))
    assert pilot.node.state.velocity_enu_m_s[2] == pytest.approx(0.2 * 9.81, abs=0.5)


@pytest.mark.slow
def test_position_control_takes_over_from_an_attitude_without_a_bump() -> None:
    pilot = hovering()
    pilot.run(0.5, lambda _t: target())
    at = pilot.position.copy()
    message = mavlink.MAVLink_set_position_target_local_ned_message(
        0, 1, 1, 1, POSITION_ONLY, at[1], at[0], -at[2], 0, 0, 0, 0, 0, 0, 0, 0
    )
    pilot.run(1.0, lambda _t: message)
    assert np.linalg.norm(pilot.position - at) < 0.1


@pytest.mark.parametrize(
    "wrong",
    [
        target(mask=RATES_IGNORED | ATTITUDE_IGNORED),
        target(mask=RATES_IGNORED | THRUST_IGNORED),
        target(thrust=nan),
        target(w=nan),
        target(w=0.0),
    ],
)
def test_an_attitude_that_cannot_be_flown_is_dropped(wrong: Message) -> None:
    assert attitude_from_message(wrong, HOVER) is None


@pytest.mark.slow
def test_a_global_setpoint_goes_where_it_says() -> None:
    pilot = hovering()
    x, y = round(LATITUDE + 6.0 * NORTH_M), round(LONGITUDE + 8.0 * EAST_M)
    frame = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
    message = mavlink.MAVLink_set_position_target_global_int_message(
        0, 1, 1, frame, POSITION_ONLY, x, y, 9.0, 0, 0, 0, 0, 0, 0, 0, 0
    )
    pilot.run(12.0, lambda _t: message)  # PX4's integral swings through a bare place and back
    assert pilot.position == pytest.approx((8.0, 6.0, 9.12), abs=0.2)
