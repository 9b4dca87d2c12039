"""MAVLink 2 signing as the real autopilots do it; the client signs by pymavlink."""

import hashlib

from link.mavlink.dialect import Message, mavlink
from link.mavlink.signing import signing_timestamp
from tests.sim_autopilot.clients import Clients, beat
from tests.sim_autopilot.copter import ardupilot
from tests.sim_autopilot.pilot import START_NS, arm, command, px4

KEY = hashlib.sha256(b"decklander").digest()
OTHER_KEY = hashlib.sha256(b"another").digest()
NOW = signing_timestamp(START_NS)
SECOND = 100_000  # in the signatures' unit


def setup(key: bytes = KEY, system: int = 1) -> Message:
    return mavlink.MAVLink_setup_signing_message(system, 1, key, NOW)


def signed(message: Message, *, key: bytes = KEY, late_s: int = 0) -> bytes:
    """What a ground station that knows a key sends."""
    other = mavlink.MAVLink(None, srcSystem=255, srcComponent=190)
    other.signing.secret_key, other.signing.sign_outgoing = key, True
    other.signing.timestamp = NOW + 10 * SECOND - late_s * SECOND
    return bytes(message.pack(other))


def question() -> Message:
    return command(mavlink.MAV_CMD_REQUEST_MESSAGE, float(mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION))


def unsigned() -> bytes:
    return bytes(question().pack(mavlink.MAVLink(None, srcSystem=255, srcComponent=190)))


def answers(clients: Clients, link: int, data: bytes) -> int:
    clients.forget()
    clients.send_bytes(link, data)
    clients.run(0.05)
    return clients.counts(link)["COMMAND_ACK"]


def test_everything_is_signed_on_every_link_as_soon_as_a_key_was_sent_and_no_answer_tells_so() -> None:
    clients = Clients(ardupilot())
    clients.send(0, setup())
    clients.run(2.0)
    assert clients.counts(0)["COMMAND_ACK"] == 0
    listener = mavlink.MAVLink(None)
    listener.signing.secret_key = KEY
    for link in (0, 1):
        frames = [message.get_msgbuf() for message in clients.heard[link]]
        assert frames
        assert all(listener.decode(bytearray(frame)).get_link_id() == link for frame in frames)


def test_the_first_link_still_takes_unsigned_frames_and_the_others_refuse_them() -> None:
    clients = Clients(ardupilot())
    clients.send(0, setup())
    clients.run(0.05)
    assert [answers(clients, link, unsigned()) for link in (0, 1)] == [1, 0]
    assert answers(clients, 1, signed(question())) == 1


def test_wrong_key_replay_and_half_a_minute_late_are_refused() -> None:
    clients = Clients(ardupilot())
    clients.send(0, setup())
    clients.run(0.05)
    frame = signed(question())
    assert [answers(clients, 1, data) for data in (signed(question(), key=OTHER_KEY), frame, frame)] == [0, 1, 0]
    assert answers(clients, 1, signed(question(), late_s=30)) == 0
    assert clients.node.statistics[1].refused_messages == 3


def test_a_key_sent_while_armed_or_for_another_system_changes_nothing() -> None:
    clients = Clients(ardupilot())
    clients.send(0, setup(system=2))
    clients.run(0.05)
    assert answers(clients, 1, unsigned()) == 1
    clients.send(0, command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, 4.0), arm())
    clients.run(0.05)
    clients.send(0, setup())
    clients.run(0.05)
    assert clients.node.memory.armed_ns is not None
    assert answers(clients, 1, unsigned()) == 1


def test_a_key_of_zeros_ends_the_signing() -> None:
    clients = Clients(ardupilot())
    for key in (KEY, bytes(32)):
        clients.send(0, setup(key))
        clients.run(0.05)
    assert answers(clients, 1, unsigned()) == 1
    assert not any(message.get_msgbuf()[2] for message in clients.heard[1])


def test_px4_takes_signed_frames_unchecked_and_signs_nothing() -> None:
    clients = Clients(px4())
    clients.send(0, setup(), beat())
    clients.run(0.05)
    assert answers(clients, 1, signed(question(), key=OTHER_KEY)) == 1
    assert answers(clients, 1, unsigned()) == 1
    assert not any(message.get_msgbuf()[2] for message in clients.heard[1])
