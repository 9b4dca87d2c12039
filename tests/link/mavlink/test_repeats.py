"""Frames that a network delivers again count once, whatever else the link does; those that are only alike all count."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.events import AutopilotRestarted, MessageReceived
from link.mavlink.session import MavlinkSession
from tests.link.mavlink.fake_autopilot import MS, START_NS, S, of_kind

PERIOD_NS = 4 * MS  # 250 a second


def heartbeat(mode: int) -> Message:
    return mavlink.MAVLink_heartbeat_message(2, mavlink.MAV_AUTOPILOT_PX4, 0x51, mode, 4, 3)


def heard(frames: list[bytes], period_ns: int = PERIOD_NS) -> tuple[list[Message], MavlinkCodec]:
    codec = MavlinkCodec(1, 191)
    taken = [
        message
        for place, frame in enumerate(frames)
        for message in codec.decode(frame, t_ns=START_NS + place * period_ns, is_datagram=True)
    ]
    return taken, codec


@given(
    again=st.lists(st.tuples(st.integers(0, 299), st.integers(1, 120)), max_size=20),
    lost=st.sets(st.integers(1, 299), max_size=60),
)
@settings(max_examples=20)
def test_each_frame_of_an_autopilot_counts_once_however_often_it_comes_and_whether_the_first_was_lost(
    again: list[tuple[int, int]], lost: set[int]
) -> None:
    sender = MavlinkCodec(1, 1)
    sent = [sender.encode(heartbeat(number)) for number in range(300)]
    way = [(float(number), number) for number in range(300) if number not in lost]
    way += [(number + later + 0.5, number) for number, later in again]
    taken, codec = heard([sent[number] for _, number in sorted(way)])
    modes = [message.custom_mode for message in taken]
    assert sorted(modes) == sorted({number for _, number in way})
    assert codec.statistics.repeated_messages == len(way) - len(modes)


@pytest.mark.parametrize("later", [100, 200, 254, 257, 400, 3000])
def test_frame_that_comes_again_counts_once_however_far_the_numbers_have_gone_around(later: int) -> None:
    sender = MavlinkCodec(1, 1)
    sent = [sender.encode(heartbeat(number)) for number in range(later + 1)]
    taken, codec = heard([*sent, sent[0]])
    assert [message.custom_mode for message in taken] == list(range(later + 1))
    assert codec.statistics.lost_messages == 0


def test_report_that_stays_as_it_is_counts_each_time_though_its_number_comes_around() -> None:
    sender = MavlinkCodec(1, 1)
    sent = [sender.encode(heartbeat(number % 256)) for number in range(2000)]
    assert sent[0] == sent[256]
    taken, codec = heard(sent)
    assert (len(taken), codec.statistics.repeated_messages) == (2000, 0)


def test_link_stays_up_even_if_each_heartbeat_looks_like_the_one_before() -> None:
    frame, session, others = MavlinkCodec(1, 1).encode(heartbeat(4)), MavlinkSession(1), MavlinkCodec(1, 1)
    for step in range(150):  # 0.2 s each
        t_ns = START_NS + step * S // 5
        if step % 5 == 0:
            session.receive(frame, t_ns)
        session.receive(others.encode(mavlink.MAVLink_ping_message(step, step, 0, 0)), t_ns)
        session.poll(t_ns)
        assert session.link_up


@pytest.mark.parametrize("sender", [(255, 190), (1, 191), (1, 154)])
def test_orders_of_a_script_that_begins_its_numbers_anew_all_count(sender: tuple[int, int]) -> None:
    order = mavlink.MAVLink_command_long_message(1, 191, mavlink.MAV_CMD_DO_PAUSE_CONTINUE, 0, *[0.0] * 7)
    taken, _ = heard([MavlinkCodec(*sender).encode(order) for _ in range(3)])
    assert len(taken) == 3


def test_frames_that_come_again_are_recorded_as_they_came() -> None:
    frame, codec = MavlinkCodec(1, 1).encode(heartbeat(4)), MavlinkCodec(1, 191, records_input=True)
    for _ in range(2):
        codec.decode(frame, t_ns=START_NS)
    assert codec.take_input() == [frame, frame]


def test_frames_of_one_instant_that_come_late_are_no_restart_soon_after_booting() -> None:
    """When hardly more has passed since boot than the datagram is late, only a clock that runs on tells a restart."""
    session, sender, events = MavlinkSession(1, target_system_id=1), MavlinkCodec(1, 1), []
    for boot_ms in (1_500, 100, 100, 100, 100, 1_520):
        events += session.receive(sender.encode(mavlink.MAVLink_attitude_message(boot_ms, *[0.0] * 6)), START_NS)
    assert of_kind(events, AutopilotRestarted) == []
    assert [one.message.time_boot_ms for one in of_kind(events, MessageReceived)] == [1_500, 1_520]
