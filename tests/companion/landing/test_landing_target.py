"""LANDING_TARGET in the frames that the two firmwares take."""

import math

import numpy as np
import pytest

from companion.core.data import OwnState
from companion.landing.guiding import landing_target
from link.frames.rotations import matrix_from_quaternion, quaternion_from_roll_pitch_yaw
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.messages import Vector3

ROLL_PITCH_YAW = (0.2, -0.3, 0.9)
OWN = OwnState(
    t_ns=0,
    position_enu_m=(10.0, -4.0, 7.0),
    velocity_enu_m_s=(0.0, 0.0, 0.0),
    orientation_wxyz=quaternion_from_roll_pitch_yaw(*ROLL_PITCH_YAW),
    angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
)
PAD = (13.0, -2.5, 1.5)


def _sent(*, in_body_axes: bool, place: Vector3 = PAD) -> Message:
    message = landing_target(place, 0.4, OWN, in_body_axes=in_body_axes, local_ns=5_000_000)
    assert message is not None
    (heard,) = MavlinkCodec(1, 1).decode(MavlinkCodec(1, 191).encode(message))
    return heard


def _matrix_of(q: tuple[float, ...]) -> np.ndarray:
    return matrix_from_quaternion(q)


def test_arducopter_turns_the_way_back_to_the_pad_by_its_own_attitude() -> None:
    heard = _sent(in_body_axes=True)
    assert (heard.frame, heard.position_valid, heard.time_usec) == (mavlink.MAV_FRAME_BODY_FRD, 1, 5000)
    # As AC_PrecLand does: a unit vector times the distance, turned by the attitude, here in forward, left, up.
    way_flu = np.array([heard.x, -heard.y, -heard.z])
    unit = way_flu / np.linalg.norm(way_flu)
    back = matrix_from_quaternion(OWN.orientation_wxyz) @ unit * heard.distance
    assert np.array(OWN.position_enu_m) + back == pytest.approx(PAD, abs=1e-5)


def test_px4_is_told_the_place_in_its_local_frame() -> None:
    heard = _sent(in_body_axes=False)
    assert (heard.frame, heard.position_valid) == (mavlink.MAV_FRAME_LOCAL_NED, 1)
    assert (heard.y, heard.x, -heard.z) == pytest.approx(PAD)


def test_pads_heading_is_told_in_the_same_frame() -> None:
    forward_ned = _matrix_of(tuple(_sent(in_body_axes=False).q)) @ [1.0, 0.0, 0.0]
    assert (forward_ned[1], forward_ned[0]) == pytest.approx((math.cos(0.4), math.sin(0.4)), abs=1e-6)
    x, y, z = _matrix_of(tuple(_sent(in_body_axes=True).q)) @ [1.0, 0.0, 0.0]
    forward = matrix_from_quaternion(OWN.orientation_wxyz) @ [x, -y, -z]
    assert forward == pytest.approx((math.cos(0.4), math.sin(0.4), 0.0), abs=1e-6)


@pytest.mark.parametrize("place", [(math.nan, 0.0, 0.0), (1e6, 0.0, 0.0), (math.inf, 0.0, 0.0)])
def test_absurd_place_is_not_told(place: Vector3) -> None:
    assert landing_target(place, None, OWN, in_body_axes=True, local_ns=1) is None
