"""A landing by the transmitter's switch alone, with both firmwares' stand-ins."""

import pytest

from companion.runtime.node import CompanionNode
from companion.situation.phases import Phase
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from scenarios.catalogue.catalogue import load_changed_scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.recordings.result import score_run
from scenarios.scoring.score import Tier

pytestmark = pytest.mark.slow

SEED = 1
LOW, MIDDLE, HIGH = 1000, 1500, 2000
PERIOD_NS = 50_000_000
LIMIT_S = 60.0


class SwitchedLanding(Lockstep):
    """A run whose pilot has a switch on channel 7 and sticks that stay in the middle; nobody else commands anything."""

    def __init__(self, firmware: str) -> None:
        switch = "system.companion.autopilot.pilot_switch"
        self.scenario = load_changed_scenario(
            f"straight_5+firmware={firmware}", [f"{switch}.channel=7", f"{switch}.arms=true"]
        )
        super().__init__(self.scenario, SEED)
        self.pulse_us = LOW
        self._transmitter = MavlinkCodec(255, mavlink.MAV_COMP_ID_MISSIONPLANNER)
        self._due_ns = 0

    def step(self) -> None:
        """Advance by one step, after what the receiver hears now."""
        if self.simulation.t_ns >= self._due_ns:
            self._due_ns = self.simulation.t_ns + PERIOD_NS
            sticks, others = [1500] * 4, [MIDDLE, MIDDLE, self.pulse_us, MIDDLE]
            message = mavlink.MAVLink_rc_channels_override_message(1, 1, *sticks, *others)
            self.simulation.receive(self._transmitter.encode(message))
        super().step()

    def _command(self, node: CompanionNode) -> None:
        """Leave it to the pilot."""

    def fly_until(self, *phases: Phase) -> Phase:
        """Fly until one of `phases`."""
        while self.companion.phase not in phases:
            assert self.recording.elapsed_s < LIMIT_S, f"still in {self.companion.phase.value}"
            self.step()
        return self.companion.phase

    def fly_for(self, duration_s: float) -> None:
        until_s = self.recording.elapsed_s + duration_s
        while self.recording.elapsed_s < until_s:
            self.step()


@pytest.mark.parametrize("firmware", ["px4", "ardupilot"])
def test_pilot_who_switches_on_lands(firmware: str) -> None:
    flight = SwitchedLanding(firmware)
    flight.fly_for(3.0)
    assert flight.companion.phase is Phase.IDLE
    flight.pulse_us = HIGH
    flight.fly_until(Phase.SECURED)
    flight.fly_for(5.0)  # it stays on the pad
    assert score_run(flight.scenario, SEED, flight.recording).tier is Tier.S3


@pytest.mark.parametrize("firmware", ["px4", "ardupilot"])
@pytest.mark.parametrize("pulse_us", [LOW, MIDDLE])
def test_pilot_who_switches_back_above_the_pad_breaks_off_and_starts_anew(firmware: str, pulse_us: int) -> None:
    flight = SwitchedLanding(firmware)
    flight.fly_for(3.0)
    flight.pulse_us = HIGH
    flight.fly_until(Phase.DESCEND)
    flight.pulse_us = pulse_us
    assert flight.fly_until(Phase.ABORT, Phase.TOUCHDOWN) is Phase.ABORT
    flight.fly_until(Phase.HOLD)
    flight.pulse_us = HIGH
    flight.fly_until(Phase.WAITING)
