"""A companion that is ended, or killed and started again, as the drone is about to touch a roof that drives."""

from collections.abc import Sequence

import pytest

from companion.runtime.start_and_handover import LEAVE_MAX_S
from companion.situation.phases import Phase
from link.messages import Command, CommandReply
from scenarios.config import FIRMWARES, FirmwareName
from scenarios.faults.flight import FaultFlight
from scenarios.faults.trial import SEED, scenario_of
from scenarios.recordings.result import score_run
from scenarios.scoring.score import Tier

pytestmark = pytest.mark.slow

LOW_M = 0.1
SCORED_S = 2.5  # after the motors are off; the score looks at the drone 2 s after
TOUCHES_S = 3.0
RIDES_ALONG = "the drone stands on the vehicle"


class ListeningFlight(FaultFlight):
    """A flight whose operator keeps the answers."""

    def __init__(self, firmware: FirmwareName) -> None:
        self.replies: list[CommandReply] = []
        super().__init__(scenario_of(firmware), SEED)

    def _take(self, replies: Sequence[CommandReply]) -> None:
        self.replies += replies


def about_to_touch(firmware: FirmwareName) -> ListeningFlight:
    flight = ListeningFlight(firmware)
    flight.fly_to(Phase.DESCEND)
    while not flight.is_below(LOW_M):
        flight.step()
    assert flight.phase is Phase.DESCEND
    return flight


@pytest.mark.parametrize("firmware", FIRMWARES)
def test_companion_that_is_ended_lands_before_it_gives_the_drone_over(firmware: FirmwareName) -> None:
    flight = about_to_touch(firmware)
    flight.companion.leave()
    ends_s = flight.recording.elapsed_s + LEAVE_MAX_S
    while flight.companion.flies:
        flight.step()
        assert flight.recording.elapsed_s < ends_s
    flight.stop_companion(SCORED_S)
    flight.fly(SCORED_S)
    assert score_run(flight.scenario, SEED, flight.recording).tier is Tier.S3


def test_start_is_refused_to_a_drone_that_a_killed_companion_left_on_the_roof_with_its_motors_on() -> None:
    flight = about_to_touch("ardupilot")
    flight.restart_companion()
    flight.fly(TOUCHES_S)
    view = flight.companion.autopilot.state.view
    assert (view.armed, view.landed, view.in_control) == (True, False, True)
    flight.replies.clear()
    flight.companion.request(Command.START)
    flight.fly(1.0)
    assert flight.phase is Phase.IDLE
    assert [one.reason.partition(",")[0] for one in flight.replies] == [RIDES_ALONG]
