"""A take-off that is broken off before the drone has left the ground: its motors stop, and nothing hovers above it."""

from collections.abc import Sequence

import pytest

from companion.core.reasons import Reason
from companion.situation.phases import Phase
from link.messages import Command, CommandReply
from scenarios.config import FIRMWARES, FirmwareName
from scenarios.faults.flight import FaultFlight
from scenarios.faults.trial import SEED, scenario_of

WITHIN_S = 5.0
RISEN_M = 0.02
"""More than a drone on its feet moves."""


class _Flight(FaultFlight):
    """One whose motors have just been told to turn, on the ground."""

    def __init__(self, firmware: FirmwareName) -> None:
        super().__init__(scenario_of(firmware), SEED)
        self.replies: list[CommandReply] = []
        self.fly_to(Phase.TAKEOFF)
        while not self.companion.autopilot.state.view.armed:
            self.step()
        self.replies.clear()
        self.stood_m = self.height_m

    def _take(self, replies: Sequence[CommandReply]) -> None:
        self.replies += replies

    def told(self) -> tuple[str, str]:
        """Return the phase and the reason of the newest status."""
        status = self.recording.statuses[-1]
        return status.phase, status.reason_code

    def fly_until(self, phase: Phase) -> None:
        """Go on to a phase; fail where it does not come soon, or if the drone rises."""
        end_s = self.recording.elapsed_s + WITHIN_S
        while self.told()[0] != phase.value:
            self.step()
            assert self.recording.elapsed_s < end_s
            assert self.height_m < self.stood_m + RISEN_M


@pytest.mark.slow
@pytest.mark.parametrize("firmware", FIRMWARES)
@pytest.mark.parametrize("command", [Command.HOLD, Command.ABORT])
def test_take_off_that_is_broken_off_on_the_ground_ends_with_motors_off(
    firmware: FirmwareName, command: Command
) -> None:
    flight = _Flight(firmware)
    flight.companion.request(command)
    flight.fly_until(Phase.HOLD)
    flight.fly_until(Phase.IDLE)
    assert flight.told()[1] in {Reason.OPERATOR_HOLDS.name, Reason.OPERATOR_ABORTS.name}
    assert not flight.companion.autopilot.state.view.armed
    flight.companion.request(Command.START)
    flight.fly_to(Phase.WAITING)
    assert flight.height_m > 1.0


@pytest.mark.slow
@pytest.mark.parametrize("firmware", FIRMWARES)
def test_start_and_follow_are_refused_while_the_motors_stop_on_the_ground(firmware: FirmwareName) -> None:
    flight = _Flight(firmware)
    flight.companion.request(Command.HOLD)
    flight.fly(0.04)
    for command, why in ((Command.START, "being switched off"), (Command.RETURN, "does not fly the drone")):
        flight.companion.request(command)
        flight.fly(0.02)
        assert not flight.replies[-1].accepted
        assert why in flight.replies[-1].reason
        assert flight.told()[0] == Phase.HOLD.value
    flight.fly_until(Phase.IDLE)
