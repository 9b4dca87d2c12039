"""Those who look on while the companion's loop goes on: views over Zenoh, and a person at the terminal."""

import sys
from contextlib import ExitStack
from typing import Protocol

from companion.runtime.live_state import LiveState
from companion.runtime.node import CompanionNode
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession


class Onlooker(Protocol):
    """Somebody who is told of each step; telling returns at once."""

    def tell(self, node: CompanionNode, local_ns: int) -> None:
        """Tell of the step that `node` made at `local_ns`."""

    def close(self) -> None:
        """End it."""


def onlookers(stack: ExitStack, zenoh: ZenohSession, keys: Keys, device: str) -> list[Onlooker]:
    """Return who looks on, to be closed with `stack`."""
    found: list[Onlooker] = [LiveState(zenoh, keys)]
    if sys.stdout.isatty():
        from companion.runtime.terminal import Terminal  # noqa: PLC0415 (its library takes memory that a flight need not)

        found.append(Terminal(device))
    for one in found:
        stack.callback(one.close)
    return found
