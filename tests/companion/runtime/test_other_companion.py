"""A second companion of a drone that meets the first one over MAVLink only, passed on by the autopilot."""

import pytest

from companion.component.identity import heartbeat_state
from companion.situation.phases import Phase
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from link.mavlink.peer import LOST_AFTER_NS, companion_heartbeat
from link.messages import Command
from tests.companion.peer import Setup
from tests.companion.world import PAD

FLIES, IDLE = heartbeat_state(Phase.CHASE), heartbeat_state(Phase.IDLE)
NO_COMPANION_OF_OURS = mavlink.MAV_STATE_ACTIVE, 0  # as MAVROS tells, from the same address


def ready(heartbeat: tuple[int, int]) -> Setup:
    """A node that may be started, and that has just heard another companion."""
    setup = Setup(is_component=True)
    setup.node.receive_pad(PAD)
    setup.run(3.0, setup.fix)
    other = MavlinkCodec(1, mavlink.MAV_COMP_ID_ONBOARD_COMPUTER)
    setup.node.receive_mavlink(other.encode(companion_heartbeat(*heartbeat)), setup.t_ns)
    setup.run(0.1, setup.fix)
    return setup


@pytest.mark.parametrize("command", [Command.START, Command.START_ANYWAY])
def test_start_is_refused_while_another_companion_tells_that_it_flies_the_drone(command: Command) -> None:
    setup = ready(FLIES)
    setup.node.request(command)
    setup.run(1.0, setup.fix)
    (reply,) = setup.node.take_replies()
    assert (reply.accepted, "another companion" in reply.reason) == (False, True)
    assert setup.node.phase is Phase.IDLE
    assert setup.autopilot.setpoints() == []


@pytest.mark.parametrize("heartbeat", [IDLE, NO_COMPANION_OF_OURS])
def test_start_is_accepted_beside_a_component_that_flies_nothing(heartbeat: tuple[int, int]) -> None:
    setup = ready(heartbeat)
    setup.node.request(Command.START)
    setup.run(0.1, setup.fix)
    assert [reply.accepted for reply in setup.node.take_replies()] == [True]


def test_start_is_accepted_once_the_other_companion_is_silent() -> None:
    setup = ready(FLIES)
    setup.run(LOST_AFTER_NS * 1e-9 + 0.1, setup.fix)
    setup.node.request(Command.START)
    setup.run(0.1, setup.fix)
    assert [reply.accepted for reply in setup.node.take_replies()] == [True]


def test_companion_that_flies_is_not_stopped_by_an_echo_of_its_own_heartbeats() -> None:
    setup = ready(IDLE)
    setup.node.request(Command.START)
    setup.run(3.0, setup.fix)
    echo = MavlinkCodec(1, mavlink.MAV_COMP_ID_ONBOARD_COMPUTER)
    setup.node.receive_mavlink(echo.encode(companion_heartbeat(*FLIES)), setup.t_ns)
    setup.run(0.5, setup.fix)
    assert setup.node.phase is Phase.TAKEOFF
