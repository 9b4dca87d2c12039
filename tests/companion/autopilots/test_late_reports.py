"""Reports of the state in the order in which they were sent, whatever the link makes of it."""

import pytest

from companion.autopilots.late_reports import LateReports
from link.mavlink.dialect import Message, mavlink

SECOND_NS = 1_000_000_000


def report(number: int, mode: int = 4) -> Message:
    message = mavlink.MAVLink_heartbeat_message(2, 3, 0x51, mode, 4, 3)
    message.pack(mavlink.MAVLink(None))
    message.get_header().seq = number
    return message


def landed_state(number: int) -> Message:
    message = mavlink.MAVLink_extended_sys_state_message(0, mavlink.MAV_LANDED_STATE_IN_AIR)
    message.pack(mavlink.MAVLink(None))
    message.get_header().seq = number
    return message


@pytest.mark.parametrize(
    ("newest", "number", "is_late"), [(9, 8, True), (3, 250, True), (250, 3, False), (9, 9, False)]
)
def test_report_that_was_overtaken_is_late_also_where_the_count_begins_anew(
    newest: int, number: int, *, is_late: bool
) -> None:
    reports = LateReports()
    assert not reports.is_late(report(newest), 0)
    assert reports.is_late(report(number), SECOND_NS // 20) is is_late


def test_sequence_that_began_anew_is_heard() -> None:
    reports = LateReports()
    reports.is_late(report(200), 0)
    assert not reports.is_late(report(100), SECOND_NS // 20)
    assert not reports.is_late(report(80), SECOND_NS)


def test_second_late_report_of_a_kind_counts_whatever_number_somebody_forges() -> None:
    reports, taken = LateReports(), 0
    for second in range(4):
        for tenth in range(10):
            reports.is_late(landed_state(second + 30), second * SECOND_NS + tenth * SECOND_NS // 10)
        taken += not reports.is_late(report(second), (second + 1) * SECOND_NS - 1)
    assert taken == 3


@pytest.mark.parametrize("every_s", [1.0, 0.2], ids=["of one a second", "of ten a second, every other one"])
def test_report_that_is_late_now_and_then_is_passed_over_each_time(every_s: float) -> None:
    reports, every_ns = LateReports(), round(every_s * SECOND_NS)
    for place in range(20):
        assert not reports.is_late(report(4 * place + 1), place * every_ns)
        assert reports.is_late(report(4 * place), place * every_ns + SECOND_NS // 20)


def test_what_tells_no_state_is_never_late() -> None:
    reports = LateReports()
    reports.is_late(report(9), 0)
    text = mavlink.MAVLink_statustext_message(6, b"hello")
    text.pack(mavlink.MAVLink(None))
    assert not reports.is_late(text, 1)
