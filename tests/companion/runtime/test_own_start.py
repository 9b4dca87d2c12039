"""The start that follows by itself: an operator who wants none is heard before it as after it."""

import pytest

from companion.runtime.start_and_handover import OwnStart
from companion.situation.phases import Phase
from link.errors import UserError
from link.messages import Command, CommandReply
from tests.companion.peer import KEYS, Setup
from tests.companion.world import PAD


def _flown(command: Command | None, at_s: float = 1.0) -> tuple[Setup, list[CommandReply]]:
    """Three seconds with a start that is to come, a vehicle from the second one on, and a command at `at_s`."""
    setup, start, replies = Setup(), OwnStart(wanted=True), []
    begun_ns, commands = setup.t_ns, [command]

    def turn() -> None:
        since_s = (setup.t_ns - begun_ns) * 1e-9
        if since_s >= 2.0:
            setup.node.receive_pad(PAD)
            setup.fix()
        if commands and since_s >= at_s and setup.node.is_due(setup.t_ns):
            wish = commands.pop()
            if wish is not None:
                setup.node.request(wish)
        if setup.node.inputs is not None:
            start.commanded(setup.node.inputs.command)
        replies.extend(start.answered(setup.node.take_replies()))
        start.follow(setup.node, fix_seen=since_s >= 2.0)

    setup.run(3.0, turn)
    return setup, replies


def test_start_follows_once_the_vehicle_is_there() -> None:
    setup, replies = _flown(None)
    assert setup.node.phase is Phase.TAKEOFF
    assert replies[-1].accepted


@pytest.mark.slow
@pytest.mark.parametrize("command", [Command.ABORT, Command.HOLD])
def test_abort_or_hold_before_it_calls_the_start_off_for_good(command: Command) -> None:
    setup, replies = _flown(command)
    assert setup.node.phase is Phase.IDLE
    assert not setup.autopilot.armed
    assert replies == [CommandReply(accepted=True, reason="the start that was to come is called off")]


def test_start_leaves_the_step_to_an_operators_command_that_waits() -> None:
    setup, start = Setup(), OwnStart(wanted=True)

    def turn() -> None:
        setup.node.receive_pad(PAD)
        setup.fix()
        if setup.node.phase is Phase.IDLE and not setup.node.commands.waits:
            setup.node.request(Command.HOLD)
        start.follow(setup.node, fix_seen=True)

    setup.run(3.0, turn)
    assert setup.node.is_ready_to_start()
    assert setup.node.phase is Phase.IDLE


def test_abort_without_a_start_to_come_is_refused_as_ever() -> None:
    start, refused = OwnStart(wanted=False), CommandReply(accepted=False, reason="nothing to abort in phase idle")
    assert not start.commanded(Command.ABORT)
    assert start.answered([refused]) == [refused]


def test_answer_to_who_called_it_off_by_mavlink_is_not_given_to_the_next_operator() -> None:
    start, refused = OwnStart(wanted=True), CommandReply(accepted=False, reason="nothing to hold in phase idle")
    assert start.commanded(Command.ABORT)
    assert start.answered([]) == []
    assert start.answered([refused]) == [refused]


def test_operators_own_start_calls_nothing_off() -> None:
    start = OwnStart(wanted=True)
    assert not start.commanded(Command.START)
    assert start.pending


def test_what_is_missing_is_said_only_to_who_waits_for_a_start() -> None:
    start = OwnStart(wanted=True)
    with pytest.raises(UserError, match=f"no vehicle fix on {KEYS.fix} within 5 s"):
        start.check_vehicle(KEYS, 5.0, fix_seen=False, pad_known=False)
    with pytest.raises(UserError, match="did not describe its pad"):
        start.check_vehicle(KEYS, 5.0, fix_seen=True, pad_known=False)
    start.commanded(Command.ABORT)
    start.check_vehicle(KEYS, 5.0, fix_seen=False, pad_known=False)
