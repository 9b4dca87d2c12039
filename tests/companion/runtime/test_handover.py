"""The drone handed over at the program's end: the log says what has become of it, on the ground as in flight."""

from io import StringIO

import pytest

from companion.runtime.start_and_handover import hand_over
from companion.situation.phases import Phase
from link.mavlink.dialect import mavlink
from link.messages import Command
from link.recording.log import Log
from tests.companion.peer import TICK_NS, Setup
from tests.companion.world import PAD


def taking_off(landed_state: int) -> Setup:
    """A node that is ended during its take-off, with the motors on."""
    setup = Setup()
    setup.node.receive_pad(PAD)
    setup.run(3.0, setup.fixes)
    setup.node.request(Command.START)
    setup.run(2.5, setup.fixes)
    setup.autopilot.landed_state = landed_state
    setup.run(0.5, setup.fixes)
    assert setup.autopilot.armed
    assert setup.node.phase is Phase.TAKEOFF
    return setup


@pytest.mark.parametrize(
    ("landed_state", "said", "unsaid"),
    [
        (mavlink.MAV_LANDED_STATE_ON_GROUND, "the motors are off", "Hold"),
        (mavlink.MAV_LANDED_STATE_IN_AIR, "mode=Hold", "the motors are off"),
    ],
)
def test_log_says_what_has_become_of_the_drone(landed_state: int, said: str, unsaid: str) -> None:
    setup, lines = taking_off(landed_state), StringIO()
    log = Log("companion", lines)
    hand_over(setup.node, lambda: setup.run(TICK_NS * 1e-9), log)
    log.close()
    told = lines.getvalue()
    assert said in told
    assert unsaid not in told
    assert "in flight" not in told
