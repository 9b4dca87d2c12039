"""Attachments byte for byte, and the id of a publisher from its token."""

import pytest
import zenoh.ext

from link.ros2.attachment import Attachment, decode, encode, publisher_id

# As `ros2 topic pub /chatter` of an rmw_zenoh 0.10 (ROS 2 Lyrical) sent it: tests of the Go package rmwzenoh of
# conductor.dev. Our id is computed from the token and must be the one that the real publisher had.
CAPTURED_KEY = (
    "@ros2_lv/0/cb6e75cf8194a4d81370b618e0a4ed07/0/4/MP/%/%/_ros2cli_413596/%chatter/std_msgs::msg::dds_::String_/"
    "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18/::,10:,:,:,,"
)
CAPTURED = bytes.fromhex("1b0000000000000040a1c53a897cc618101236acd8c8370ad4e6ed96c021a8b85e")
# As pyzeros 0.1.0 makes it for this token.
PYZEROS_KEY = (
    "@ros2_lv/7/e48c71bd01fa52f27af91cad59ce8fdb/0/1/MP/%/%localization/ekf_localizer/%localization%kinematic_state/"
    "nav_msgs::msg::dds_::Odometry_/RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0/::,1:,:,:,,"
)
PYZEROS = bytes.fromhex("050000000000000015cd55f55172861810e46af16e440cd12c63932dade2ccd6bf")


def test_attachment_of_a_real_publisher_is_written_and_read() -> None:
    told = Attachment(sequence=0x1B, source_time_ns=0x18C67C893AC5A140, publisher_id=publisher_id(CAPTURED_KEY))
    assert encode(told) == CAPTURED
    assert decode(CAPTURED) == told


def test_attachment_of_pyzeros_is_written_and_read() -> None:
    told = Attachment(sequence=5, source_time_ns=1_767_225_600_123_456_789, publisher_id=publisher_id(PYZEROS_KEY))
    assert encode(told) == PYZEROS
    assert decode(PYZEROS) == told


def test_bytes_are_those_of_zenohs_own_serializer() -> None:
    told = Attachment(sequence=-7, source_time_ns=1_234_567_890_123, publisher_id=bytes(range(3, 19)))
    theirs = zenoh.ext.z_serialize((zenoh.ext.Int64(-7), zenoh.ext.Int64(1_234_567_890_123), bytes(range(3, 19))))
    assert encode(told) == theirs.to_bytes()


@pytest.mark.parametrize("data", [b"", CAPTURED[:-1], CAPTURED + b"\0", CAPTURED[:16] + b"\x0f" + CAPTURED[17:]])
def test_other_bytes_are_no_attachment(data: bytes) -> None:
    assert decode(data) is None
