"""Somebody else who answers for the vehicle's pad."""

from types import SimpleNamespace
from typing import Any

from link.messages import PadGeometry
from link.payloads import json_messages
from link.records import replace
from link.zenoh.inbox import Inbox, Sample
from link.zenoh.pad_question import PadQuestion

WAKE_UP: Any = SimpleNamespace(set=lambda: None)
KEY = "decklander/car/pad"
PAD = PadGeometry(size_m=(1.5, 1.2), height_m=1.6, antenna_to_pad_m=(0.4, -0.1, 0.05))
FALSE = replace(PAD, antenna_to_pad_m=(20.0, -0.1, -1.0))


class Vehicles:
    """Those who answer on one key, each question after its own time."""

    def __init__(self, *answers: tuple[float, PadGeometry]) -> None:
        self.answers = list(answers)
        self._inbox = Inbox(capacity=10, wake_up=WAKE_UP)
        self._due: list[tuple[float, PadGeometry]] = []
        self.now_s = 0.0

    def ask(self, key: str, _payload: bytes, _timeout_s: float) -> Inbox:
        assert key == KEY
        self._inbox = Inbox(capacity=10, wake_up=WAKE_UP)
        self._due = [(self.now_s + after_s, pad) for after_s, pad in self.answers]
        return self._inbox

    def advance(self, now_s: float) -> None:
        self.now_s = now_s
        for one in [one for one in self._due if one[0] <= now_s]:
            self._due.remove(one)
            self._inbox.put(Sample(KEY, json_messages.encode(one[1]), 0))


def believed(
    question: PadQuestion, vehicles: Vehicles, seconds: float, *, may_change: bool = True
) -> list[PadGeometry]:
    """Poll at 50 Hz for a while and return the pads that were believed."""
    found = []
    for _ in range(round(50 * seconds)):
        vehicles.advance(vehicles.now_s + 0.02)
        pad = question.poll(vehicles.now_s, may_change=may_change)
        found += [] if pad is None else [pad]
    return found


def test_answers_that_differ_are_not_believed_whoever_is_first_and_the_reason_is_told() -> None:
    for answers in (((0.01, PAD), (0.2, FALSE)), ((0.01, FALSE), (0.2, PAD))):
        vehicles = Vehicles(*answers)
        question = PadQuestion(vehicles, KEY)
        assert believed(question, vehicles, 5.0) == []
        assert question.refused_why == f"2 answers that differ: two answer on {KEY}"
        vehicles.answers = [(0.01, PAD)]
        assert believed(question, vehicles, 3.0) == [PAD]


def test_answers_that_agree_are_believed() -> None:
    vehicles = Vehicles((0.01, PAD), (0.2, PAD))
    assert believed(PadQuestion(vehicles, KEY), vehicles, 2.0) == [PAD]


def test_pad_that_is_flown_to_is_not_replaced_until_the_flight_is_over() -> None:
    vehicles = Vehicles((0.01, PAD))
    question = PadQuestion(vehicles, KEY)
    assert believed(question, vehicles, 2.0) == [PAD]
    vehicles.answers = [(0.01, FALSE)]
    question.ask_anew()
    assert believed(question, vehicles, 5.0, may_change=False) == []
    assert question.refused_why is not None
    assert "while it is flown to" in question.refused_why
    assert question.is_contradicted
    assert believed(question, vehicles, 2.0) == [FALSE]
    assert not question.is_contradicted


def test_pad_that_is_flown_to_is_not_contradicted_by_a_stranger_beside_the_vehicle() -> None:
    vehicles = Vehicles((0.01, PAD))
    question = PadQuestion(vehicles, KEY)
    assert believed(question, vehicles, 2.0) == [PAD]
    vehicles.answers = [(0.01, FALSE), (0.2, PAD)]
    question.ask_anew()
    assert believed(question, vehicles, 3.0, may_change=False) == []
    assert not question.is_contradicted


def test_pad_that_is_described_in_flight_for_the_first_time_is_believed() -> None:
    vehicles = Vehicles((0.01, PAD))
    assert believed(PadQuestion(vehicles, KEY), vehicles, 2.0, may_change=False) == [PAD]
