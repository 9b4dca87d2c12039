"""What a program logs, publishes and records: however that fails, the loop that flies does not notice."""

import io
import struct

import pytest

from companion.runtime import publishing
from link.errors import UserError
from link.payloads.checks import PayloadError
from link.program.cli import make_app, run_app
from link.program.text import printable
from link.recording.log import Log
from link.recording.recorder import BackgroundRecorder
from link.zenoh.options import ZenohOptions
from link.zenoh.session import open_session
from tests.companion.peer import Setup

ORDER = "\x1b]0;owned\x07\x1b[2J"  # to a terminal: another title, and clear


class BrokenPipe(io.StringIO):
    """A standard output whose reader has gone."""

    def write(self, _: str) -> int:
        raise BrokenPipeError


class Unpackable:
    """A sink of numbers that do not fit."""

    def write(self, record: int) -> None:
        struct.pack(">Q", record)

    def close(self) -> None:
        """Nothing is open."""


def test_log_whose_reader_has_gone_loses_lines_and_raises_nothing() -> None:
    log = Log("companion", BrokenPipe())
    log.info("ready")
    log.warning("autopilot lost")
    log.close()
    assert log.lost == 2


def test_log_shows_orders_to_a_terminal_instead_of_giving_them() -> None:
    written = io.StringIO()
    log = Log("companion", written)
    log.info("autopilot", text=f"Low{ORDER}battery", other=ORDER)
    log.close()
    assert "x1b" in written.getvalue()
    assert ORDER[:3] not in written.getvalue()


def test_error_of_a_program_shows_orders_to_a_terminal_instead_of_giving_them(
    capsys: pytest.CaptureFixture[str],
) -> None:
    app = make_app("Fails.")

    @app.command()
    def fail() -> None:
        raise UserError(f"{ORDER} is no scenario")

    assert run_app("scenarios", app, []) == 2
    assert printable(ORDER) in capsys.readouterr().err


def test_recorder_goes_on_after_a_number_that_does_not_fit() -> None:
    recorder = BackgroundRecorder(Unpackable())
    for record in (1, -1, 2):
        recorder.put(record)
    recorder.close()
    assert recorder.dropped == 1


def test_status_that_no_message_can_hold_is_counted_and_the_flight_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PayloadError("t_ns is out of range")

    monkeypatch.setattr(publishing, "status_publication", refuse)
    setup = Setup()
    setup.run(1.0)
    assert setup.node.publisher.unpublished > 5
    assert setup.node.outputs is not None


def test_publishing_on_a_session_that_has_ended_is_counted_and_raises_nothing() -> None:
    session = open_session(ZenohOptions())
    session.publish("ns/status", b"{}", "application/json")
    session.close()
    session.publish("ns/status", b"{}", "application/json")
    session.publish("ns/plan", b"{}", "application/json")
    assert session.unpublished == 2
