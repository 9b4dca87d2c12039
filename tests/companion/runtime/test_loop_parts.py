"""The parts of the wire loop that can be tried without sockets: the desk for commands, and the timings."""

import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

import pytest

from companion.runtime import command_desk
from companion.runtime.command_desk import CommandDesk
from companion.runtime.node import CompanionNode
from companion.runtime.options import Timings
from link.messages import Command, CommandReply
from link.payloads import json_messages as json_payloads
from tests.companion.peer import Setup

ACCEPTED = CommandReply(accepted=True, reason="")


class Asker:
    """An operator's query, which waits in a thread of its own as Zenoh's do."""

    def __init__(self, desk: CommandDesk, payload: bytes) -> None:
        self._reply: list[bytes] = []
        self._thread = threading.Thread(target=lambda: self._reply.append(desk.handle(payload)))
        self._thread.start()

    def reply(self) -> CommandReply:
        self._thread.join(5.0)
        assert not self._thread.is_alive()
        return json_payloads.decode(CommandReply, self._reply[0])


class TriedToTakeBack(Future[CommandReply]):
    """A reply that tells when somebody has tried to take its command back."""

    def __init__(self) -> None:
        super().__init__()
        self.tried = threading.Event()

    def cancel(self) -> bool:
        is_cancelled = super().cancel()
        self.tried.set()
        return is_cancelled


@pytest.fixture
def node() -> CompanionNode:
    return Setup().node


def _until(is_true: Callable[[], bool]) -> None:
    deadline = threading.Event()
    for _ in range(2000):
        if is_true():
            return
        deadline.wait(0.001)
    raise AssertionError("it did not come")


def _passed_on(desk: CommandDesk, node: CompanionNode, asked: list[Command]) -> Callable[[], bool]:
    def passed() -> bool:
        before = len(asked)
        desk.pass_on(node, 0)
        return len(asked) > before

    return passed


@pytest.fixture
def asked(node: CompanionNode, monkeypatch: pytest.MonkeyPatch) -> list[Command]:
    commands: list[Command] = []
    monkeypatch.setattr(node, "request", commands.append)
    monkeypatch.setattr(node, "is_due", lambda _local_ns: True)
    return commands


def test_reply_goes_to_who_asked(node: CompanionNode, asked: list[Command]) -> None:
    desk = CommandDesk()
    asker = Asker(desk, json_payloads.encode(Command.START))
    _until(_passed_on(desk, node, asked))
    desk.answer([ACCEPTED])
    assert asker.reply() == ACCEPTED
    assert asked == [Command.START]


def test_commands_reach_the_node_one_at_a_time(node: CompanionNode, asked: list[Command]) -> None:
    desk = CommandDesk()
    first = Asker(desk, json_payloads.encode(Command.START))
    _until(_passed_on(desk, node, asked))
    second = Asker(desk, json_payloads.encode(Command.ABORT))
    for _ in range(5):
        desk.pass_on(node, 0)
    assert asked == [Command.START]
    desk.answer([ACCEPTED])
    first.reply()
    _until(_passed_on(desk, node, asked))
    desk.answer([CommandReply(accepted=False, reason="nothing to abort")])
    assert second.reply().reason == "nothing to abort"


def test_payload_that_is_no_command_is_refused_and_never_passed_on(node: CompanionNode, asked: list[Command]) -> None:
    desk = CommandDesk()
    for payload in (b"", b"start", b'{"command": "land"}', b'{"command": "start", "when": "later"}'):
        assert not Asker(desk, payload).reply().accepted
    desk.pass_on(node, 0)
    assert asked == []


def test_command_answered_by_a_refusal_is_not_done_later(
    node: CompanionNode, asked: list[Command], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(command_desk, "_REPLY_WAIT_S", 0.01)
    desk = CommandDesk()
    assert not Asker(desk, json_payloads.encode(Command.START)).reply().accepted
    desk.pass_on(node, 0)
    assert asked == []


def test_command_waits_at_the_desk_until_a_step_is_due(
    node: CompanionNode, asked: list[Command], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(command_desk, "_REPLY_WAIT_S", 0.01)
    monkeypatch.setattr(node, "is_due", lambda local_ns: local_ns >= 1)
    desk = CommandDesk()
    asker = Asker(desk, json_payloads.encode(Command.START))
    desk.pass_on(node, 0)
    assert not asker.reply().accepted
    desk.pass_on(node, 1)
    assert asked == []


def test_command_that_a_long_step_is_doing_gets_the_answer_of_that_step(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command_desk, "_REPLY_WAIT_S", 0.01)
    monkeypatch.setattr(command_desk, "_STEP_WAIT_S", 10.0)
    reply = TriedToTakeBack()
    reply.set_running_or_notify_cancel()
    with ThreadPoolExecutor(1) as pool:
        answer = pool.submit(command_desk.await_reply, reply)
        assert reply.tried.wait(10.0)
        reply.set_result(ACCEPTED)
        assert answer.result(10.0) == ACCEPTED


def test_command_that_a_step_never_answers_is_not_told_as_undone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command_desk, "_REPLY_WAIT_S", 0.01)
    monkeypatch.setattr(command_desk, "_STEP_WAIT_S", 0.01)
    reply: Future[CommandReply] = Future()
    reply.set_running_or_notify_cancel()
    assert "may still do it" in command_desk.await_reply(reply).reason


def test_what_is_asked_for_when_a_step_is_due_is_in_the_next_step() -> None:
    setup = Setup()
    setup.run(1.0)
    while not setup.node.is_due(setup.t_ns):
        setup.t_ns += 1_000_000
    setup.node.request(Command.HOLD)
    assert setup.node.poll(setup.t_ns)
    assert len(setup.node.take_replies()) == 1


def test_reply_that_nobody_waits_for_is_dropped() -> None:
    CommandDesk().answer([ACCEPTED])


def test_timings_are_quantiles_in_milliseconds() -> None:
    timings = Timings()
    timings.state_to_setpoint_s.extend(i * 1e-3 for i in range(100, 0, -1))
    summary = timings.summary()
    assert summary["steps"] == 100
    assert summary["state_to_setpoint_median_ms"] == pytest.approx(51.0)
    assert summary["state_to_setpoint_p99_ms"] == pytest.approx(100.0)
    assert summary["state_to_setpoint_max_ms"] == pytest.approx(100.0)


def test_timings_of_a_flight_without_steps_are_zero() -> None:
    assert Timings().summary()["state_to_setpoint_max_ms"] == 0.0
