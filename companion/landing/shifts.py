"""The step's memory after the local frame moved under the drone, or after UTC was set; pure."""

from dataclasses import replace

import numpy as np

from companion.autopilots.driver import AutopilotView, DriverMemory
from companion.core.data import Array
from companion.integrity.contradictions import Contradictions
from companion.integrity.fix_stamps import FixStamps
from companion.landing.step_data import StepMemory
from companion.landing.sway import Sway
from companion.landing.virtual_model import Tracking
from companion.vehicle.surprise import Surprise


def in_present_frame(memory: StepMemory, view: AutopilotView) -> StepMemory:
    """Return the memory in the frame that the autopilot's positions are in now.

    A moved origin or a jump of the drone's own position makes the vehicle's estimate start anew. With a jump, all
    places that the companion flies to move along, so that the drone stays where it is.

    Args:
        memory: in the frame of the last step.
        view: of the autopilot now.
    """
    jumped = view.frame_shift_enu_m != memory.frame_shift_enu_m
    if view.origin_count == memory.origin_count and not jumped:
        return memory
    memory = replace(memory, estimator=None, origin_count=view.origin_count)
    if not jumped:
        return memory
    by_enu_m = np.array(view.frame_shift_enu_m) - np.array(memory.frame_shift_enu_m)
    reference, tracking = memory.reference, memory.tracking
    if reference is not None:
        reference = replace(reference, position_enu_m=reference.position_enu_m + by_enu_m)
    return replace(
        memory,
        frame_shift_enu_m=view.frame_shift_enu_m,
        reference=reference,
        guidance=None,
        tracking=replace(tracking, past=tuple((t_ns, place + by_enu_m) for t_ns, place in tracking.past)),
        waiting_point_enu_m=_moved(memory.waiting_point_enu_m, by_enu_m),
        anchor_enu_m=_moved(memory.anchor_enu_m, by_enu_m),
        ground_enu_m=_moved(memory.ground_enu_m, by_enu_m),
    )


def at_other_time(memory: StepMemory, by_ns: int) -> StepMemory:
    """Return the memory with all its times put off by `by_ns`, for a clock that was set by as much.

    The estimate keeps its times: they are the vehicle's, whose clock is another one, so that what was believed of it
    cannot be checked any more.
    """
    return replace(
        memory,
        phase_since_ns=memory.phase_since_ns + by_ns,
        interrupted_ns=_put_off(memory.interrupted_ns, by_ns),
        waits_since_ns=_put_off(memory.waits_since_ns, by_ns),
        held={name: since_ns + by_ns for name, since_ns in memory.held.items()},
        driver=_driver_at_other_time(memory.driver, by_ns),
        reference_ns=memory.reference_ns + by_ns,
        tracking=_tracking_at_other_time(memory.tracking, by_ns),
        sway=Sway(),
        contradictions=Contradictions(),
        fix_stamps=FixStamps(),
        surprise=_surprise_at_other_time(memory.surprise, by_ns),
    )


def _put_off(t_ns: int | None, by_ns: int) -> int | None:
    return None if t_ns is None else t_ns + by_ns


def _moved(point_enu_m: Array | None, by_enu_m: Array) -> Array | None:
    return None if point_enu_m is None else point_enu_m + by_enu_m


def _driver_at_other_time(memory: DriverMemory, by_ns: int) -> DriverMemory:
    asked = memory.asked_ns
    return replace(
        memory,
        streaming_since_ns=_put_off(memory.streaming_since_ns, by_ns),
        asked_ns=None if asked is None else {command: t_ns + by_ns for command, t_ns in asked.items()},
    )


def _surprise_at_other_time(surprise: Surprise, by_ns: int) -> Surprise:
    driving = replace(surprise.driving, driven=(), changes=())
    return replace(surprise, beliefs=(), driving=driving, surprised_ns=_put_off(surprise.surprised_ns, by_ns))


def _tracking_at_other_time(tracking: Tracking, by_ns: int) -> Tracking:
    return replace(
        tracking,
        past=tuple((t_ns + by_ns, place) for t_ns, place in tracking.past),
        compared_ns=tracking.compared_ns + by_ns if tracking.compared_ns else 0,
    )
