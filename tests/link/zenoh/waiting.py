"""Waits for what other Zenoh sessions bring about."""

import time
from collections.abc import Callable

from link.zenoh.session import ZenohSession

DEADLINE_S = 30.0


def until(session: ZenohSession, condition: Callable[[], bool]) -> None:
    """Wait, woken by what `session` receives, until `condition` holds."""
    end_s = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < end_s, "the deadline has passed"
        session.wake_up.wait(0.01)
