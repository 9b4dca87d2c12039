"""A pilot who changes the mode before the autopilot has told that it follows setpoints."""

import pytest

from companion.core.reasons import Reason
from companion.situation.phases import Phase
from link.mavlink.dialect import mavlink
from link.messages import Command
from tests.companion.peer import OFFBOARD, POSITION, Setup
from tests.companion.runtime.setups import ready

ALTITUDE, HOLD = 0x0002_0000, 0x0304_0000
ACCEPTED, REJECTED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_TEMPORARILY_REJECTED
SET_MODE, ARM = mavlink.MAV_CMD_DO_SET_MODE, mavlink.MAV_CMD_COMPONENT_ARM_DISARM


def started(mode: int) -> Setup:
    """A node that was started in a mode, and whose order for another one has just reached the autopilot."""
    setup = ready()
    setup.autopilot.custom_mode = mode
    setup.run(1.5)
    setup.node.request(Command.START)
    for _ in range(1000):
        if setup.autopilot.commands(SET_MODE):
            break
        setup.run(0.005)
    assert setup.autopilot.custom_mode == OFFBOARD
    assert not setup.node.autopilot.state.view.in_control
    return setup


@pytest.mark.parametrize(("before", "chosen"), [(HOLD, POSITION), (POSITION, ALTITUDE)])
def test_mode_that_the_pilot_chooses_before_the_autopilot_tells_of_the_companions_is_left(
    before: int, chosen: int
) -> None:
    setup = started(before)
    setup.autopilot.custom_mode = chosen
    setup.run(5.0)
    assert setup.autopilot.custom_mode == chosen
    assert (len(setup.autopilot.commands(SET_MODE)), setup.autopilot.commands(ARM)) == (1, [])
    assert setup.node.phase is Phase.PILOT
    assert setup.node.outputs is not None
    assert setup.node.outputs.status.reason_code == Reason.MODE_CHANGED.name


@pytest.mark.parametrize("before", [HOLD, POSITION])
def test_mode_before_that_the_pilot_chooses_again_is_left_though_the_autopilot_has_accepted_another(
    before: int,
) -> None:
    setup = started(before)
    setup.run(0.005)  # the answer is heard
    setup.autopilot.custom_mode = before
    setup.run(5.0)
    assert setup.autopilot.custom_mode == before
    assert (len(setup.autopilot.commands(SET_MODE)), setup.autopilot.commands(ARM)) == (1, [])
    assert setup.node.phase is Phase.PILOT
    assert setup.node.outputs is not None
    assert setup.node.outputs.status.reason_code == Reason.MODE_CHANGED.name
    setup.node.request(Command.START)
    setup.run(3.0)
    assert setup.autopilot.custom_mode == OFFBOARD


@pytest.mark.parametrize("answers", [(), (REJECTED,), (ACCEPTED, REJECTED)])
def test_start_that_the_autopilot_has_not_taken_is_asked_for_again(answers: tuple[int, ...]) -> None:
    setup = ready()
    setup.autopilot.results[SET_MODE] = answers
    setup.node.request(Command.START)
    setup.run(3.0)
    assert len(setup.autopilot.commands(SET_MODE)) == 3
    assert setup.node.phase is Phase.TAKEOFF
    del setup.autopilot.results[SET_MODE]
    setup.run(2.0)
    assert setup.autopilot.custom_mode == OFFBOARD
    assert setup.autopilot.armed
