import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.events import (
    AutopilotRestarted,
    CommandTimedOut,
    Event,
    LinkFound,
    LinkLost,
    LinkRegained,
    MessageReceived,
)
from link.mavlink.requests import Retries
from link.mavlink.session import MavlinkSession
from link.mavlink.timesync import ClockSync
from tests.link.mavlink.fake_autopilot import (
    BOOTED_NS,
    MS,
    START_NS,
    U32,
    UTC_AHEAD_NS,
    FakeAutopilot,
    Pair,
    S,
    of_kind,
)

POSITION_ID = mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED


def pair(drift: float = 0.0) -> Pair:
    return Pair(session=MavlinkSession(1), autopilot=FakeAutopilot(drift=drift))


def heartbeat(kind: int, autopilot: int) -> Message:
    return mavlink.MAVLink_heartbeat_message(kind, autopilot, 0, 0, 4, 3)


def ack(target_system: int, target_component: int) -> Message:
    return mavlink.MAVLink_command_ack_message(400, 0, 0, 0, target_system, target_component)


def test_our_heartbeat_goes_out_once_a_second_as_an_onboard_controller() -> None:
    run = pair()
    run.run(10.0)
    beats = run.autopilot.of_type("HEARTBEAT")
    assert len(beats) == 10
    assert {(one.type, one.autopilot, one.get_srcSystem(), one.get_srcComponent()) for one in beats} == {
        (18, 8, 1, 191)
    }


def test_the_first_autopilot_heartbeat_is_adopted_once() -> None:
    run = pair()
    (found,) = of_kind(run.run(5.0), LinkFound)
    assert (found.system_id, found.component_id, found.autopilot, found.vehicle_type) == (1, 1, 12, 2)
    assert run.session.link_up


def test_ground_stations_and_companions_are_not_adopted() -> None:
    session = MavlinkSession(1)
    for sender, message in (
        (MavlinkCodec(255, 190), heartbeat(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID)),
        (MavlinkCodec(1, 154), heartbeat(mavlink.MAV_TYPE_GIMBAL, mavlink.MAV_AUTOPILOT_PX4)),
        (MavlinkCodec(2, 1), heartbeat(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_INVALID)),
    ):
        assert session.receive(sender.encode(message), START_NS) == []
    assert session.statistics.filtered_messages == 3


def test_what_is_no_autopilot_at_the_autopilots_address_tells_no_mode() -> None:
    session = MavlinkSession(1)
    autopilot, gimbal = MavlinkCodec(1, 1), MavlinkCodec(1, 1)
    beat = heartbeat(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4)
    stray = heartbeat(mavlink.MAV_TYPE_GIMBAL, mavlink.MAV_AUTOPILOT_INVALID)
    assert of_kind(session.receive(autopilot.encode(beat), START_NS), MessageReceived)
    assert session.receive(gimbal.encode(stray), START_NS) == []
    assert session.vehicle_type == mavlink.MAV_TYPE_QUADROTOR


def test_only_the_chosen_system_is_heard() -> None:
    session = MavlinkSession(4, target_system_id=4)
    beat = heartbeat(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4)
    assert session.receive(MavlinkCodec(1, 1).encode(beat), START_NS) == []
    assert session.other_system_ids == {1}
    assert len(of_kind(session.receive(MavlinkCodec(4, 1).encode(beat), START_NS), LinkFound)) == 1


def test_messages_for_others_are_filtered_and_broadcasts_are_not() -> None:
    session, sender = MavlinkSession(1, target_system_id=1), MavlinkCodec(1, 1)
    heard = {
        target: bool(session.receive(sender.encode(ack(*target)), START_NS))
        for target in ((1, 191), (0, 0), (1, 0), (255, 190), (1, 154))
    }
    assert heard == {(1, 191): True, (0, 0): True, (1, 0): True, (255, 190): False, (1, 154): False}


def test_silence_of_three_seconds_is_a_lost_link_and_its_end_a_regained_one() -> None:
    run = pair()
    run.run(5.0)
    run.autopilot.mute = True
    (lost,) = of_kind(run.run(10.0), LinkLost)
    assert 3 * S < lost.t_ns - lost.last_heard_ns <= 3 * S + 5 * MS
    assert not run.session.link_up
    run.autopilot.mute = False
    (regained,) = of_kind(run.run(2.0), LinkRegained)
    assert 9 * S < regained.silence_ns < 12 * S
    assert run.session.link_up


def test_six_missing_heartbeats_among_other_messages_are_a_lost_link_until_the_next_one() -> None:
    run = pair()
    run.run(5.0)
    run.autopilot.left_out = frozenset({mavlink.MAVLINK_MSG_ID_HEARTBEAT})
    (lost,) = of_kind(run.run(10.0), LinkLost)
    assert lost.t_ns - lost.last_heard_ns < 2 * S
    assert not run.session.link_up
    run.autopilot.left_out = frozenset()
    assert len(of_kind(run.run(2.0), LinkRegained)) == 1
    assert run.session.link_up


def test_link_lasts_while_the_mode_is_told_without_heartbeats() -> None:
    run = pair()
    run.run(5.0)
    run.autopilot.left_out = frozenset({mavlink.MAVLINK_MSG_ID_HEARTBEAT})
    for _ in range(10):
        run.autopilot.send(mavlink.MAVLink_current_mode_message(0, 6 << 16, 6 << 16))
        assert not of_kind(run.run(1.0), LinkLost)
    assert len(of_kind(run.run(10.0), LinkLost)) == 1


def test_clocks_of_a_running_link_map_to_utc_within_2_ms_at_any_drift() -> None:
    for drift in (-0.025, 0.025):
        run = pair(drift)
        run.run(8.0)
        clock = run.session.clock
        true_utc_ns = run.t_ns + UTC_AHEAD_NS
        assert abs(clock.local_to_utc_ns(run.t_ns) - true_utc_ns) < 2 * MS
        assert abs((clock.boot_to_utc_ns(run.autopilot.boot_ns(run.t_ns)) or 0) - true_utc_ns) < 2 * MS


def test_questions_for_the_time_come_quickly_at_first() -> None:
    run = pair()
    run.run(1.95)
    first = len(run.autopilot.of_type("TIMESYNC"))
    run.run(10.0)
    assert first == 20
    assert len(run.autopilot.of_type("TIMESYNC")) - first == 20


def test_the_autopilots_question_for_the_time_is_answered() -> None:
    run = pair()
    run.run(1.0)
    run.autopilot.send(mavlink.MAVLink_timesync_message(tc1=0, ts1=123_456))
    run.run(0.1)
    (answer,) = (one for one in run.autopilot.of_type("TIMESYNC") if one.ts1 == 123_456)
    assert abs(answer.tc1 - run.t_ns) < S


def test_answers_to_questions_from_before_a_restart_are_not_learned_from() -> None:
    sync = ClockSync()
    question = sync.poll(START_NS)
    assert question is not None
    sync.start_over()
    sync.timesync(mavlink.MAVLink_timesync_message(tc1=BOOTED_NS, ts1=question.ts1), START_NS + MS)
    assert sync.clock.local_to_boot is None


def test_questions_in_between_tell_that_the_autopilot_hears_and_nothing_of_the_clocks() -> None:
    sync = ClockSync()
    asked_ns = [t_ns for t_ns in range(START_NS, START_NS + 90 * MS, 5 * MS) if sync.poll(t_ns) is not None]
    assert (asked_ns, ClockSync().answers.sent_ns) == ([START_NS], None)
    sync.asks_often = True
    more_ns = [t_ns for t_ns in range(START_NS + 5 * MS, START_NS + 90 * MS, 5 * MS) if sync.poll(t_ns) is not None]
    assert more_ns == [START_NS + ms * MS for ms in (5, 25, 45, 65, 85)]
    sync.timesync(mavlink.MAVLink_timesync_message(tc1=BOOTED_NS, ts1=more_ns[1]), START_NS + 91 * MS)
    sync.timesync(mavlink.MAVLink_timesync_message(tc1=BOOTED_NS, ts1=more_ns[0]), START_NS + 92 * MS)
    assert sync.answers.sent_ns == more_ns[1]
    assert sync.clock.local_to_boot is None
    assert sync.round_trips == 0


def test_answers_go_on_from_the_first_after_a_gap() -> None:
    sync, since_ns = ClockSync(), []
    sync.asks_often = True
    for ms in range(0, 1000, 20):
        question = sync.poll(START_NS + ms * MS)
        if question is not None and not 300 <= ms < 520 and not 600 <= ms < 780:
            sync.timesync(mavlink.MAVLink_timesync_message(tc1=BOOTED_NS, ts1=question.ts1), START_NS + (ms + 9) * MS)
        since_ns.append(sync.answers.since_ns)
    assert set(since_ns) == {START_NS + 9 * MS, START_NS + 529 * MS}


def test_an_answer_in_unix_time_is_no_boot_time() -> None:
    sync = ClockSync()
    sync.poll(START_NS)
    sync.timesync(mavlink.MAVLink_timesync_message(tc1=START_NS, ts1=START_NS), START_NS + MS)
    assert sync.clock.local_to_boot is None


def test_a_restart_is_noticed_and_streams_and_clock_are_set_up_anew() -> None:
    run = pair()
    run.session.request_interval(POSITION_ID, 50.0, run.t_ns)
    run.run(4.0)
    run.autopilot.restart(run.t_ns)
    restarted_ns = run.t_ns
    events = run.run(6.0)
    (restart,) = of_kind(events, AutopilotRestarted)
    assert restart.t_ns - restarted_ns < 3 * S
    assert restart.boot_before_ns > BOOTED_NS > restart.boot_now_ns
    assert run.autopilot.intervals_ns == {POSITION_ID: 20 * MS}
    assert abs((run.session.clock.local_to_boot_ns(run.t_ns) or 0) - run.autopilot.boot_ns(run.t_ns)) < 2 * MS


DAY_MS = 86_400_000


@pytest.mark.parametrize("is_streaming", [False, True])
@pytest.mark.parametrize("booted_ms", [U32 - 3000, U32 + 3000, 3 * U32 + 5])
def test_boot_time_goes_on_after_the_50_days_that_its_32_bits_last(booted_ms: int, *, is_streaming: bool) -> None:
    run = pair()
    run.autopilot.boot_at_ns = START_NS - booted_ms * MS
    if is_streaming:  # before anybody has asked for the time
        run.autopilot.intervals_ns = {POSITION_ID: 20 * MS}
    else:
        run.session.request_interval(POSITION_ID, 50.0, run.t_ns)
    run.run(1.0)
    events = run.run(6.0)
    assert of_kind(events, AutopilotRestarted) == []
    received = [one.message for one in of_kind(events, MessageReceived)]
    told_ms = [one.time_boot_ms for one in received if one.get_msgId() == POSITION_ID]
    assert len(told_ms) > 290
    assert told_ms == sorted(told_ms)
    assert told_ms[-1] - told_ms[0] == pytest.approx(6000, abs=50)
    clock = run.session.clock
    assert abs((clock.local_to_boot_ns(run.t_ns) or 0) - told_ms[-1] * MS) < 30 * MS
    assert abs((clock.boot_to_utc_ns(told_ms[-1] * MS) or 0) - run.t_ns - UTC_AHEAD_NS) < 30 * MS


@pytest.mark.parametrize("is_streaming", [False, True])
@pytest.mark.parametrize("days", [26, 40, 51, 76])
def test_autopilot_that_restarts_after_weeks_is_heard_by_its_new_time(days: int, *, is_streaming: bool) -> None:
    run = pair()
    run.autopilot.boot_at_ns = START_NS - days * DAY_MS * MS
    run.session.request_interval(POSITION_ID, 50.0, run.t_ns)
    run.run(4.0)
    run.autopilot.restart(run.t_ns)
    if is_streaming:
        run.autopilot.intervals_ns = {POSITION_ID: 20 * MS}
    (restart,) = of_kind(run.run(6.0), AutopilotRestarted)
    assert restart.boot_now_ns < 3 * S
    assert abs((run.session.clock.local_to_boot_ns(run.t_ns) or 0) - run.autopilot.boot_ns(run.t_ns)) < 2 * MS


def test_a_command_under_way_does_not_outlive_a_restart() -> None:
    run = pair()
    run.autopilot.results[400] = ()
    run.session.request_interval(POSITION_ID, 50.0, run.t_ns)
    run.run(4.0)
    run.autopilot.restart(run.t_ns)
    ticket = run.session.command(400, (1.0,), run.t_ns, Retries(attempts=100))
    events = run.run(4.0)
    assert [one.ticket for one in of_kind(events, CommandTimedOut)] == [ticket]
    assert of_kind(events, CommandTimedOut)[0].t_ns == of_kind(events, AutopilotRestarted)[0].t_ns


def test_a_few_messages_that_are_seconds_late_are_no_restart_and_tell_nothing() -> None:
    session, sender = MavlinkSession(1, target_system_id=1), MavlinkCodec(1, 1)
    events = []
    for boot_ms in (60_000, 58_000, 58_100, 60_050, 57_900, 60_100):
        message = mavlink.MAVLink_local_position_ned_message(boot_ms, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        events += session.receive(sender.encode(message), START_NS)
    assert [one.message.time_boot_ms for one in of_kind(events, MessageReceived)] == [60_000, 60_050, 60_100]
    assert of_kind(events, AutopilotRestarted) == []


@pytest.mark.parametrize("late_ms", [1_200, 1_500, 10_000, 58_000])
@pytest.mark.parametrize("late_frames", [3, 30])
def test_datagram_that_is_held_up_on_its_way_is_no_restart(late_ms: int, late_frames: int) -> None:
    """An autopilot that has restarted cannot have been up for longer than since it was heard last."""
    session, sender = MavlinkSession(1, target_system_id=1), MavlinkCodec(1, 1)
    t_ns, events = START_NS, list[Event]()
    for step in range(60):
        boot_ms = 60_000 + 20 * step
        held_up = [boot_ms - late_ms + number for number in range(late_frames)] if step == 40 else []
        for one_ms in (*held_up, boot_ms):
            message = mavlink.MAVLink_local_position_ned_message(one_ms, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
            events += session.receive(sender.encode(message), t_ns)
        t_ns += 20 * MS
    assert of_kind(events, AutopilotRestarted) == []
    assert len(of_kind(events, MessageReceived)) == 60


def test_autopilot_that_was_silent_and_boots_meanwhile_is_a_restarted_one() -> None:
    session, sender = MavlinkSession(1, target_system_id=1), MavlinkCodec(1, 1)
    events = list[Event]()
    for t_ns, boot_ms in ((START_NS, 600_000), *((START_NS + (9_000 + n) * MS, 5_000 + n) for n in (0, 20, 40))):
        message = mavlink.MAVLink_local_position_ned_message(boot_ms, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        events += session.receive(sender.encode(message), t_ns)
    assert len(of_kind(events, AutopilotRestarted)) == 1


def test_input_is_recorded_for_all_senders_when_asked_for() -> None:
    session = MavlinkSession(1, records_input=True)
    frame = MavlinkCodec(255, 190).encode(heartbeat(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID))
    session.receive(frame, START_NS)
    assert session.take_input() == [frame]


@given(st.lists(st.binary(max_size=300), max_size=6), st.integers(0, 2**31))
def test_random_and_spoiled_bytes_never_raise(chunks: list[bytes], place: int) -> None:
    run = pair()
    run.run(0.5)
    stream = bytearray(b"".join(run.autopilot.codec.encode(run.autopilot.message(n, run.t_ns)) for n in (0, 2, 31, 32)))
    stream[place % len(stream)] ^= 1 << place % 8
    for data in (*chunks, bytes(stream)):
        run.session.receive(data, run.t_ns)
        run.session.poll(run.t_ns)
    assert run.session.statistics.codec.bytes_received > len(stream)


@pytest.mark.slow
@given(
    st.sampled_from(["timesync", "system_time", "command_ack", "param_value"]),
    st.integers(0, 2**63 - 1),
    st.integers(0, 2**31 - 1),
)
def test_senseless_values_in_right_frames_never_raise(kind: str, long: int, short: int) -> None:
    run = pair()
    run.run(0.5)
    message = {
        "timesync": lambda: mavlink.MAVLink_timesync_message(tc1=long, ts1=run.t_ns),
        "system_time": lambda: mavlink.MAVLink_system_time_message(long, short),
        "command_ack": lambda: mavlink.MAVLink_command_ack_message(short % 65536, short % 256),
        "param_value": lambda: mavlink.MAVLink_param_value_message(b"X", float("nan"), short % 256, 1, 0),
    }[kind]()
    run.session.read_parameter("X", run.t_ns)
    # A boot time far ahead is taken once it is confirmed; one that is behind is late, and late ones tell nothing.
    events = [event for _ in range(3) for event in run.session.receive(run.autopilot.codec.encode(message), run.t_ns)]
    told = {one.message.get_type() for one in of_kind(events, MessageReceived)}
    assert told == {kind.upper()} or (not told and kind in {"timesync", "system_time"})
    assert isinstance(run.session.clock.local_to_utc_ns(run.t_ns), int)
