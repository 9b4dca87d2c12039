"""An abort, a hold or the program's end while the order to arm is under way: no motors turn that nobody flies."""

import pytest

from companion.core.reasons import Reason
from companion.runtime.start_and_handover import LEAVE_MAX_S, motors_may_turn
from companion.situation.phases import Phase
from link.mavlink.dialect import mavlink
from link.messages import Command
from tests.companion.peer import OFFBOARD, Setup
from tests.companion.runtime.setups import ready

ARM = mavlink.MAV_CMD_COMPONENT_ARM_DISARM
ENDS = [Command.ABORT, Command.HOLD]


def started(results: dict[int, tuple[int, ...]]) -> Setup:
    """A node whose order to arm has just reached the autopilot, which has told nothing of it yet."""
    setup = ready()
    setup.autopilot.results = results
    setup.node.request(Command.START)
    for _ in range(1000):
        if any(message.param1 == 1.0 for message in setup.autopilot.commands(ARM)):
            break
        setup.run(0.005)
    assert not setup.node.autopilot.state.view.armed
    setup.node.take_replies()
    return setup


@pytest.mark.parametrize("command", ENDS)
@pytest.mark.parametrize("later_s", [0.0, 0.3])
def test_drone_that_arms_on_the_ground_after_the_abort_is_switched_off(command: Command, later_s: float) -> None:
    setup = started({})
    setup.run(later_s)
    setup.node.request(command)
    setup.run(4.0)
    assert [reply.accepted for reply in setup.node.take_replies()] == [True]
    assert not setup.autopilot.armed
    assert setup.node.phase is Phase.IDLE
    arm, *disarms = (message.param1 for message in setup.autopilot.commands(ARM))
    assert arm == 1.0
    assert set(disarms) == {0.0}


@pytest.mark.parametrize("command", ENDS)
@pytest.mark.parametrize("later_s", [0.0, 0.3])
def test_drone_that_has_left_the_ground_after_the_abort_is_held_and_not_left_alone(
    command: Command, later_s: float
) -> None:
    setup = started({})
    setup.autopilot.landed_state = mavlink.MAV_LANDED_STATE_IN_AIR
    setup.run(later_s)
    setup.node.request(command)
    setup.run(4.0)
    assert [reply.accepted for reply in setup.node.take_replies()] == [True]
    assert setup.autopilot.armed
    assert setup.node.phase is Phase.HOLD
    sent = len(setup.autopilot.setpoints())
    setup.run(1.0)
    assert len(setup.autopilot.setpoints()) - sent > 40
    assert len(setup.autopilot.commands(ARM)) == 1


@pytest.mark.parametrize("command", ENDS)
@pytest.mark.parametrize("answers", [(mavlink.MAV_RESULT_DENIED,), ()])
def test_take_off_whose_order_to_arm_fails_after_the_abort_is_called_off(
    command: Command, answers: tuple[int, ...]
) -> None:
    setup = started({ARM: answers})
    setup.node.request(command)
    setup.run(4.0)
    assert not setup.autopilot.armed
    assert setup.node.phase is Phase.IDLE
    sent = len(setup.autopilot.setpoints())
    setup.run(1.0)
    assert len(setup.autopilot.setpoints()) == sent


@pytest.mark.parametrize("after_s", [0.0, 0.01])
def test_motors_that_a_person_stops_before_a_heartbeat_told_of_them_stay_off(after_s: float) -> None:
    setup = started({})
    setup.run(after_s)
    assert setup.autopilot.armed
    assert not setup.node.autopilot.state.view.armed
    setup.autopilot.armed = False
    setup.run(5.0)
    assert [message.param1 for message in setup.autopilot.commands(ARM)] == [1.0]
    assert setup.node.phase is Phase.PILOT
    assert setup.node.outputs is not None
    assert setup.node.outputs.status.reason_code == Reason.DISARMED.name


def test_drone_that_arms_on_the_ground_as_the_companion_ends_is_disarmed_once_it_tells_that_it_is_armed() -> None:
    setup = started({})
    assert setup.autopilot.armed
    assert setup.node.flies
    setup.node.leave()
    setup.run(LEAVE_MAX_S)
    orders = {(message.param1, message.param2) for message in setup.autopilot.commands(ARM)[1:]}
    assert orders == {(0.0, 0.0)}  # plain ones
    assert not setup.node.autopilot.state.view.armed
    assert not motors_may_turn(setup.node)


def test_drone_that_arms_as_the_companion_ends_and_may_fly_is_handed_over_and_not_said_to_be_off() -> None:
    setup = started({})
    setup.autopilot.landed_state = mavlink.MAV_LANDED_STATE_IN_AIR
    setup.run(0.2)
    assert setup.autopilot.armed
    assert setup.node.flies
    setup.node.leave()
    setup.run(0.2)
    assert setup.autopilot.custom_mode != OFFBOARD
    assert motors_may_turn(setup.node)
