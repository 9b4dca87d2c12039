"""The start that follows by itself with `--start`, and the drone handed over to its autopilot at the end."""

import time
from collections.abc import Callable

from companion.autopilots.messages import TOLD_S, may_turn
from companion.runtime.node import CompanionNode
from companion.situation.phases import Phase
from link.errors import UserError
from link.messages import Command, CommandReply
from link.recording.log import Log
from link.zenoh.keys import Keys


class OwnStart:
    """A start that is to come without an operator, until the flight has begun or an operator wants none.

    Args:
        wanted: whether one is to come.
    """

    def __init__(self, *, wanted: bool) -> None:
        self.pending = wanted
        self._called_off = False

    def commanded(self, command: Command | None) -> bool:
        """Take an operator's command; return whether it calls the start off."""
        if not self.pending or command not in (Command.ABORT, Command.HOLD):
            return False
        self.pending, self._called_off = False, True
        return True

    def follow(self, node: CompanionNode, *, fix_seen: bool) -> bool:
        """Ask for the start as soon as everything is there, and no operator's command waits.

        Return whether another companion of this drone has it called off: who waits for that one's end would arm a drone
        that has just landed.
        """
        if self.pending and _is_another_there(node):
            self.pending = False
            return True
        self.pending = self.pending and node.phase is Phase.IDLE
        is_free = node.is_ready_to_start() and not node.commands.waits
        if self.pending and fix_seen and node.vehicle.knows_pad and is_free:
            node.request(Command.START)
        return False

    def answered(self, replies: list[CommandReply]) -> list[CommandReply]:
        """Return the replies of a step; to the command that called the start off it has been a success."""
        called_off, self._called_off = self._called_off, False
        if not called_off or not replies:  # who called it off by MAVLink has its answer from there
            return replies
        return [CommandReply(accepted=True, reason="the start that was to come is called off"), *replies[1:]]

    def check_vehicle(self, keys: Keys, timeout_s: float, *, fix_seen: bool, pad_known: bool) -> None:
        """See to it that a vehicle is there that can be landed on.

        Raises:
            UserError: it is not, and a start is waiting for it.
        """
        if not self.pending:
            return
        if not fix_seen:
            raise UserError(
                f"no vehicle fix on {keys.fix} within {timeout_s:g} s: start the vehicle, "
                "or check --ns, --vehicle and -e"
            )
        if not pad_known:
            raise UserError(
                f"the vehicle did not describe its pad on {keys.pad} within {timeout_s:g} s: let it answer there"
            )


def _is_another_there(node: CompanionNode) -> bool:
    rival = None if node.inputs is None else node.inputs.rival
    return rival is not None and rival.is_this_drone


LEAVE_MAX_S = TOLD_S + 1.0
"""So long an end in flight may take: motors just asked for are told of by then, and what came next by a heartbeat."""


def hand_over(node: CompanionNode, turn: Callable[[], None], log: Log) -> None:
    """Let the autopilot hover by itself; it may take setpoints that stop for a fault, or fly on.

    Args:
        node: the companion.
        turn: of its loop, which sends and receives.
        log: says who has the drone.
    """
    driver = node.autopilot.driver
    if driver is None or not node.flies:
        return
    log.warning("ends with the motors under its command", phase=node.phase.value)
    node.leave()
    if not _is_released(node, turn):
        log.warning("handed over without an answer: the autopilot acts by its parameter", name=driver.timeout_parameter)
    elif motors_may_turn(node):
        log.warning("handed over: the autopilot flies the drone", mode=driver.hover_mode)
    else:
        log.info("the motors are off")


def motors_may_turn(node: CompanionNode) -> bool:
    """Return whether motors turned, or might have, at the last step; a node that has made none has ordered nothing."""
    made = node.inputs
    return made is not None and may_turn(node.autopilot.state.view, node.memory.control.driver, made.monotonic_ns)


def _is_released(node: CompanionNode, turn: Callable[[], None]) -> bool:
    until_s = time.monotonic() + LEAVE_MAX_S
    while node.flies and time.monotonic() < until_s:
        turn()
    return not node.flies
