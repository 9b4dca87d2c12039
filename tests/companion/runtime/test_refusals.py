"""What is said of refused data."""

from companion.runtime.vehicle_link import Refusals


def test_what_a_stranger_sent_reaches_no_terminal_as_it_came() -> None:
    refusals = Refusals()
    refusals.count("pad", "refused", "unknown field \x1b[2J", now_ns=1)
    (line,) = refusals.news(1)
    assert line.isprintable()
    assert refusals.recent(1) == line
