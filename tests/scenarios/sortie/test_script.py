"""What a sortie's operator orders, and when; and what he counts as a contact."""

import pytest

from companion.situation.phases import Phase
from link.messages import Command, Station, StationFrame
from scenarios.sortie.script import HELD_S, SortieOperator

STATIONS = (
    Station(offset_m=(-6.0, 0.0, 4.0), frame=StationFrame.VEHICLE),
    Station(offset_m=(1.0, 6.0, 2.0), frame=StationFrame.COURSE),
)
S = 1_000_000_000
HELD_NS = round(HELD_S * 1e9)


def given(operator: SortieOperator, t_ns: int, phase: Phase, distance_m: float = 5.0, *, may: bool = True) -> object:
    order = operator.order(t_ns, phase, distance_m, may_launch=may)
    return None if order is None else (order.command, order.station)


def at_hold() -> SortieOperator:
    """An operator who has told the drone to hold, at 2 * HELD_S."""
    operator = SortieOperator(STATIONS)
    for number in range(3):
        assert given(operator, 10 * S + number * HELD_NS, Phase.FOLLOW) is not None
    return operator


def test_launch_is_asked_for_again_until_the_drone_is_under_way() -> None:
    operator = SortieOperator(STATIONS)
    assert given(operator, S, Phase.IDLE, may=False) is None
    assert given(operator, S, Phase.IDLE) == (Command.LAUNCH, None)
    assert given(operator, S + S // 2, Phase.IDLE) is None
    assert given(operator, 2 * S, Phase.IDLE) == (Command.LAUNCH, None)
    assert given(operator, 9 * S, Phase.LIFT_OFF) is None


def test_stations_follow_each_other_and_then_a_hold() -> None:
    operator = SortieOperator(STATIONS)
    assert given(operator, 10 * S, Phase.FOLLOW) == (Command.FOLLOW, STATIONS[0])
    assert given(operator, 10 * S + HELD_NS - 1, Phase.FOLLOW) is None
    assert given(operator, 10 * S + HELD_NS, Phase.FOLLOW) == (Command.FOLLOW, STATIONS[1])
    assert given(operator, 10 * S + 2 * HELD_NS, Phase.FOLLOW) == (Command.HOLD, None)
    assert [station for _, station in operator.orders] == list(STATIONS)


@pytest.mark.parametrize(("after_s", "distance_m", "calls"), [(59, 299.0, False), (61, 20.0, True), (2, 301.0, True)])
def test_drone_is_called_home_from_far_away_or_after_a_minute(after_s: int, distance_m: float, calls: bool) -> None:
    operator = at_hold()
    t_ns = operator.times_ns["hold"] + after_s * S
    assert given(operator, t_ns, Phase.HOLD, distance_m) == ((Command.RETURN, None) if calls else None)
    assert operator.return_from_m == (distance_m if calls else None)
    assert given(operator, t_ns + S, Phase.HOLD, 400.0) == (None if calls else (Command.RETURN, None))


def test_contacts_count_from_the_lift_off_to_the_descent_that_was_called_for() -> None:
    operator = at_hold()
    operator.note_contact(0, Phase.LIFT_OFF, touches=True)
    for t_ns in (S, 2 * S):
        operator.note_contact(t_ns, Phase.LIFT_OFF, touches=False)
    assert operator.times_ns["lifted"] == 0
    operator.note_contact(3 * S, Phase.FOLLOW, touches=True)
    operator.note_contact(4 * S, Phase.DESCEND, touches=True)  # nobody has called for one
    assert given(operator, 200 * S, Phase.HOLD, 400.0) == (Command.RETURN, None)
    operator.note_contact(201 * S, Phase.DESCEND, touches=True)
    operator.note_contact(202 * S, Phase.RETURN, touches=True)
    assert operator.contacts_ns == [3 * S, 4 * S, 202 * S]


def test_drone_that_comes_home_by_itself_is_not_called_and_its_landing_is_no_contact() -> None:
    operator = SortieOperator(STATIONS)
    operator.note_contact(0, Phase.LIFT_OFF, touches=True)
    operator.note_contact(S, Phase.LIFT_OFF, touches=False)
    assert given(operator, 10 * S, Phase.FOLLOW) is not None
    assert given(operator, 12 * S, Phase.RETURN, 17.0) is None
    operator.note_contact(20 * S, Phase.TOUCHDOWN, touches=True)
    assert (operator.comes_by_itself, operator.return_from_m, operator.contacts_ns) == (True, 17.0, [])
    assert operator.times_ns["return"] == 12 * S
    assert not at_hold().comes_by_itself
