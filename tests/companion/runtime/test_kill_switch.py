"""A pilot who stops the motors by the kill switch: PX4 stays armed and in OFFBOARD, and they turn again with it."""

import pytest

from companion.core.reasons import Reason
from companion.situation.phases import Phase
from link.mavlink.dialect import mavlink
from link.messages import Command
from tests.companion.runtime.setups import flying, ready

KILLED, ACTIVE = mavlink.MAV_STATE_FLIGHT_TERMINATION, mavlink.MAV_STATE_ACTIVE


@pytest.mark.parametrize("released_after_s", [1.5, 60.0])
def test_drone_whose_motors_are_killed_is_the_pilots_also_once_they_turn_again(released_after_s: float) -> None:
    setup = flying()
    setup.autopilot.system_status = KILLED
    setup.run(min(released_after_s, 2.0))
    setup.autopilot.system_status = ACTIVE if released_after_s < 2.0 else KILLED
    told = len(setup.autopilot.setpoints())
    setup.run(3.0)
    assert setup.node.phase is Phase.PILOT
    assert setup.node.outputs is not None
    assert setup.node.outputs.status.reason_code == Reason.MOTORS_KILLED.name
    assert len(setup.autopilot.setpoints()) == told


def test_start_is_refused_while_the_kill_switch_is_on() -> None:
    setup = ready()
    setup.autopilot.system_status = KILLED
    setup.run(1.5)
    setup.node.request(Command.START)
    setup.run(1.0)
    assert setup.node.phase is Phase.IDLE
    assert setup.autopilot.commands(mavlink.MAV_CMD_DO_SET_MODE) == []
    setup.autopilot.system_status = ACTIVE
    setup.run(1.5)
    setup.node.request(Command.START)
    setup.run(3.0)
    assert setup.autopilot.armed
