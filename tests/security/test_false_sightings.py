"""Somebody else who publishes a sighting of the pad where only sightings place it."""

import math

import pytest

from companion.config.integrity import ReceiverFrames
from companion.core.reasons import Reason
from companion.situation.phases import Phase
from link.frames.rotations import conjugate, rotate, yaw_of
from link.messages import PadSighting
from link.payloads import cdr
from link.zenoh.keys import Keys
from scenarios.config import Scenario
from scenarios.faults.flight import FaultFlight
from scenarios.faults.trial import SEED, scenario_of

OFF_M = 1.0  # left of the pad's middle: beyond its edge, and within what two base stations may differ by
STD_M = 0.02


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
