"""Commands of ground stations that wait for a step: which goes first, and which is obeyed once."""

from companion.component.commands import StationCommands
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.messages import Command, CommandReply

START, HOLD, ABORT, LAUNCH = (int(getattr(mavlink, f"MAV_CMD_USER_{number}")) for number in range(1, 5))
REJECTED = mavlink.MAV_RESULT_TEMPORARILY_REJECTED
OWN = 1, mavlink.MAV_COMP_ID_ONBOARD_COMPUTER


def _given(number: int, sequence: int = 0, system: int = 255) -> Message:
    """A command as it comes, the `sequence`-th message of its sender."""
    sent = mavlink.MAVLink_command_long_message(*OWN, number, 0, 0, 0, 0, 0, 0, 0, 0)
    (message,) = MavlinkCodec(*OWN).decode(MavlinkCodec(system, 190, first_number=sequence).encode(sent))
    return message


def _is_obeyed(commands: StationCommands, message: Message, t_s: float, *, accepts: bool = True) -> bool:
    t_ns = round(t_s * 1e9)
    answers = commands.take(message, t_ns)
    if commands.next() is not None:
        commands.answer(CommandReply(accepted=accepts, reason=""), t_ns)
    return answers == []


def test_what_waits_to_begin_is_refused_and_what_ends_a_landing_still_waits() -> None:
    commands = StationCommands()
    for sequence, number in enumerate((START, ABORT, HOLD, LAUNCH)):
        assert commands.take(_given(number, sequence), 0) == []
    refused = [(one.command, one.result) for one in commands.refuse_beginnings()]
    assert refused == [(START, REJECTED), (LAUNCH, REJECTED)]
    assert [commands.next(), commands.next(), commands.next()] == [Command.ABORT, Command.HOLD, None]


def test_abort_goes_before_however_many_starts_that_wait_and_finds_room() -> None:
    commands = StationCommands()
    refused = [commands.take(_given(START, system=system), 0) for system in range(1, 18)]
    assert [one.command for answer in refused for one in answer] == [START]
    assert [(one.command, one.target_system) for one in commands.take(_given(ABORT), 0)] == [(START, 16)]
    assert [commands.next(only_ends=True), commands.next(only_ends=True)] == [Command.ABORT, None]
    assert commands.next() is Command.START


def test_command_that_begins_something_is_obeyed_once_however_often_its_datagram_comes() -> None:
    commands = StationCommands()
    assert _is_obeyed(commands, _given(LAUNCH, 7), 0.0)
    assert _is_obeyed(commands, _given(HOLD, 8), 1.0)
    for t_s in (1.1, 15.0, 29.0):
        (answer,) = commands.take(_given(LAUNCH, 7), round(t_s * 1e9))
        assert answer.result == REJECTED
    assert _is_obeyed(commands, _given(LAUNCH, 9), 29.0)
    assert _is_obeyed(commands, _given(LAUNCH, 7), 30.5)  # of a script that began its numbers anew


def test_command_that_was_refused_may_come_again_and_what_ends_a_landing_always() -> None:
    commands = StationCommands()
    assert _is_obeyed(commands, _given(START, 7), 0.0, accepts=False)
    assert _is_obeyed(commands, _given(START, 7), 0.1)
    assert [_is_obeyed(commands, _given(ABORT, 8), t_s) for t_s in (1.0, 1.1, 2.0)] == [True] * 3
