"""Since when nothing shows that the autopilot hears setpoints."""

import pytest

from companion.runtime.link_delay import link_delay
from link.mavlink.answers import Answers, with_answer
from link.mavlink.dialect import mavlink
from link.mavlink.timesync import ClockSync
from tests.link.mavlink.fake_autopilot import MS, START_NS


def answered(asked_ns: int) -> ClockSync:
    sync = ClockSync()
    assert sync.poll(asked_ns) is not None
    sync.timesync(mavlink.MAVLink_timesync_message(tc1=1, ts1=asked_ns), asked_ns + 4 * MS)
    return sync


def test_answers_about_the_time_count_while_nothing_tells_of_a_setpoint() -> None:
    delay = link_delay(answered(START_NS), Answers(), START_NS + 50 * MS)
    assert (delay.unanswered_s, delay.answering_s) == pytest.approx((0.05, 0.046))


def test_what_it_says_that_it_flies_to_counts_alone_once_that_tells_of_a_setpoint() -> None:
    setpoints = with_answer(Answers(), START_NS - 300 * MS, START_NS - 290 * MS)
    delay = link_delay(answered(START_NS), setpoints, START_NS + 50 * MS)
    assert (delay.unanswered_s, delay.answering_s) == pytest.approx((0.35, 0.34))


def test_autopilot_that_has_never_answered_shows_nothing() -> None:
    delay = link_delay(ClockSync(), Answers(), START_NS)
    assert (delay.unanswered_s, delay.answering_s) == (0.0, None)
