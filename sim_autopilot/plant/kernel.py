"""The drone and its flight controller over one autopilot period, as one compiled call."""

from pathlib import Path

from link.compiled import kept_kernel, source_digest
from sim_autopilot.control.command import fill_control, fill_motor_command
from sim_autopilot.control.outer_loop import extrapolate
from sim_autopilot.control.parameters import RUNNING
from sim_autopilot.core.data import Array
from sim_autopilot.physics.parameters import Record
from sim_autopilot.physics.rotation import fill_matrix
from sim_autopilot.physics.step import FAR, advance_body, fill_specific_force, nearness, workspace

BODY_END = 13
SPEED_END = 17
FORCE_END = 20
SURFACE = 20
MEMORY_START = 21
MEMORY_END = 38
PLANT_SIZE = 62
"""Plant vector: state 13, rotor speeds 4, specific force 3, surface 1, controller memory 17, friction anchors 8 x 3."""


@kept_kernel(source_digest(Path(__file__).parents[1] / folder for folder in ("physics", "control")))
def advance(
    plant: Array, flying: bool, reference: Array, own_error: Array, deck: Array, wind: Array,
    control_record: Record, body_record: Record, periods: int, steps: int,
) -> None:  # fmt: skip
    """Advance the plant vector (62,) in place.

    Args:
        plant: (62,) changed.
        flying: whether the motors run; `reference` counts only then.
        reference: (25,) at the start of the call.
        own_error: (6,) of the position and velocity in W that the controller believes in.
        deck: (20,) the vehicle at the start of the call.
        wind: (3,) m/s in W.
        control_record: (1,) the controller's.
        body_record: (1,) the airframe's.
        periods: of the controller.
        steps: of the physics in each of them.
    """
    control = control_record[0]
    body = body_record[0]
    y, speed, memory = plant[0:BODY_END], plant[BODY_END:SPEED_END], plant[MEMORY_START:MEMORY_END]
    anchors = plant[MEMORY_END:].reshape(8, 3)
    work = workspace()
    rotation, scratch = work[4], work[6]
    wrench, command = work[3][0], work[3][1].copy()
    target, believed = reference.copy(), y.copy()
    step_s = control["period_s"] / steps
    touched = plant[SURFACE]
    plant[SURFACE] = 0.0
    solid = body["solid"] == 1 or not flying
    if not flying:
        memory[RUNNING] = 0.0
        command[:] = 0.0
    for period in range(periods):
        start_s = period * control["period_s"]
        if flying:
            fill_matrix(y[3:7], rotation)
            extrapolate(reference, start_s, target)
            believed[:] = y
            believed[0:3] += own_error[0:3]
            believed[7:10] += own_error[3:6]
            fill_control(believed, rotation, speed, memory, target, touched > 0.0, control, body, scratch, wrench)
            fill_motor_command(wrench, speed, control, body, scratch[0:4], command)
        elif body["direct"] == 1:
            speed[:] = 0.0
        touched = 0.0
        for step in range(steps):
            elapsed_s = start_s + step * step_s
            touched = max(
                touched, advance_body(y, speed, command, anchors, deck, wind, body, solid, elapsed_s, step_s, work)
            )
        plant[SURFACE] = max(plant[SURFACE], touched)
    near = nearness(y, deck, periods * control["period_s"]) if solid else FAR
    fill_specific_force(y, wind, anchors, body, near, work, plant[SPEED_END:FORCE_END])
