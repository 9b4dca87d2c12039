import itertools
from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from sim_autopilot.core.streams import Stream, Streams, default_streams, due_messages, with_interval

STEP_NS = 10_000_000


def counted(streams: Streams, steps: int) -> dict[int, int]:
    counts: dict[int, int] = {}
    for step in range(steps):
        streams, due = due_messages(streams, step * STEP_NS)
        assert len(due) == len(set(due))
        for message_id in due:
            counts[message_id] = counts.get(message_id, 0) + 1
    return counts


@given(st.integers(min_value=STEP_NS, max_value=3_000_000_000), st.integers(min_value=1, max_value=2_000))
def test_no_interval_gains_or_loses_a_message(interval_ns: int, steps: int) -> None:
    streams = with_interval(default_streams([]), 5, interval_ns, 0)
    last_ns = (steps - 1) * STEP_NS
    assert counted(streams, steps)[5] == Fraction(last_ns, interval_ns).__floor__() + 1


@given(st.integers(min_value=STEP_NS, max_value=100_000_000))
def test_gaps_differ_from_the_interval_by_less_than_a_step(interval_ns: int) -> None:
    streams, sent_ns = with_interval(default_streams([]), 5, interval_ns, 0), []
    for step in range(500):
        streams, due = due_messages(streams, step * STEP_NS)
        sent_ns += [step * STEP_NS] * len(due)
    gaps = [later - earlier for earlier, later in itertools.pairwise(sent_ns)]
    assert all(abs(gap - interval_ns) < STEP_NS for gap in gaps)


def test_an_interval_faster_than_the_steps_gives_one_message_a_step() -> None:
    assert counted(with_interval(default_streams([]), 5, 8_000_000, 0), 1000)[5] == 1000


def test_a_stopped_stream_is_silent_and_the_others_go_on() -> None:
    streams = default_streams([Stream(message_id=1, rate_hz=10.0), Stream(message_id=2, rate_hz=10.0)])
    assert counted(with_interval(streams, 1, None, 0), 100) == {2: 10}


def test_stopping_a_stream_that_does_not_run_changes_nothing() -> None:
    streams = default_streams([Stream(message_id=2, rate_hz=10.0)])
    assert counted(with_interval(streams, 1, None, 0), 100) == {2: 10}


def test_a_stall_is_not_made_up_for_by_a_burst() -> None:
    streams, _ = due_messages(default_streams([Stream(message_id=1, rate_hz=50.0)]), 0)
    sent = 0
    for step in range(1000, 1100):
        streams, due = due_messages(streams, step * STEP_NS)
        sent += len(due)
    assert sent == 50


def test_due_messages_leaves_its_argument_alone() -> None:
    streams = default_streams([Stream(message_id=1, rate_hz=50.0)])
    due_messages(streams, 0)
    assert streams.next_ns == {1: 0}
