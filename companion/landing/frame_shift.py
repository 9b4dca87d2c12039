"""The step's memory after the local frame moved under the drone; pure."""

import numpy as np

from companion.autopilots.driver import AutopilotView
from companion.core.data import Array
from companion.landing.memory import ModelMemory, StepMemory
from link.records import replace


def to_present_frame(memory: StepMemory, view: AutopilotView) -> StepMemory:
    """Return the memory in the frame that the autopilot's positions are in now.

    A moved origin or a jump of the drone's own position makes the vehicle's estimate start anew. With a jump, all
    places that the companion flies to move along, so that the drone stays where it is.

    Args:
        memory: in the frame of the last step.
        view: of the autopilot now.
    """
    places = memory.places
    if view.frame_moves == places.frame_moves:
        return memory
    shift_enu_m, before_enu_m = view.frame_moves.shift_enu_m, places.frame_moves.shift_enu_m
    vehicle, places = replace(memory.vehicle, estimator=None), replace(places, frame_moves=view.frame_moves)
    if shift_enu_m == before_enu_m:
        return replace(memory, vehicle=vehicle, places=places)
    by_enu_m = np.array(shift_enu_m) - np.array(before_enu_m)
    places = replace(
        places,
        waiting_point_enu_m=_moved(places.waiting_point_enu_m, by_enu_m),
        anchor_enu_m=_moved(places.anchor_enu_m, by_enu_m),
        ground_enu_m=_moved(places.ground_enu_m, by_enu_m),
    )
    return replace(memory, vehicle=vehicle, places=places, model=_moved_model(memory.model, by_enu_m))


def _moved_model(model: ModelMemory, by_enu_m: Array) -> ModelMemory:
    reference, tracking = model.reference, model.tracking
    if reference is not None:
        reference = replace(reference, position_enu_m=reference.position_enu_m + by_enu_m)
    past = tuple((t_ns, place + by_enu_m, velocity) for t_ns, place, velocity in tracking.past)
    return replace(model, reference=reference, guidance=None, tracking=replace(tracking, past=past))


def _moved(point_enu_m: Array | None, by_enu_m: Array) -> Array | None:
    return None if point_enu_m is None else point_enu_m + by_enu_m
