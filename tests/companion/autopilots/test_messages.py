"""SET_POSITION_TARGET_LOCAL_NED: frame, masks and refusal of what is not a number."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.autopilots.messages import local_ned_setpoint
from companion.core.data import Setpoint
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.records import replace

SETPOINT = Setpoint(
    t_ns=0,
    position_enu_m=(1.0, 2.0, 3.0),
    velocity_enu_m_s=(4.0, 5.0, 6.0),
    acceleration_enu_m_s2=(0.7, 0.8, 0.9),
    yaw_rad=0.3,
)


def test_vectors_are_turned_to_ned_and_yaw_to_a_heading() -> None:
    message = local_ned_setpoint(SETPOINT, 1234, 7)
    assert (message.x, message.y, message.z) == (2.0, 1.0, -3.0)
    assert (message.vx, message.vy, message.vz) == (5.0, 4.0, -6.0)
    assert (message.afx, message.afy, message.afz) == (0.8, 0.7, -0.9)
    assert message.yaw == pytest.approx(math.pi / 2 - 0.3)
    assert (message.time_boot_ms, message.target_system) == (1234, 7)
    assert message.coordinate_frame == mavlink.MAV_FRAME_LOCAL_NED


@pytest.mark.parametrize(
    ("setpoint", "ignored"),
    [
        (SETPOINT, {11}),
        (replace(SETPOINT, velocity_enu_m_s=None), {3, 4, 5, 11}),
        (replace(SETPOINT, acceleration_enu_m_s2=None), {6, 7, 8, 11}),
        (replace(SETPOINT, velocity_enu_m_s=None, acceleration_enu_m_s2=None), {3, 4, 5, 6, 7, 8, 11}),
    ],
)
def test_groups_are_left_out_whole_and_yaw_is_always_sent(setpoint: Setpoint, ignored: set[int]) -> None:
    message = local_ned_setpoint(setpoint, 0, 1)
    assert {bit for bit in range(16) if message.type_mask >> bit & 1} == ignored


numbers = st.floats()
vectors = st.tuples(numbers, numbers, numbers)


@given(position=vectors, velocity=st.none() | vectors, acceleration=st.none() | vectors, yaw=numbers)
def test_what_is_sent_is_finite_or_nothing(
    position: tuple[float, float, float],
    velocity: tuple[float, float, float] | None,
    acceleration: tuple[float, float, float] | None,
    yaw: float,
) -> None:
    setpoint = replace(
        SETPOINT, position_enu_m=position, velocity_enu_m_s=velocity, acceleration_enu_m_s2=acceleration, yaw_rad=yaw
    )
    values = (*position, *(velocity or ()), *(acceleration or ()), yaw)
    try:
        message = local_ned_setpoint(setpoint, 0, 1)
    except ValueError:
        assert not all(abs(value) < 1e6 for value in values)
        return
    assert all(map(math.isfinite, values))
    assert MavlinkCodec(1, 191).encode(message)


def test_boot_time_wraps_as_its_field_does() -> None:
    assert local_ned_setpoint(SETPOINT, 2**32 + 5, 1).time_boot_ms == 5
