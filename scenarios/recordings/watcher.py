"""Listens to a run: truth and the companion's status, off Zenoh into a recording."""

from typing import TypeVar

from link.messages import BodyTruth, Command, CommandReply, LandingStatus, Order, RotorTruth
from link.payloads import cdr, json_messages
from link.payloads.checks import PayloadError
from link.zenoh.inbox import Inbox
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession
from scenarios.recordings.recording import Recording

_ANSWER_S = 3.0
_CAPACITY = 20_000  # 200 s of truth at real time, should the watcher be held up

T = TypeVar("T", BodyTruth, RotorTruth)


class Watcher:
    """Takes truth and status off Zenoh into the recording.

    Args:
        zenoh: an open session.
        keys: of the Zenoh contract.
        recording: to be filled.

    Attributes:
        recording: as filled so far.
        bad_payloads: how many could not be read; they are left out.
    """

    def __init__(self, zenoh: ZenohSession, keys: Keys, recording: Recording) -> None:
        self.recording = recording
        self.bad_payloads = 0
        self._zenoh, self._command_key = zenoh, keys.landing_command
        self._drone = zenoh.subscribe(keys.drone_truth, capacity=_CAPACITY)
        self._vehicle = zenoh.subscribe(keys.vehicle_truth, capacity=_CAPACITY)
        self._rotors = zenoh.subscribe(keys.drone_rotors, capacity=_CAPACITY)
        self._status = zenoh.subscribe(keys.landing_status)
        self._answers: list[Inbox] = []

    def take(self) -> None:
        """Take what has come."""
        for sample in self._drone.take():
            self._add(BodyTruth, sample.payload)
        for sample in self._vehicle.take():
            self._add(BodyTruth, sample.payload, is_drone=False)
        for sample in self._rotors.take():
            self._add(RotorTruth, sample.payload)
        for sample in self._status.take():
            self._add_status(sample.payload)

    def break_off(self) -> None:
        """Call the landing off, as an operator would; what becomes of it shows in the status."""
        self._zenoh.query(self._command_key, json_messages.encode(Order(command=Command.ABORT)), _ANSWER_S)

    def command(self, order: Order) -> None:
        """Give the companion an order; `take_replies` has its answer later."""
        self._answers.append(self._zenoh.ask(self._command_key, json_messages.encode(order), _ANSWER_S))

    def take_replies(self) -> list[CommandReply]:
        """Return what has been answered to orders since the last call."""
        replies = []
        for inbox in self._answers:
            for sample in inbox.take():
                try:
                    replies.append(json_messages.decode(CommandReply, sample.payload))
                except PayloadError:
                    self.bad_payloads += 1
        return replies

    def _add(self, kind: type[T], payload: bytes, *, is_drone: bool = True) -> None:
        try:
            self.recording.add(cdr.decode(kind, payload), is_drone=is_drone)
        except PayloadError:
            self.bad_payloads += 1

    def _add_status(self, payload: bytes) -> None:
        try:
            self.recording.add(json_messages.decode(LandingStatus, payload))
        except PayloadError:
            self.bad_payloads += 1
