"""The check's conversation, on a clock of the test's own."""

import time
from types import SimpleNamespace
from typing import Any

import pytest

from companion.check import session as session_module
from companion.check.observation import VehicleFacts
from companion.check.reading import Reader
from companion.check.session import CheckSession, open_check
from companion.config.integrity import IntegrityConfig
from link.errors import UserError
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.mavlink.session import MavlinkSession
from link.mavlink.signing import Signing
from link.messages import Fix, PadGeometry
from link.payloads import cdr, json_messages
from link.transports.transport import Transport
from link.zenoh.inbox import Inbox, Sample
from link.zenoh.keys import Keys

KEYS = Keys()
KEY = bytes(range(32))
WAKE_UP: Any = SimpleNamespace(set=lambda: None)
PAD = PadGeometry(size_m=(1.5, 1.2), height_m=1.6, antenna_to_pad_m=(0.8, -0.1, 0.05), is_afloat=True)
FIX = cdr.encode(Fix(t_ns=10**18, latitude_rad=0.8, longitude_rad=0.1, altitude_m=400.0))


class World(Transport):
    """A transport that nothing comes through, and a vehicle on Zenoh that hears only a later question for its pad.

    Args:
        heard_from: the number of the first question that it hears, None for none.
    """

    def __init__(self, heard_from: int | None) -> None:
        super().__init__()
        self.now_s = 5.0
        self._heard_from = heard_from
        self._asked = 0
        self._fixes = Inbox(capacity=100, wake_up=WAKE_UP)

    def monotonic(self) -> float:
        return self.now_s

    def receive(self, wait_s: float) -> bytes:
        self.now_s += wait_s
        return b""

    def send(self, _: bytes) -> None:
        """Lose it."""

    def fileno(self) -> int:
        return -1

    def close(self) -> None:
        """Nothing is open."""

    def subscribe(self, key: str) -> Inbox:
        if key != KEYS.fix:
            return Inbox(capacity=1, wake_up=WAKE_UP)
        for _ in range(20):
            self._fixes.put(Sample(key, FIX, 0))
        return self._fixes

    def watch_alive(self, _: str) -> SimpleNamespace:
        return SimpleNamespace(alive=None)

    def ask(self, key: str, _: bytes, timeout_s: float) -> Inbox:
        assert timeout_s > 0.0
        inbox = Inbox(capacity=1, wake_up=WAKE_UP)
        if self._heard_from is not None and self._asked >= self._heard_from:
            inbox.put(Sample(key, json_messages.encode(PAD), 0))
        self._asked += 1
        return inbox


class SignedAutopilot(Transport):
    """A transport to an autopilot that signs all that it sends."""

    def __init__(self) -> None:
        super().__init__()
        self._signing = Signing(KEY)
        self._codec = MavlinkCodec(1, 1, signing=self._signing)
        self.sent: list[bytes] = []

    def receive(self, _: float) -> bytes:
        self._signing.advance(time.time_ns())
        return self._codec.encode(mavlink.MAVLink_heartbeat_message(2, 12, 0, 0, 4, 3))

    def send(self, frame: bytes) -> None:
        self.sent.append(frame)

    def fileno(self) -> int:
        return -1

    def close(self) -> None:
        """Nothing is open."""


def listened(monkeypatch: pytest.MonkeyPatch, world: World, duration_s: float) -> tuple[VehicleFacts, float]:
    """Return what a session tells of the vehicle of an autopilot that has told all, and how long it took."""
    monkeypatch.setattr(session_module, "time", SimpleNamespace(monotonic=world.monotonic))
    monkeypatch.setattr(Reader, "parameters_done", True)
    began_s = world.now_s
    monkeypatch.setattr(Reader, "listened_s", property(lambda _: world.now_s - began_s))
    anything: Any = world
    session = CheckSession(Reader(MavlinkSession(1, target_system_id=1)), anything, "test")
    vehicle, _ = session.listen(duration_s, anything, KEYS, IntegrityConfig())
    return vehicle, world.now_s - began_s


class TimedReader(Reader):
    """Notes the local times that it is given."""

    def __init__(self) -> None:
        super().__init__(MavlinkSession(1, target_system_id=1))
        self.times_ns: list[int] = []

    def poll(self, t_ns: int) -> None:
        self.times_ns.append(t_ns)
        super().poll(t_ns)


def test_time_of_a_session_goes_on_while_the_date_is_set_back(monkeypatch: pytest.MonkeyPatch) -> None:
    reader, dates_ns = TimedReader(), iter(range(10**18, 0, -(10**15)))
    session = CheckSession(reader, World(heard_from=None), "test")
    monkeypatch.setattr(time, "time_ns", lambda: next(dates_ns))
    for _ in range(5):
        session.turn()
    assert len(reader.times_ns) == 5
    assert reader.times_ns == sorted(reader.times_ns)


def test_pad_is_asked_for_until_the_vehicle_has_heard_the_question(monkeypatch: pytest.MonkeyPatch) -> None:
    facts, took_s = listened(monkeypatch, World(heard_from=2), 4.0)
    assert facts.describes_pad
    assert facts.antenna_behind_pad_m == PAD.antenna_to_pad_m[0]
    assert facts.is_afloat
    assert facts.pad_width_m == 1.2
    assert took_s == pytest.approx(4.0, abs=0.1)


def test_vehicle_that_is_heard_is_given_some_seconds_more_for_its_pad(monkeypatch: pytest.MonkeyPatch) -> None:
    facts, took_s = listened(monkeypatch, World(heard_from=2), 1.0)
    assert facts.describes_pad
    assert 2.4 < took_s < 2.7  # two seconds until it has heard, and half a second for who else answers


def test_vehicle_that_never_describes_its_pad_is_told_so_in_the_end(monkeypatch: pytest.MonkeyPatch) -> None:
    facts, took_s = listened(monkeypatch, World(heard_from=None), 1.0)
    assert not facts.describes_pad
    assert 3.9 < took_s < 4.2


def test_autopilot_that_signs_is_found_with_its_key_and_spoken_to_in_signed_frames() -> None:
    autopilot = SignedAutopilot()
    anything: Any = autopilot
    session = open_check(anything, "test", system_id=1, signing=Signing(KEY))
    session.find(5.0)
    session.turn()
    signing = Signing(KEY)
    signing.advance(time.time_ns())
    heard = MavlinkCodec(1, 1, signing=signing)
    assert autopilot.sent
    assert [len(heard.decode(frame)) for frame in autopilot.sent] == [1] * len(autopilot.sent)


def test_autopilot_that_signs_with_another_key_is_not_found() -> None:
    anything: Any = SignedAutopilot()
    with pytest.raises(UserError, match=r"no heartbeat .* messages were refused: not signed with this --signing-key"):
        open_check(anything, "test", system_id=1, signing=Signing(bytes(32))).find(0.2)
