"""Sightings of the pad beside it: by somebody else, and by a detector that takes something else for the pad."""

import math

import pytest

from companion.config.integrity import ReceiverFrames
from companion.core.reasons import Reason
from companion.situation.phases import Phase
from link.frames.rotations import conjugate, rotate, yaw_of
from link.messages import PadSighting
from link.payloads import cdr
from link.zenoh.keys import Keys
from scenarios.catalogue.catalogue import load_scenario
from scenarios.config import Scenario
from scenarios.faults.flight import FaultFlight
from scenarios.faults.trial import SEED, scenario_of
from scenarios.recordings.result import score_run
from scenarios.scoring.score import Tier

OFF_M = 1.0  # left of the pad's middle: beyond its edge, and within what two base stations may differ by
STD_M = 0.02
CONFUSED_SEED = 12  # the receivers are apart towards where the detector is off, so that they cannot tell
LOW_M = 0.33


def between_two_frames() -> Scenario:
    scenario = scenario_of("px4")
    companion = scenario.system.companion
    integrity = companion.integrity.model_copy(update={"receiver_frames": ReceiverFrames.APART})
    system = scenario.system.model_copy(update={"companion": companion.model_copy(update={"integrity": integrity})})
    return scenario.model_copy(update={"system": system})


def false_sighting(flight: FaultFlight) -> bytes:
    """What a detector would see of a pad that is beside the true one."""
    drone, vehicle = flight.recording.drone[-1], flight.recording.vehicle[-1]
    yaw_rad, height_m = yaw_of(vehicle.orientation_wxyz), flight.simulation.vehicle.pad.height_m
    beside = (-OFF_M * math.sin(yaw_rad), OFF_M * math.cos(yaw_rad), height_m)
    east_m, north_m, up_m = (
        of_vehicle + more - of_drone
        for of_vehicle, more, of_drone in zip(vehicle.position_enu_m, beside, drone.position_enu_m, strict=True)
    )
    return cdr.encode(
        PadSighting(
            t_ns=flight.simulation.t_ns,
            position_flu_m=rotate(conjugate(drone.orientation_wxyz), (east_m, north_m, up_m)),
            orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
            position_covariance_m2=(STD_M**2, 0.0, 0.0, 0.0, STD_M**2, 0.0, 0.0, 0.0, STD_M**2),
        )
    )


@pytest.mark.slow
def test_single_false_sighting_leads_no_drone_beside_the_pad() -> None:
    flight = FaultFlight(between_two_frames(), SEED)
    flight.fly_to(Phase.CHASE)
    flight.fly(0.3)
    flight.companion.receive_sample(Keys().pad_pose, false_sighting(flight))
    while flight.phase is Phase.CHASE:
        flight.step()
    assert flight.phase is Phase.ABORT
    assert flight.recording.statuses[-1].reason_code == Reason.OFFSET_UNKNOWN.name


class Confused(FaultFlight):
    """A landing by receivers half a metre apart, whose detector sees all of the pad beside it from some moment on."""

    def __init__(self) -> None:
        super().__init__(load_scenario("straight_5+sensors=nominal"), CONFUSED_SEED)
        self.is_confused = False
        node, pad_pose = self.companion, Keys().pad_pose
        receive = node.receive_sample

        def misread(key: str, payload: bytes) -> None:
            receive(key, false_sighting(self) if self.is_confused and key == pad_pose else payload)

        node.receive_sample = misread  # type: ignore[method-assign]

    def end(self) -> Tier:
        """Fly to the end, and return what it was on truth."""
        self.is_confused = True
        while self._watch.reason(self.recording) is None:
            self.step()
        return score_run(self.scenario, CONFUSED_SEED, self.recording).tier


@pytest.mark.slow
@pytest.mark.parametrize("phase", [Phase.ALIGN, Phase.DESCEND])
def test_detector_that_takes_something_else_for_the_pad_leads_no_drone_beside_it(phase: Phase) -> None:
    flight = Confused()
    flight.fly_to(phase)
    assert flight.end() is Tier.ABORT
    assert any(status.reason_code == Reason.SIGHTINGS_DISAGREE.name for status in flight.recording.statuses)


@pytest.mark.slow
def test_detector_that_does_so_below_the_commit_height_leads_no_later_approach_beside_the_pad() -> None:
    flight = Confused()
    flight.fly_to(Phase.DESCEND)
    while not flight.is_below(LOW_M):
        flight.step()
    assert flight.end() is not Tier.UNSAFE
