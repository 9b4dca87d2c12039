"""What a flight loses is said once, in the log and, where it matters, to the pilot."""

import math
from collections.abc import Callable
from contextlib import closing
from io import StringIO
from pathlib import Path

import pytest

from companion.core.data import Setpoint
from companion.runtime import publishing
from companion.runtime.build import build_node
from companion.runtime.losses import Losses
from companion.runtime.sent_frames import SentFrames
from link.mavlink.codec import MavlinkCodec
from link.mavlink.signing import Signing, signing_timestamp
from link.mavlink.signing_memory import SigningMemory
from link.payloads.checks import PayloadError
from link.recording.log import Log
from link.transports.opening import open_transport
from link.zenoh.options import ZenohOptions
from link.zenoh.session import open_session
from tests.companion.peer import KEYS, Setup
from tests.link.mavlink.fake_autopilot import START_NS

KEY, OTHER_KEY = bytes(range(32)), bytes(32)
NOT_FINITE = Setpoint(
    t_ns=0, position_enu_m=(math.nan, 0.0, 1.0), velocity_enu_m_s=None, acceleration_enu_m_s2=None, yaw_rad=0.0
)


def said(setup: Setup, loses: Callable[[], None], signing: SigningMemory | None = None) -> str:
    """What the log has after a loss, and another one like it."""
    lines = StringIO()
    log = Log("companion", lines)
    with open_session(ZenohOptions()) as zenoh, closing(open_transport("udpin:127.0.0.1:0")) as transport:
        sent = SentFrames(transport, setup.node.autopilot.session, None)
        losses = Losses(setup.node, sent, zenoh, log, signing=signing)
        setup.run(1.0)
        losses.say()
        for _ in range(2):
            loses()
            losses.say()
    log.close()
    return lines.getvalue()


def test_setpoint_that_is_withheld_is_told_once_in_the_log_and_to_the_pilot() -> None:
    setup = Setup(is_component=True)
    told = said(setup, lambda: setup.node.autopilot.send_setpoint(NOT_FINITE, setup.t_ns))
    assert told.count("setpoints are withheld") == 1
    setup.run(0.1)
    assert any("withholds setpoints" in message.text for message in setup.autopilot.of_type("STATUSTEXT"))


def test_status_that_no_message_holds_is_told_once_in_the_log(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PayloadError("t_ns is out of range")

    setup = Setup()

    def lose() -> None:
        monkeypatch.setattr(publishing, "status_publication", refuse)
        setup.run(1.0)

    assert said(setup, lose).count("statuses are not published") == 1


def signed(key: bytes) -> MavlinkCodec:
    return MavlinkCodec(1, 1, signing=Signing(key, timestamp=signing_timestamp(START_NS)))


def test_autopilot_that_is_not_heard_any_more_for_its_signatures_is_told_once() -> None:
    setup = Setup()
    setup.node = build_node(setup.config, KEYS, signing=Signing(KEY))
    setup.autopilot.codec = signed(KEY)

    def lose() -> None:
        setup.autopilot.codec = signed(OTHER_KEY)
        setup.run(4.0)

    assert said(setup, lose).count("messages of MAVLink are refused") == 1


def test_autopilot_that_was_never_heard_for_its_signatures_is_told() -> None:
    setup = Setup()
    setup.node = build_node(setup.config, KEYS, signing=Signing(KEY))
    assert said(setup, lambda: setup.run(1.0)).count("messages of MAVLink are refused") == 1


def test_stamps_of_signatures_that_are_not_kept_are_told_once(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    memory = SigningMemory(folder / "stamps", Signing(KEY))
    folder.rename(tmp_path / "elsewhere")
    told = said(Setup(), memory.close, memory)
    assert told.count("time stamps of signatures are not kept") == 1
    assert "No such file or directory" in told
