"""A pilot who changes the mode before the autopilot has told that it follows setpoints."""

import pytest

from companion.core.reasons import Reason
from companion.situation.phases import Phase
from link.mavlink.dialect import mavlink
from link.messages import Command
from tests.companion.peer import OFFBOARD, POSITION, Setup
from tests.companion.runtime.setups import ready

ALTITUDE, HOLD = 0x0002_0000, 0x0304_0000
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


def test_start_that_the_autopilot_has_not_taken_is_asked_for_again() -> None:
    setup = started(HOLD)
    setup.autopilot.custom_mode = HOLD  # as before: the order was lost
    setup.run(2.0)
    assert setup.autopilot.custom_mode == OFFBOARD
    assert len(setup.autopilot.commands(SET_MODE)) == 2
