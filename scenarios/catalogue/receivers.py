"""What whoever flies a scenario knows of its receivers, and tells the companion."""

from companion.config.integrity import ReceiverFrames
from scenarios.config import Scenario


def tell_of_one_frame(scenario: Scenario) -> Scenario:
    """Return `scenario` with a companion that knows of receivers with one source of corrections, if they have one.

    What the file says of `receiver_frames` stays.
    """
    system = scenario.system
    integrity = system.companion.integrity
    if scenario.sensors.frame_offset_m > 0.0 or "receiver_frames" in integrity.model_fields_set:
        return scenario
    integrity = integrity.model_copy(update={"receiver_frames": ReceiverFrames.ONE})
    companion = system.companion.model_copy(update={"integrity": integrity})
    return scenario.model_copy(update={"system": system.model_copy(update={"companion": companion})})
