"""The parts of the wire loop that can be tried without sockets: the desk for commands, and the timings."""

import json

import pytest

from companion.runtime.command_desk import CommandDesk
from companion.runtime.node import CompanionNode
from companion.runtime.options import Timings
from link.messages import Command, CommandReply, Order
from link.payloads import json_messages as json_payloads
from scenarios.attack.flood import order_of_many_names
from tests.companion.peer import Setup

ACCEPTED = CommandReply(accepted=True, reason="")


class Asker:
    """An operator's query at a desk, and the answers to it."""

    def __init__(self, desk: CommandDesk, command: Command | bytes) -> None:
        self._replies: list[bytes] = []
        desk.take(
            json_payloads.encode(Order(command=command)) if isinstance(command, Command) else command,
            self._replies.append,
        )

    def reply(self) -> CommandReply | None:
        """The only answer, None while there is none."""
        assert len(self._replies) <= 1
        return json_payloads.decode(CommandReply, self._replies[0]) if self._replies else None


class Now:
    """A clock that is set by hand."""

    def __init__(self) -> None:
        self.s = 5.0

    def __call__(self) -> float:
        return self.s


@pytest.fixture
def node() -> CompanionNode:
    return Setup().node


@pytest.fixture
def asked(node: CompanionNode, monkeypatch: pytest.MonkeyPatch) -> list[Command]:
    commands: list[Command] = []
    monkeypatch.setattr(node, "request", lambda command, _station: commands.append(command))
    monkeypatch.setattr(node, "is_due", lambda local_ns: local_ns >= 1)
    return commands


def test_of_two_stations_at_once_the_later_is_followed(node: CompanionNode, asked: list[Command]) -> None:
    desk = CommandDesk()
    first, later = (Asker(desk, b'{"command": "follow", "offset_m": [-6, 2, %d]}' % height_m) for height_m in (3, 4))
    desk.pass_on(node, 1)
    desk.answer([ACCEPTED])
    refused = first.reply()
    assert refused is not None
    assert not refused.accepted
    assert later.reply() == ACCEPTED
    assert asked == [Command.FOLLOW]


def test_an_order_that_no_operator_writes_is_refused_unread(node: CompanionNode, asked: list[Command]) -> None:
    desk = CommandDesk()
    refused = Asker(desk, order_of_many_names()).reply()
    assert refused is not None
    assert not refused.accepted
    assert refused.reason == "an order has 1024 bytes at most"
    desk.pass_on(node, 1)
    assert asked == []


def test_reply_goes_to_who_asked(node: CompanionNode, asked: list[Command]) -> None:
    desk = CommandDesk()
    asker = Asker(desk, Command.START)
    desk.pass_on(node, 1)
    assert asker.reply() is None
    desk.answer([ACCEPTED])
    assert asker.reply() == ACCEPTED
    assert asked == [Command.START]


def test_commands_reach_the_node_one_at_a_time_and_what_ends_a_landing_first(
    node: CompanionNode, asked: list[Command]
) -> None:
    desk = CommandDesk()
    askers = [Asker(desk, command) for command in (Command.START, Command.HOLD, Command.ABORT)]
    for number in range(3):
        for _ in range(5):
            desk.pass_on(node, 1)
        desk.answer([CommandReply(accepted=False, reason=str(number))])
    assert asked == [Command.ABORT, Command.HOLD, Command.START]
    replies = [asker.reply() for asker in askers]
    assert [reply.reason for reply in replies if reply is not None] == ["2", "1", "0"]


def test_all_who_wait_for_the_same_command_get_the_answer_of_one_step(
    node: CompanionNode, asked: list[Command]
) -> None:
    desk = CommandDesk()
    askers = [Asker(desk, Command.START) for _ in range(40)]
    desk.pass_on(node, 1)
    later = Asker(desk, Command.START)
    desk.answer([ACCEPTED])
    assert all(asker.reply() == ACCEPTED for asker in askers)
    assert later.reply() is None
    assert asked == [Command.START]


def test_payload_that_is_no_command_is_refused_and_never_passed_on(node: CompanionNode, asked: list[Command]) -> None:
    desk = CommandDesk()
    for payload in (b"", b"start", b'{"command": "land"}', json.dumps({"command": "start", "when": "later"}).encode()):
        reply = Asker(desk, payload).reply()
        assert reply is not None
        assert not reply.accepted
    desk.pass_on(node, 1)
    assert asked == []


def test_command_that_no_step_took_in_time_is_refused_and_not_done_later(
    node: CompanionNode, asked: list[Command]
) -> None:
    now = Now()
    desk = CommandDesk(now)
    late = Asker(desk, Command.START)
    desk.pass_on(node, 0)
    now.s += 2.1
    in_time = Asker(desk, Command.START)
    desk.pass_on(node, 1)
    assert late.reply() == CommandReply(accepted=False, reason="the companion made no step in time")
    assert asked == [Command.START]
    desk.answer([ACCEPTED])
    assert in_time.reply() == ACCEPTED


def test_commands_that_wait_are_bounded(node: CompanionNode, asked: list[Command]) -> None:
    desk = CommandDesk()
    askers = [Asker(desk, Command.START) for _ in range(1000)]
    abort = Asker(desk, Command.ABORT)
    desk.pass_on(node, 1)
    desk.answer([ACCEPTED])
    assert abort.reply() == ACCEPTED
    desk.pass_on(node, 1)
    desk.answer([ACCEPTED])
    assert sum(asker.reply() is not None for asker in askers) == 64
    assert asked == [Command.ABORT, Command.START]


def test_what_is_asked_for_when_a_step_is_due_is_in_the_next_step() -> None:
    setup = Setup()
    setup.run(1.0)
    while not setup.node.is_due(setup.t_ns):
        setup.t_ns += 1_000_000
    setup.node.request(Command.HOLD)
    assert setup.node.poll(setup.t_ns)
    assert len(setup.node.take_replies()) == 1


def test_start_for_a_vehicle_that_nothing_is_heard_of_is_refused_with_what_was_refused_and_may_be_forced() -> None:
    setup = Setup()
    setup.run(2.0)
    assert setup.node.is_ready_to_start()
    setup.fix(late_s=-4.4)
    setup.run(0.1)
    desk = CommandDesk()
    asker, forced = Asker(desk, Command.START), Asker(desk, Command.START_ANYWAY)
    while not setup.node.is_due(setup.t_ns):
        setup.t_ns += 1_000_000
    desk.pass_on(setup.node, setup.t_ns)
    assert asker.reply() is None
    desk.answer([ACCEPTED])
    assert forced.reply() == ACCEPTED
    desk.pass_on(setup.node, setup.t_ns)
    reply = asker.reply()
    assert reply is not None
    assert not reply.accepted
    assert "fix: 1 refused, come 4." in reply.reason
    assert "s before their stamps" in reply.reason


def test_reply_that_nobody_waits_for_is_dropped() -> None:
    desk = CommandDesk()
    desk.answer([ACCEPTED])
    later = Asker(desk, Command.ABORT)
    assert later.reply() is None
    desk.answer([])
    assert later.reply() is None


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
