"""Somebody who answers an operator in the companion's place, where no companion runs."""

import pytest

from link.errors import UserError
from link.messages import Command, CommandReply, Order
from link.payloads import json_messages
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, open_session
from scenarios.commands import operator as operator_command
from scenarios.commands.operator import send_order
from scenarios.processes.programs import free_tcp_endpoint
from scenarios.view.live import LiveSource
from tests.link.zenoh.waiting import until

KEYS = Keys()
ACCEPTED = CommandReply(accepted=True, reason="")
TOLD = "no companion runs, but somebody answers"


@pytest.mark.slow
@pytest.mark.parametrize("command", [Command.ABORT, Command.START])
def test_who_accepts_a_command_where_no_companion_runs_is_not_believed(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(operator_command, "_SEEING_S", 0.3)
    endpoint = free_tcp_endpoint()
    with open_session(ZenohOptions(listen=(endpoint,))) as liar:
        liar.serve(KEYS.landing_command, lambda _: json_messages.encode(ACCEPTED))
        with pytest.raises(UserError, match=TOLD):
            send_order(Order(command=command), KEYS, ZenohOptions(connect=(endpoint,)))
        view = LiveSource(liar, KEYS)
        assert view.send(command) == CommandReply(accepted=False, reason=TOLD)
        liar.declare_alive(KEYS.companion_alive("1"))
        assert send_order(Order(command=command), KEYS, ZenohOptions(connect=(endpoint,))) == ACCEPTED
        until(liar, lambda: view.send(command) == ACCEPTED)


@pytest.mark.slow
def test_who_answers_beside_the_companion_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(operator_command, "_SEEING_S", 0.3)
    endpoint = free_tcp_endpoint()
    refused = CommandReply(accepted=False, reason="nothing to abort in phase idle")
    by_it = ZenohOptions(mode="client", connect=(endpoint,))
    with open_session(ZenohOptions(listen=(endpoint,))) as companion, open_session(by_it) as liar:
        companion.serve(KEYS.landing_command, lambda _: json_messages.encode(refused))
        companion.declare_alive(KEYS.companion_alive("1"))
        liar.serve(KEYS.landing_command, lambda _: json_messages.encode(ACCEPTED))
        until(companion, lambda: len(companion.query(KEYS.landing_command, b"", 5.0)) == 2)
        with pytest.raises(UserError, match=r"2 programs answer.*accepted; refused: nothing to abort"):
            send_order(Order(command=Command.ABORT), KEYS, by_it)
        told = "2 programs answer: end all but one (accepted; refused: nothing to abort in phase idle)"
        view = LiveSource(companion, KEYS)
        until(companion, lambda: view.send(Command.ABORT).reason != TOLD)
        assert view.send(Command.ABORT).reason == told
