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


def attitude(number: int) -> Message:
    message = mavlink.MAVLink_attitude_quaternion_message(1, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    message.pack(mavlink.MAVLink(None))
    message.get_header().seq = number
    return message


@pytest.mark.parametrize(
    ("newest", "number", "is_late"),
    [(9, 8, True), (3, 250, True), (250, 3, False), (9, 9, False), (150, 23, True), (10, 139, True), (10, 50, False)],
)
def test_report_that_was_overtaken_is_late_also_where_the_count_begins_anew(
    newest: int, number: int, *, is_late: bool
) -> None:
    reports = LateReports()
    assert not reports.is_late(report(newest), 0)
    assert reports.is_late(report(number), SECOND_NS // 20) is is_late


def test_sequence_that_began_anew_is_heard_by_the_second_report_of_a_kind_and_after_half_a_second() -> None:
    reports = LateReports()
    reports.is_late(report(200), 0)
    assert [reports.is_late(report(number), SECOND_NS // 20) for number in (100, 104)] == [True, False]
    assert not reports.is_late(report(4), SECOND_NS)


@pytest.mark.parametrize("packets", [40, 100, 180])
def test_report_that_other_messages_have_overtaken_is_late_however_many_of_them_came(packets: int) -> None:
    reports = LateReports()
    for number in range(1, packets + 1):
        assert not reports.is_late(attitude(number % 256), number * SECOND_NS // 300)
    assert reports.is_late(report(0), packets * SECOND_NS // 300)


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
