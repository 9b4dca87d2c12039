"""Sending an operator's command to the companion over Zenoh."""

import difflib
import math
import time
from enum import Enum
from typing import TypeVar

from link.errors import UserError
from link.messages import Command, CommandReply, Order, Station, StationFrame, Vector3
from link.payloads import json_messages
from link.payloads.checks import PayloadError
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, open_session

E = TypeVar("E", bound=Enum)

_MEETING_S = 5.0  # until the companion is found
_SEEING_S = 2.0  # until its token is; then the order goes out all the same, for an abort is worth a try
_ANSWER_S = 3.0
_TRY_AGAIN_S = 0.1


def order_of(command: str, offset_m: Vector3 | None, frame: str | None) -> Order:
    """Return the order that an operator has written.

    Raises:
        UserError: there is no such command or frame, a follow has no finite offset, or another command has one.
    """
    wanted = _named(Command, "command", command)
    if wanted is not Command.FOLLOW:
        if offset_m is not None or frame is not None:
            raise UserError(f"{command} takes no --offset and no --frame: give them to follow")
        return Order(command=wanted)
    if offset_m is None:
        raise UserError("follow needs --offset AHEAD LEFT UP, in metres from the pad's centre")
    if not all(math.isfinite(one) for one in offset_m):
        raise UserError(f"--offset {' '.join(map(str, offset_m))}: give three finite numbers of metres")
    looks = StationFrame.VEHICLE if frame is None else _named(StationFrame, "frame", frame)
    return Order(command=wanted, station=Station(offset_m=offset_m, frame=looks))


def _named(kind: type[E], what: str, name: str) -> E:
    try:
        return kind(name)
    except ValueError:
        known = [one.value for one in kind]
        near = difflib.get_close_matches(name, known, n=1)
        meant = f"did you mean {near[0]}?" if near else f"give one of {', '.join(known)}"
        raise UserError(f"{what} '{name}' does not exist: {meant}") from None


def send_order(order: Order, keys: Keys, options: ZenohOptions) -> CommandReply:
    """Return the companion's answer.

    Anybody can answer where Zenoh is open to strangers, so an answer counts while a companion shows by its liveliness
    token that it runs. Who forges that, too, only certificates keep out.

    Args:
        order: what it is asked for.
        keys: of the Zenoh contract.
        options: how it is met.

    Raises:
        UserError: no companion answers, or somebody else does.
    """
    with open_session(options) as zenoh:
        companions = zenoh.watch_alive(keys.companion_alive("*"))
        began_s = time.monotonic()
        while (waited_s := time.monotonic() - began_s) < _MEETING_S:
            if companions.alive or waited_s > _SEEING_S:
                answers = zenoh.query(keys.landing_command, json_messages.encode(order), _ANSWER_S)
                if answers and not companions.alive:
                    raise UserError(
                        f"no companion runs, but somebody answers on {keys.landing_command}: do not trust it"
                    )
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
        said = "; ".join(sorted(map(str, replies)))
        raise UserError(f"{len(replies)} programs answer on {keys.landing_command}: end all but one; they say: {said}")
    return replies[0]
