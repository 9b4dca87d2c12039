"""A vehicle that is restarted in flight with its other antenna, and tells so: nothing is landed on by the old one.

Its fixes step by the antennas' distance while it is silent, where nothing can tell them from driving.
"""

from types import SimpleNamespace
from typing import Any

import pytest

from companion.core.reasons import Reason
from companion.runtime.pad_watch import PadWatch
from companion.situation.phases import Phase
from link.messages import Command, PadGeometry
from link.payloads import json_messages
from link.records import replace
from link.zenoh.inbox import Inbox, Sample
from link.zenoh.keys import Keys
from scenarios.config import FirmwareName
from scenarios.faults.flight import FaultFlight
from scenarios.faults.injection import inject
from scenarios.faults.matrix import Fault
from scenarios.faults.trial import SEED, scenario_of
from scenarios.recordings.result import score_run
from scenarios.scoring.score import Tier
from scenarios.simulation.sensors import Mounting

WAKE_UP: Any = SimpleNamespace(set=lambda: None)
AHEAD_M = 1.2
"""Of the one antenna is the other."""
GONE_S = 2.0
WITHIN_S = 30.0


class _Answering:
    """A vehicle that describes its pad at once, while its program runs."""

    def __init__(self, pad: PadGeometry) -> None:
        self.pad = pad

    def ask(self, key: str, _payload: bytes, _timeout_s: float) -> Inbox:
        inbox = Inbox(capacity=1, wake_up=WAKE_UP)
        inbox.put(Sample(key, json_messages.encode(self.pad), 0))
        return inbox


class _Flight(FaultFlight):
    """One whose companion asks for the pad as the loop does."""

    def __init__(self, firmware: FirmwareName) -> None:
        super().__init__(scenario_of(firmware), SEED)
        self.answering = _Answering(self.simulation.vehicle.pad)
        self._pad_watch = PadWatch(self.answering, Keys().pad)

    def step(self) -> None:
        super().step()
        alive = self.vehicle_is_alive and not self._way.loses
        self._pad_watch.poll(self.companion, self.recording.elapsed_s, alive=alive, fix_seen=False)

    def restart_vehicle(self, ahead_m: float) -> None:
        """Let the vehicle's program be gone for a while, and come back with an antenna that is farther ahead."""
        self.cut_vehicle(GONE_S)
        x_m, y_m, z_m = self.scenario.vehicle.antenna_flu_m
        roof_m, vehicle = self.scenario.vehicle.roof_height_m, self.simulation.vehicle
        mounting = Mounting(antenna_flu_m=(x_m + ahead_m, y_m, z_m), pad_height_m=roof_m)
        vehicle.set_sensors(self.scenario.sensors, mounting)
        arm_m, left_m, up_m = vehicle.pad.antenna_to_pad_m
        self.answering.pad = replace(vehicle.pad, antenna_to_pad_m=(arm_m - ahead_m, left_m, up_m))

    def fly_until(self, *phases: Phase) -> None:
        """Go on to one of `phases`, or for so long that none is reached any more."""
        end_s = self.recording.elapsed_s + WITHIN_S
        while self.phase not in phases and self.recording.elapsed_s < end_s:
            self.step()


@pytest.mark.slow
@pytest.mark.parametrize("firmware", ["px4", "ardupilot"])
def test_vehicle_that_comes_back_with_another_pad_is_not_landed_on_by_the_old_one(firmware: FirmwareName) -> None:
    flight = _Flight(firmware)
    flight.fly_to(Phase.CHASE)
    flight.restart_vehicle(AHEAD_M)
    flight.fly_until(Phase.HOLD, Phase.SECURED)
    flight.fly(3.0)
    status = flight.recording.statuses[-1]
    assert (status.phase, status.reason_code) == (Phase.HOLD.value, Reason.PAD_CHANGED.name)
    assert score_run(flight.scenario, SEED, flight.recording).tier is Tier.ABORT
    flight.companion.request(Command.START)
    flight.fly(1.0)
    assert flight.recording.statuses[-1].phase == Phase.HOLD.value
    inject(Fault.PILOT, flight)
    flight.fly(2.0)
    assert flight.recording.statuses[-1].phase == Phase.PILOT.value
    assert flight.companion.vehicle.pad == flight.answering.pad
    assert not flight.companion.vehicle.is_pad_doubted


@pytest.mark.slow
def test_vehicle_that_comes_back_with_the_same_pad_is_landed_on() -> None:
    flight = _Flight("px4")
    flight.fly_to(Phase.CHASE)
    flight.restart_vehicle(0.0)
    flight.fly_until(Phase.HOLD, Phase.SECURED)
    assert flight.phase is Phase.SECURED
    assert score_run(flight.scenario, SEED, flight.recording).touchdown is not None
