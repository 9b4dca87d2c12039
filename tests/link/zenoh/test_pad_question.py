"""Asking a vehicle for its pad: again until it has answered with one that fits, and anew when it has come back."""

from types import SimpleNamespace
from typing import Any

from link.messages import VEHICLE_LENGTH_MAX_M, PadGeometry
from link.payloads import json_messages
from link.zenoh.inbox import Inbox, Sample
from link.zenoh.pad_question import PadQuestion
from scenarios.vehicle_sources.pad import pad_geometry

PAD = PadGeometry(size_m=(1.5, 1.2), height_m=1.6, antenna_to_pad_m=(VEHICLE_LENGTH_MAX_M, -0.1, 0.05))
WAKE_UP: Any = SimpleNamespace(set=lambda: None)
KEY = "decklander/car/pad"
TOO_FAR = b'{"size_m": [2, 1], "height_m": 1, "antenna_to_pad_m": [60, 0, 0]}'


class Vehicle:
    """Gives one answer to each question; None where the question is lost."""

    def __init__(self, *answers: bytes | None) -> None:
        self._answers = list(answers)
        self.asked = 0

    def ask(self, key: str, payload: bytes, timeout_s: float) -> Inbox:
        """Answer at once."""
        assert (key, payload) == (KEY, b"")
        assert timeout_s > 0.0
        self.asked += 1
        inbox = Inbox(capacity=10, wake_up=WAKE_UP)
        answer = self._answers.pop(0)
        if answer is not None:
            inbox.put(Sample(key, answer, 0))
        return inbox


def polled(question: PadQuestion, until_s: float) -> list[PadGeometry]:
    """Poll at 10 Hz and return the pads that came."""
    pads = [question.poll(0.1 * index) for index in range(round(10.0 * until_s))]
    return [pad for pad in pads if pad is not None]


def test_lost_questions_are_asked_again_until_there_is_an_answer_and_no_more() -> None:
    vehicle = Vehicle(None, None, json_messages.encode(PAD))
    question = PadQuestion(vehicle, KEY)
    assert polled(question, 1.95) == []
    assert not question.is_answered
    assert polled(question, 10.0) == [PAD]
    assert vehicle.asked == 3
    assert question.is_answered


def test_vehicle_that_has_come_back_is_asked_anew() -> None:
    other = pad_geometry(None, size_m=(1.0, 1.0), height_m=0.5, antenna_to_pad_m=(0.0, 0.0, 0.0))
    question = PadQuestion(Vehicle(json_messages.encode(PAD), json_messages.encode(other)), KEY)
    assert polled(question, 2.0) == [PAD]
    question.ask_anew()
    assert not question.is_answered
    assert question.poll(20.0) is None
    assert question.poll(20.5) == other


def test_nobody_is_asked_while_there_is_nobody() -> None:
    vehicle = Vehicle()
    assert PadQuestion(vehicle, KEY).poll(0.0, asks=False) is None
    assert vehicle.asked == 0


def test_pad_further_from_the_antenna_than_any_vehicle_is_long_is_refused_with_the_reason() -> None:
    question = PadQuestion(Vehicle(TOO_FAR, b"nonsense", json_messages.encode(PAD)), KEY)
    assert polled(question, 0.95) == []
    assert question.bad_answers == 1
    assert question.refused_why is not None
    assert "antenna_to_pad_m" in question.refused_why
    assert "25.25" in question.refused_why
    assert polled(question, 3.95) == [PAD]
    assert question.bad_answers == 2
