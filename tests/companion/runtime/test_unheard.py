"""What is said of an autopilot that was not heard: the cause, as far as what came instead tells it."""

import pytest

from companion.autopilots.choice import check_autopilot
from link.errors import UserError
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.mavlink.session import MavlinkSession
from link.mavlink.signing import Signing
from tests.link.mavlink.fake_autopilot import START_NS, S

KEY, OTHER_KEY = bytes(range(32)), bytes(32)
DEVICE = "/dev/ttyACM0,115200"
HEARTBEAT = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4, 0, 0, 3, 3)
REFUSED = "3 messages were refused: not signed with this --signing-key, or the autopilot's time is more than a minute"


def _heard(*senders: MavlinkCodec, key: bytes | None = KEY) -> MavlinkSession:
    """A session of system 1 with `key` that was sent three heartbeats by each sender."""
    session = MavlinkSession(1, target_system_id=1, signing=None if key is None else Signing(key))
    session.poll(START_NS)
    for _ in range(3):
        for sender in senders:
            session.receive(sender.encode(HEARTBEAT), START_NS)
    return session


def _signed(key: bytes, late_s: int = 0, system_id: int = 1) -> MavlinkCodec:
    signing = Signing(key)
    signing.advance(START_NS - late_s * S)
    return MavlinkCodec(system_id, 1, signing=signing)


def _said(session: MavlinkSession) -> str:
    with pytest.raises(UserError, match=f"no heartbeat of an autopilot within 60 s on {DEVICE}: ") as error:
        check_autopilot(session, DEVICE, 60.0)
    return str(error.value)


@pytest.mark.parametrize("sender", [_signed(OTHER_KEY), MavlinkCodec(1, 1), _signed(KEY, late_s=120)])
def test_autopilot_whose_messages_are_refused_is_told_by_its_signatures(sender: MavlinkCodec) -> None:
    said = _said(_heard(sender))
    assert REFUSED in said
    assert "give both the same key and the right time" in said
    assert "port" not in said


def test_other_systems_and_refused_messages_are_both_told() -> None:
    said = _said(_heard(_signed(KEY, system_id=7), _signed(OTHER_KEY)))
    assert "autopilots of system 7 were heard, see --system-id" in said
    assert REFUSED in said


def test_without_a_key_the_device_and_the_port_are_named() -> None:
    assert _said(_heard(key=None)).endswith("nothing was received; check --mavlink and the autopilot's port")
    assert "see --system-id" in _said(_heard(MavlinkCodec(7, 1), key=None))
    ground_station = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 4, 3)
    session = MavlinkSession(1, target_system_id=1)
    session.receive(MavlinkCodec(1, 1).encode(ground_station), START_NS)
    assert "bytes received, 1 messages, none of them its heartbeat; check --mavlink" in _said(session)


def test_bytes_without_a_message_are_blamed_on_the_baud_rate() -> None:
    session = MavlinkSession(1, target_system_id=1)
    session.receive(bytes(range(0, 250, 7)) * 20, START_NS)
    assert "720 bytes received, and no message in them: check the baud rate" in _said(session)


def test_autopilot_that_is_heard_passes() -> None:
    check_autopilot(_heard(_signed(KEY)), DEVICE, 60.0)
