"""The start that follows by itself with `--start`: what it still waits for, and who calls it off."""

from companion.runtime.node import CompanionNode
from companion.situation.phases import Phase
from link.errors import UserError
from link.keys import Keys
from link.messages import Command, CommandReply


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

    def follow(self, node: CompanionNode, *, fix_seen: bool) -> None:
        """Ask for the start as soon as everything is there."""
        self.pending = self.pending and node.phase is Phase.IDLE
        if self.pending and fix_seen and node.pad_known and node.is_ready_to_start():
            node.request(Command.START)

    def answered(self, replies: list[CommandReply]) -> list[CommandReply]:
        """Return the replies of a step; to the command that called the start off it has been a success."""
        if not self._called_off or not replies:
            return replies
        self._called_off = False
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
