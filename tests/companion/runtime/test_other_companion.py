"""A second companion of a drone that meets the first one over MAVLink only, passed on by the autopilot."""

import pytest

from companion.component.identity import heartbeat_state
from companion.runtime.start_and_handover import OwnStart
from companion.situation.phases import Phase
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.peer import LOST_AFTER_NS, companion_heartbeat
from link.messages import Command
from tests.companion.peer import POSITION, Setup
from tests.companion.world import PAD

ARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM
FLIES, IDLE = heartbeat_state(Phase.CHASE), heartbeat_state(Phase.IDLE)
NO_COMPANION_OF_OURS = mavlink.MAV_STATE_ACTIVE, 0  # as MAVROS tells, from the same address


def hear(setup: Setup, heartbeat: tuple[int, int]) -> None:
    """Let the node hear another companion."""
    other = MavlinkCodec(1, mavlink.MAV_COMP_ID_ONBOARD_COMPUTER)
    setup.node.receive_mavlink(other.encode(companion_heartbeat(*heartbeat)), setup.t_ns)


def ready(heartbeat: tuple[int, int]) -> Setup:
    """A node that may be started, and that has just heard another companion."""
    setup = Setup(is_component=True)
    setup.node.receive_pad(PAD)
    setup.run(3.0, setup.fixes)
    hear(setup, heartbeat)
    setup.run(0.1, setup.fixes)
    return setup


def with_own_start(heard_after_s: float | None, later_s: float = 1.5) -> Setup:
    """A node that is to start by itself, and hears after a while another companion that flies."""
    setup, start = Setup(is_component=True), OwnStart(wanted=True)
    setup.node.receive_pad(PAD)
    begun_ns, unheard = setup.t_ns, heard_after_s is not None

    def turn() -> None:
        nonlocal unheard
        setup.fixes()
        if unheard and heard_after_s is not None and (setup.t_ns - begun_ns) * 1e-9 > heard_after_s:
            hear(setup, FLIES)
            unheard = False
        start.follow(setup.node, fix_seen=True)

    setup.run(LOST_AFTER_NS * 1e-9 + later_s, turn)
    return setup


@pytest.mark.parametrize("command", [Command.START, Command.START_ANYWAY])
def test_start_is_refused_while_another_companion_tells_that_it_flies_the_drone(command: Command) -> None:
    setup = ready(FLIES)
    setup.node.request(command)
    setup.run(1.0, setup.fixes)
    (reply,) = setup.node.take_replies()
    assert (reply.accepted, "another companion" in reply.reason) == (False, True)
    assert setup.node.phase is Phase.IDLE
    assert setup.autopilot.setpoints() == []


@pytest.mark.parametrize("heartbeat", [IDLE, NO_COMPANION_OF_OURS])
def test_start_is_accepted_beside_a_component_that_flies_nothing(heartbeat: tuple[int, int]) -> None:
    setup = ready(heartbeat)
    setup.node.request(Command.START)
    setup.run(0.1, setup.fixes)
    assert [reply.accepted for reply in setup.node.take_replies()] == [True]


def test_start_is_accepted_once_the_other_companion_is_silent() -> None:
    setup = ready(FLIES)
    setup.run(LOST_AFTER_NS * 1e-9 + 0.1, setup.fixes)
    setup.node.request(Command.START)
    setup.run(0.1, setup.fixes)
    assert [reply.accepted for reply in setup.node.take_replies()] == [True]


def test_companion_in_the_air_is_not_stopped_by_heartbeats_of_another_one() -> None:
    setup = ready(IDLE)
    setup.node.request(Command.START)
    setup.run(3.0, setup.fixes)
    setup.autopilot.landed_state = mavlink.MAV_LANDED_STATE_IN_AIR
    setup.run(0.5, setup.fixes)
    hear(setup, FLIES)
    setup.run(0.5, setup.fixes)
    assert setup.node.phase is Phase.TAKEOFF


@pytest.mark.parametrize(("heard_after_s", "phase"), [(None, Phase.TAKEOFF), (2.9, Phase.IDLE)])
def test_own_start_waits_until_three_heartbeats_of_another_companion_would_have_been_heard(
    heard_after_s: float | None, phase: Phase
) -> None:
    assert with_own_start(heard_after_s).node.phase is phase


def test_own_start_that_met_another_companion_does_not_follow_once_that_one_has_landed() -> None:
    setup = with_own_start(2.9, later_s=LOST_AFTER_NS * 1e-9 + 1.0)
    assert setup.node.phase is Phase.IDLE
    assert setup.autopilot.setpoints() == []


def told_of_start(setup: Setup) -> Message:
    """The heartbeat that comes within a tenth of a second after a start."""
    setup.node.request(Command.START)
    told = len(setup.autopilot.of_type("HEARTBEAT"))
    setup.run(0.1, setup.fixes)
    (heartbeat,) = setup.autopilot.of_type("HEARTBEAT")[told:]
    return heartbeat


def test_start_is_told_at_once_and_not_with_the_next_second() -> None:
    heartbeat = told_of_start(ready(IDLE))
    assert heartbeat.system_status == mavlink.MAV_STATE_ACTIVE


def test_dry_run_that_is_started_is_no_companion_that_flies() -> None:
    dry = Setup(is_component=True, dry_run=True)
    dry.node.receive_pad(PAD)
    dry.run(3.0, dry.fixes)
    heartbeat = told_of_start(dry)
    assert dry.node.phase is Phase.TAKEOFF
    other = ready((heartbeat.system_status, heartbeat.custom_mode))
    other.node.request(Command.START)
    other.run(0.1, other.fixes)
    assert [reply.accepted for reply in other.node.take_replies()] == [True]


@pytest.mark.parametrize("after_s", [0.1, 2.5])
def test_who_still_stands_gives_way_to_one_that_started_at_the_same_moment(after_s: float) -> None:
    setup = ready(IDLE)
    setup.node.request(Command.START)
    setup.run(after_s, setup.fixes)
    hear(setup, FLIES)
    setup.run(0.1, setup.fixes)
    setpoints = len(setup.autopilot.setpoints())
    setup.run(1.0, setup.fixes)
    assert setup.node.phase is Phase.PILOT
    assert len(setup.autopilot.setpoints()) == setpoints


def texts(setup: Setup) -> str:
    """What the node has told ground stations."""
    return "".join(message.text for message in setup.autopilot.of_type("STATUSTEXT"))


def giving_way(*, is_armed_by_pilot: bool = False, command: Command = Command.START) -> Setup:
    """A node that hears, its drone armed on the ground, that another one has started it at the same moment."""
    setup = ready(IDLE)
    setup.autopilot.armed = is_armed_by_pilot
    setup.run(1.5, setup.fixes)
    setup.node.request(command)
    setup.run(2.5, setup.fixes)
    assert setup.autopilot.armed
    hear(setup, FLIES)
    return setup


def test_who_gives_way_stops_the_motors_that_it_has_ordered_on_the_ground_and_says_so_once() -> None:
    setup = giving_way()
    setup.run(2.0, setup.fixes)
    assert not setup.autopilot.armed
    assert texts(setup).count("another companion is there") == 1


def test_who_gives_way_while_its_order_to_arm_is_under_way_stops_the_motors() -> None:
    setup = ready(IDLE)
    setup.node.request(Command.START)
    while not setup.autopilot.commands(ARM):
        setup.run(0.005, setup.fixes)
    assert not setup.node.autopilot.state.view.armed
    hear(setup, FLIES)
    setup.run(2.0, setup.fixes)
    assert not setup.autopilot.armed


def test_of_two_that_launch_from_a_deck_at_the_same_moment_both_give_way() -> None:
    def stand() -> None:
        setup.fixes((0.0, 0.0, 0.0))

    setup = Setup(is_component=True)
    setup.node.receive_pad(PAD)
    setup.run(3.0, stand)
    setup.node.request(Command.LAUNCH)
    setup.run(0.3, stand)
    assert [reply.accepted for reply in setup.node.take_replies()] == [True]
    hear(setup, FLIES)
    setup.run(2.0, stand)
    assert setup.node.phase is Phase.PILOT
    assert not setup.autopilot.armed


def test_who_gives_way_leaves_motors_that_it_has_not_ordered() -> None:
    setup = giving_way(is_armed_by_pilot=True)
    setup.run(2.0, setup.fixes)
    assert setup.node.phase is Phase.PILOT
    assert setup.autopilot.armed


def test_who_has_given_way_leaves_the_motors_to_a_pilot_who_has_changed_the_mode() -> None:
    setup = giving_way()
    setup.autopilot.results = {ARM: ()}  # the disarm gets lost
    setup.run(0.1, setup.fixes)
    setup.autopilot.custom_mode = POSITION
    setup.run(1.5, setup.fixes)
    told = len(setup.autopilot.commands(ARM))
    setup.run(2.0, setup.fixes)
    assert len(setup.autopilot.commands(ARM)) == told
    assert setup.autopilot.armed


def test_drone_in_the_air_is_not_disarmed_by_who_gives_way() -> None:
    setup = ready(IDLE)
    setup.autopilot.armed, setup.autopilot.landed_state = True, mavlink.MAV_LANDED_STATE_IN_AIR
    setup.run(1.5, setup.fixes)
    setup.node.request(Command.START)
    setup.run(1.5, setup.fixes)
    hear(setup, FLIES)
    setup.run(2.0, setup.fixes)
    assert setup.node.phase is Phase.PILOT
    assert setup.autopilot.commands(ARM) == []


def test_echo_of_its_own_heartbeat_is_no_other_companion() -> None:
    setup = ready(IDLE)
    heartbeat = told_of_start(setup)
    setup.node.receive_mavlink(bytes(heartbeat.get_msgbuf()), setup.t_ns)
    setup.run(3.0, setup.fixes)
    assert setup.autopilot.armed
