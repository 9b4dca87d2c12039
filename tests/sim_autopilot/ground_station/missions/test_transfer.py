import pytest

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.ground_station.missions.library import NO_LIBRARY, Arrival, Library, Way
from sim_autopilot.ground_station.missions.rules import ARDUCOPTER_MISSIONS, PX4_MISSIONS, TransferRules
from sim_autopilot.ground_station.missions.transfer import take_mission_message, transfer_passes
from sim_autopilot.missions.items import FENCE, MISSION, RALLY
from tests.sim_autopilot.pilot import Pilot
from tests.sim_autopilot.planner import download, item, plan_messages, upload

WAYPOINT = mavlink.MAV_CMD_NAV_WAYPOINT
ACCEPTED, ERROR, UNSUPPORTED_FRAME, UNSUPPORTED, NO_SPACE = 0, 1, 2, 3, 4
WRONG_SEQUENCE, CANCELLED = 13, 15
BUSY_S = 5.0


def waypoints(count: int) -> list[Message]:
    return [item(i, WAYPOINT, (10.0 * i, 5.0, 20.0), (1.5, 2.0, 0.0, 30.0)) for i in range(count)]


def fence() -> list[Message]:
    vertex = mavlink.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION
    corners = ((-50.0, -50.0), (50.0, -50.0), (0.0, 50.0))
    return [item(i, vertex, (*c, 0.0), (3.0, 0.0, 0.0, 0.0), kind=FENCE) for i, c in enumerate(corners)]


def send(library: Library, message: Message, t_s: float, rules: TransferRules) -> tuple[Library, list[Message]]:
    header = mavlink.MAVLink_header(message.get_msgId(), srcSystem=255, srcComponent=190)
    message._header = header  # noqa: SLF001 (as a decoder fills it in)
    library, answers = take_mission_message(
        library, Arrival(message=message, boot_ns=round(t_s * 1e9), rules=rules, current=0)
    )
    return library, list(answers)


def count_of(count: int, kind: int = MISSION) -> Message:
    return mavlink.MAVLink_mission_count_message(1, 1, count, kind)


@pytest.mark.parametrize("kind", [MISSION, FENCE, RALLY])
def test_a_plan_comes_back_as_it_was_uploaded(kind: int) -> None:
    pilot = Pilot()
    rally = [item(0, mavlink.MAV_CMD_NAV_RALLY_POINT, (3.0, 4.0, 25.0), kind=RALLY)]
    items = {MISSION: waypoints(4), FENCE: fence(), RALLY: rally}[kind]
    assert upload(pilot, items, kind) == ACCEPTED
    kept = download(pilot, kind)
    frame = mavlink.MAV_FRAME_GLOBAL_INT if kind == FENCE else mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
    assert {one.frame for one in kept} == {
        frame
    }  # PX4 does not store what a fence's heights, which it has not, are above
    fields = ("seq", "command", "autocontinue", "param1", "param2", "x", "y", "z", "mission_type")
    assert [[getattr(m, f) for f in fields] for m in kept] == [[getattr(m, f) for f in fields] for m in items]


def test_a_cleared_plan_is_empty_and_the_others_stay() -> None:
    pilot = Pilot()
    upload(pilot, waypoints(2))
    upload(pilot, fence(), FENCE)
    (answer,) = plan_messages(pilot.step(mavlink.MAVLink_mission_clear_all_message(1, 1, MISSION)))
    assert answer.type == ACCEPTED
    assert download(pilot) == []
    assert len(download(pilot, FENCE)) == 3


def test_a_client_that_knows_no_integers_is_asked_otherwise_and_served_in_degrees() -> None:
    pilot = Pilot()
    (asked,) = plan_messages(pilot.step(count_of(1)))
    assert asked.get_type() == "MISSION_REQUEST_INT"
    (asked,) = plan_messages(pilot.step(mavlink.MAVLink_mission_ack_message(1, 1, UNSUPPORTED, MISSION)))
    assert asked.get_type() == "MISSION_REQUEST"
    old = mavlink.MAVLink_mission_item_message(1, 1, 0, 3, WAYPOINT, 0, 1, 0, 0, 0, 0, 52.25, 13.5, 20.0)
    (answer,) = plan_messages(pilot.step(old))
    assert answer.type == ACCEPTED
    pilot.step(mavlink.MAVLink_mission_request_list_message(1, 1, MISSION))
    (kept,) = plan_messages(pilot.step(mavlink.MAVLink_mission_request_message(1, 1, 0, MISSION)))
    assert (kept.get_type(), kept.x, kept.y) == ("MISSION_ITEM", pytest.approx(52.25), pytest.approx(13.5))


@pytest.mark.parametrize(
    ("wrong", "result"),
    [
        (item(0, mavlink.MAV_CMD_NAV_SPLINE_WAYPOINT, (1.0, 1.0, 5.0)), UNSUPPORTED),
        (item(0, WAYPOINT, (1.0, 1.0, 5.0), frame=mavlink.MAV_FRAME_LOCAL_NED), UNSUPPORTED_FRAME),
    ],
)
def test_an_item_that_it_cannot_fly_ends_the_transfer_and_keeps_the_old_plan(wrong: Message, result: int) -> None:
    pilot = Pilot()
    upload(pilot, waypoints(2))
    assert upload(pilot, [wrong]) == result
    assert len(download(pilot)) == 2


def test_more_items_than_there_is_room_for_are_refused() -> None:
    assert plan_messages(Pilot().step(count_of(501)))[0].type == NO_SPACE


def test_an_item_that_does_not_come_is_asked_for_again() -> None:
    pilot = Pilot()
    pilot.step(count_of(2))
    pilot.received.clear()
    pilot.run(1.1)
    assert [m.seq for m in pilot.all("MISSION_REQUEST_INT")] == [0, 0, 0, 0]


def test_px4_is_busy_for_five_seconds_after_an_abandoned_transfer() -> None:
    library, _ = send(NO_LIBRARY, count_of(2), 0.0, PX4_MISSIONS)
    library, _ = send(library, waypoints(2)[0], 0.1, PX4_MISSIONS)
    for t_s, busy in ((0.2, True), (0.1 + BUSY_S - 0.1, True), (0.1 + BUSY_S + 0.1, False)):
        passed, _ = transfer_passes(library, round(t_s * 1e9), PX4_MISSIONS)
        _, (answer,) = send(passed, count_of(1), t_s, PX4_MISSIONS)
        assert (answer.get_type() == "MISSION_ACK") == busy
        if busy:
            assert answer.type == ERROR


def test_px4_is_busy_for_five_seconds_after_a_download_that_nobody_acknowledged() -> None:
    library, _ = send(NO_LIBRARY, mavlink.MAVLink_mission_request_list_message(1, 1, MISSION), 0.0, PX4_MISSIONS)
    _, (answer,) = send(library, count_of(1), 1.0, PX4_MISSIONS)
    assert answer.type == ERROR
    library, _ = transfer_passes(library, round((BUSY_S + 0.1) * 1e9), PX4_MISSIONS)
    _, (answer,) = send(library, count_of(1), BUSY_S + 0.1, PX4_MISSIONS)
    assert answer.get_type() == "MISSION_REQUEST_INT"


def test_arducopter_refuses_an_item_sent_twice_and_px4_asks_for_the_next() -> None:
    def second_answer(rules: TransferRules) -> Message:
        library, _ = send(NO_LIBRARY, count_of(3), 0.0, rules)
        first = waypoints(3)[0]
        library, _ = send(library, first, 0.1, rules)
        _, (answer,) = send(library, first, 0.2, rules)
        return answer

    assert second_answer(ARDUCOPTER_MISSIONS).type == WRONG_SEQUENCE
    assert second_answer(PX4_MISSIONS).seq == 1


def test_arducopter_cancels_a_silent_upload_and_lets_its_client_begin_again() -> None:
    library, _ = send(NO_LIBRARY, count_of(2), 0.0, ARDUCOPTER_MISSIONS)
    _, (again,) = send(library, count_of(2), 1.0, ARDUCOPTER_MISSIONS)
    assert again.get_type() == "MISSION_REQUEST"
    library, (cancelled,) = transfer_passes(library, round(8.1e9), ARDUCOPTER_MISSIONS)
    assert (cancelled.type, library.transfer) == (CANCELLED, None)


def test_a_second_client_does_not_disturb_a_transfer() -> None:
    library, _ = send(NO_LIBRARY, count_of(2), 0.0, PX4_MISSIONS)
    other = item(0, WAYPOINT, (0.0, 0.0, 5.0))
    other._header = mavlink.MAVLink_header(other.get_msgId(), srcSystem=254, srcComponent=1)  # noqa: SLF001 (as a decoder does)
    after, (answer,) = take_mission_message(library, Arrival(message=other, boot_ns=10, rules=PX4_MISSIONS, current=0))
    assert answer.type == ERROR
    assert after.transfer is not None
    assert (after.transfer.way, after.transfer.items) == (Way.UPLOAD, ())
