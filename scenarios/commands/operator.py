"""Sending an operator's command to the companion over Zenoh."""

import time

from link.errors import UserError
from link.messages import Command, CommandReply
from link.payloads import json_messages
from link.payloads.checks import PayloadError
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, open_session

_MEETING_S = 5.0  # until the companion is found
_ANSWER_S = 3.0
_TRY_AGAIN_S = 0.1


def send_command(command: Command, keys: Keys, options: ZenohOptions) -> CommandReply:
    """Return the companion's answer.

    Args:
        command: what it is asked for.
        keys: of the Zenoh contract.
        options: how it is met.

    Raises:
        UserError: no companion answers, or somebody else does, too.
    """
    with open_session(options) as zenoh:
        deadline_s = time.monotonic() + _MEETING_S
        while time.monotonic() < deadline_s:
            answers = zenoh.query(keys.landing_command, json_messages.encode(command), _ANSWER_S)
            if answers:
                return _only(answers, keys)
            time.sleep(_TRY_AGAIN_S)
    where = ", ".join((*options.connect, *options.listen))
    at = f" at {where}" if where else ""
    raise UserError(f"no companion answers on {keys.landing_command}{at}: start it, or check --drone and -e")


def _only(answers: list[bytes], keys: Keys) -> CommandReply:
    """Return the only answer: with several nobody knows whose is the companion's."""
    try:
        replies = [json_messages.decode(CommandReply, answer) for answer in answers]
    except PayloadError as error:
        raise UserError(f"what answers on {keys.landing_command} is no companion: {error}") from error
    if len(replies) > 1:
        said = "; ".join(sorted("accepted" if one.accepted else f"refused: {one.reason}" for one in replies))
        raise UserError(f"{len(replies)} programs answer on {keys.landing_command}, so one is false; they say: {said}")
    return replies[0]
