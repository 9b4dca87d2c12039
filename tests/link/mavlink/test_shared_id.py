"""Two autopilots under one system id are told from one that is heard twice, restarts, or is imitated."""

import pytest

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.mavlink.session import MavlinkSession
from link.memory_link import MemoryLink
from tests.link.mavlink.fake_autopilot import MS, START_NS, FakeAutopilot, Pair, S


def other(booted_later_s: float) -> FakeAutopilot:
    one = FakeAutopilot()
    one.boot_at_ns += round(booted_later_s * S)
    return one


def run_both(session: MavlinkSession, autopilots: list[FakeAutopilot], t_ns: int, duration_s: float) -> int:
    """Run them on one perfect link, and return the time at its end."""
    for _ in range(round(duration_s * 200)):
        t_ns += 5 * MS
        for one in autopilots:
            one.tick(t_ns)
            for data in one.take_output():
                session.receive(data, t_ns)
        session.poll(t_ns)
        for frame in session.take_output():
            for one in autopilots:
                one.receive(frame, t_ns)
    return t_ns


@pytest.mark.parametrize("booted_later_s", [-300.0, -2.3, -0.04, 0.04, 0.7, 15.0])
def test_two_autopilots_under_one_id_are_noticed_within_a_second(booted_later_s: float) -> None:
    session = MavlinkSession(1)
    t_ns = run_both(session, [FakeAutopilot(), other(booted_later_s)], START_NS, 1.0)
    assert session.is_id_shared(t_ns)


def test_second_autopilot_that_has_gone_is_forgotten_ten_seconds_later() -> None:
    session, stays = MavlinkSession(1), FakeAutopilot()
    t_ns = run_both(session, [stays, other(7.0)], START_NS, 3.0)
    t_ns = run_both(session, [stays], t_ns, 8.0)
    assert session.is_id_shared(t_ns)
    t_ns = run_both(session, [stays], t_ns, 2.0)
    assert not session.is_id_shared(t_ns)


@pytest.mark.parametrize("drift", [-0.025, 0.025])
def test_one_autopilot_is_no_two_on_a_link_that_doubles_and_overtakes(drift: float) -> None:
    pair = Pair(session=MavlinkSession(1), autopilot=FakeAutopilot(drift=drift))
    pair.up = MemoryLink(seed=3, delay_s=0.3, jitter_s=0.3, duplication=0.7)
    pair.down = MemoryLink(seed=4, delay_s=0.2, jitter_s=0.2, duplication=0.7)
    for _ in range(60):
        pair.run(0.5)
        assert not pair.session.is_id_shared(pair.t_ns)


def test_autopilot_that_restarts_is_no_two() -> None:
    pair = Pair(session=MavlinkSession(1), autopilot=FakeAutopilot())
    pair.up = MemoryLink(seed=3, delay_s=0.3, duplication=1.0)
    for _ in range(5):
        pair.run(3.0)
        pair.autopilot.restart(pair.t_ns)
        pair.run(1.0)
        assert not pair.session.is_id_shared(pair.t_ns)


@pytest.mark.parametrize("forged", [1, 2])
def test_answer_that_is_forged_once_or_twice_makes_no_second_autopilot(forged: int) -> None:
    session, autopilot, forger = MavlinkSession(1), FakeAutopilot(), MavlinkCodec(1, 1)
    t_ns = run_both(session, [autopilot], START_NS, 0.5)
    questions = [message.ts1 for message in autopilot.of_type("TIMESYNC")][-forged:]
    for asked_ns in questions:
        for tc1 in (5 * S, 90 * S):
            session.receive(forger.encode(mavlink.MAVLink_timesync_message(tc1=tc1, ts1=asked_ns)), t_ns)
    assert not session.is_id_shared(t_ns)


def test_answers_to_others_questions_tell_nothing() -> None:
    session, autopilot, sender = MavlinkSession(1), FakeAutopilot(), MavlinkCodec(1, 1)
    t_ns = run_both(session, [autopilot], START_NS, 0.5)
    for asked_ns in (3, 4, 5, 6):
        for tc1 in (5 * S, 90 * S):
            session.receive(sender.encode(mavlink.MAVLink_timesync_message(tc1=tc1, ts1=asked_ns)), t_ns)
    assert not session.is_id_shared(t_ns)
