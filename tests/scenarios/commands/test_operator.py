"""Operators' commands, and that every command meets others over Zenoh by the same options."""

import pytest
import typer
from typer.main import get_command

from companion.app import app as companion_app
from link.errors import UserError
from link.messages import Command, CommandReply, Order
from link.payloads import json_messages
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, open_session
from scenarios.app import app as scenarios_app
from scenarios.commands import operator as operator_command
from scenarios.commands.ground_vehicle import app as vehicle_app
from scenarios.commands.operator import send_order
from scenarios.processes.programs import free_tcp_endpoint
from sim_autopilot.app import app as autopilot_app

KEYS = Keys()
ACCEPTED = json_messages.encode(CommandReply(accepted=True, reason=""))
ZENOH = ["--mode", "--connect", "--listen", "--multicast-scouting", "--zenoh-config", "--insecure"]


def options_of(app: typer.Typer, name: str | None) -> dict[str, bool]:
    """Return the names of a command's options, and whether each may be given several times."""
    command = get_command(app)
    if name is not None:
        command = command.commands[name]  # type: ignore[attr-defined]  # a group has commands
    return {option: getattr(one, "multiple", False) for one in command.params for option in one.opts}


@pytest.mark.parametrize(
    ("app", "name"),
    [
        (companion_app, None),
        (companion_app, "check"),
        (vehicle_app, None),
        (autopilot_app, None),
        (scenarios_app, "world"),
        (scenarios_app, "command"),
        (scenarios_app, "view"),
    ],
)
def test_all_that_meet_others_over_zenoh_take_the_same_options(app: typer.Typer, name: str | None) -> None:
    options = options_of(app, name)
    assert [option for option in ZENOH if option not in options] == []
    assert {option: options[option] for option in ("-e", "-l", "-m")} == {"-e": True, "-l": True, "-m": False}


@pytest.mark.slow
def test_operator_who_listens_reaches_a_companion_that_connects() -> None:
    endpoint = free_tcp_endpoint()
    asked: list[bytes] = []

    def answer(payload: bytes) -> bytes:
        asked.append(payload)
        return json_messages.encode(CommandReply(accepted=False, reason="too windy"))

    with open_session(ZenohOptions(connect=("tcp/127.0.0.1:1", endpoint))) as companion:
        companion.serve(KEYS.landing_command, answer)
        companion.declare_alive(KEYS.companion_alive("1"))
        reply = send_order(Order(command=Command.HOLD), KEYS, ZenohOptions(listen=(endpoint,)))
    assert reply == CommandReply(accepted=False, reason="too windy")
    assert json_messages.decode(Order, asked[-1]) == Order(command=Command.HOLD)


def test_operator_whom_nobody_answers_is_told_where_was_looked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(operator_command, "_MEETING_S", 0.1)
    with pytest.raises(UserError, match=r"no companion answers on .*landing/command at tcp/127\.0\.0\.1:1:"):
        send_order(Order(command=Command.START), KEYS, ZenohOptions(connect=("tcp/127.0.0.1:1",)))


class Answering:
    """A session on which everybody answers at once, beside a companion's token."""

    alive = True

    def __init__(self, *answers: bytes) -> None:
        self._answers = list(answers)

    def __enter__(self) -> "Answering":
        return self

    def __exit__(self, *_: object) -> None:
        """Nothing is open."""

    def watch_alive(self, _key: str) -> "Answering":
        return self

    def query(self, _key: str, _payload: bytes, _timeout_s: float) -> list[bytes]:
        return self._answers


@pytest.mark.parametrize(
    ("answers", "told"),
    [
        ((ACCEPTED, ACCEPTED), "2 programs answer on .*end all but one; they say: accepted; accepted"),
        (
            (json_messages.encode(CommandReply(accepted=False, reason="no")), ACCEPTED),
            "they say: accepted; refused: no",
        ),
        ((b"{}",), "is no companion"),
        ((b"[" * 10_000,), "is no companion"),
    ],
)
def test_answers_of_others_than_one_companion_are_not_taken_for_its(
    monkeypatch: pytest.MonkeyPatch, answers: tuple[bytes, ...], told: str
) -> None:
    monkeypatch.setattr(operator_command, "open_session", lambda _: Answering(*answers))
    with pytest.raises(UserError, match=told):
        send_order(Order(command=Command.ABORT), KEYS, ZenohOptions())
