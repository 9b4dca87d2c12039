"""Nodes beside a PX4 that is ready, and one that flies."""

from link.messages import Command
from tests.companion.peer import OFFBOARD, Setup


def ready() -> Setup:
    """A node that may be started."""
    setup = Setup()
    setup.run(3.0)
    assert setup.node.is_ready_to_start()
    return setup


def flying() -> Setup:
    """A node whose drone takes off."""
    setup = ready()
    setup.node.request(Command.START)
    setup.run(3.0)
    assert setup.autopilot.armed
    assert setup.autopilot.custom_mode == OFFBOARD
    return setup
