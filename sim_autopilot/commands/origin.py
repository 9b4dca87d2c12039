"""The local frame's origin moves: by a message, or by a step of the estimator."""

import numpy as np

from link.frames.geodesy import Datum, geodetic_from_enu
from link.mavlink.dialect import Message
from link.messages import Vector3
from link.records import replace
from sim_autopilot.core.places import local_from_world, world_from_local
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory
from sim_autopilot.telemetry.motion import gps_global_origin


def move_origin(
    memory: AutopilotMemory, datum: Datum, position_enu_m: Vector3, config: AutopilotConfig
) -> tuple[AutopilotMemory, Message]:
    """Return the memory with its origin at `datum`, which is `position_enu_m` in W, and what tells so.

    The last setpoint keeps its local coordinates, as in PX4, so it moves with the frame; what a mode of the autopilot
    itself keeps to stays where it is.
    """
    before = memory.places.origin
    frame = replace(before.frame, origin=datum)
    origin = replace(before, frame=frame, position_enu_m=position_enu_m, resets=before.resets + 1)
    setpoints, reference = memory.heard.setpoints, memory.heard.setpoints.reference
    if reference is not None and reference.position_enu_m is not None:
        x, y, z = reference.position_enu_m.tolist()
        kept = world_from_local(origin, local_from_world(before, (x, y, z)))
        setpoints = replace(setpoints, reference=replace(reference, position_enu_m=np.array(kept)))
    memory = replace(
        memory,
        places=replace(memory.places, origin=origin),
        heard=replace(memory.heard, setpoints=setpoints),
    )
    return memory, gps_global_origin(memory, config)


def step_origin(memory: AutopilotMemory, was_ns: int, config: AutopilotConfig) -> tuple[AutopilotMemory, list[Message]]:
    """Return the memory after the origin's own step, if that lies between `was_ns` since boot and now."""
    step_enu_m, step_ns = config.own_state.origin_step_enu_m, round(config.own_state.origin_step_s * 1e9)
    if step_enu_m is None or not was_ns < step_ns <= memory.now.boot_ns:
        return memory, []
    (x, y, z), (dx, dy, dz) = memory.places.origin.position_enu_m, step_enu_m
    position_enu_m = (x + dx, y + dy, z + dz)
    latitude_rad, longitude_rad, altitude_m = geodetic_from_enu(config.datum, position_enu_m)
    datum = Datum(latitude_rad=latitude_rad, longitude_rad=longitude_rad, altitude_m=altitude_m)
    memory, told = move_origin(memory, datum, position_enu_m, config)
    return memory, [told]
