"""One integration step: classical Runge-Kutta for the body, the exact lag for the rotors, contacts in each stage.

Ground effect and the choice whether anything is near are held over the step; the vehicle moves on within it.
"""

import math

import numpy as np

from link.compiled import kernel
from sim_autopilot.core.data import Array
from sim_autopilot.physics.contact import FRAME_SIZE, add_contact, fill_frame, update_anchors
from sim_autopilot.physics.dynamics import STATE_SIZE, fill_derivative, fill_flight_forces, normalise
from sim_autopilot.physics.ground import ground_height_kernel
from sim_autopilot.physics.ground_effect import fill_gains
from sim_autopilot.physics.parameters import Record
from sim_autopilot.physics.rotation import fill_matrix
from sim_autopilot.physics.rotors import fill_lagged, fill_wrench

TOUCH_M = 0.45
"""A centre of mass farther than this from every surface touches none: the reach of the blades and a step at 100 m/s."""
GROUND_EFFECT_M = 1.4
"""Nor does it feel a surface farther away than this (8 R = 1.02 m below a rotor)."""
FAR, IN_GROUND_EFFECT, IN_TOUCH = 0, 1, 2
Workspace = tuple[Array, Array, Array, Array, Array, Array, Array]


@kernel
def workspace() -> Workspace:
    """Return the arrays that a step writes into: stages, rates, frames, wrenches, rotation, loads, scratch."""
    return (
        np.zeros(STATE_SIZE),
        np.zeros((4, STATE_SIZE)),
        np.zeros((3, FRAME_SIZE)),
        np.zeros((3, 4)),
        np.zeros(9),
        np.zeros((2, 3)),
        np.zeros(24),
    )


@kernel
def height_over_roof(y: Array, deck: Array, elapsed_s: float) -> float:
    """Return the height of the drone's centre over the plane of the roof, m; infinite away from a vehicle."""
    ahead = elapsed_s + deck[17]
    dx = y[0] - deck[0] - deck[7] * ahead
    dy = y[1] - deck[1] - deck[8] * ahead
    dz = y[2] - deck[2] - deck[9] * ahead
    reach = TOUCH_M + math.sqrt(deck[13] ** 2 + deck[14] ** 2 + deck[15] ** 2) + GROUND_EFFECT_M
    if deck[16] <= 0.0 or dx * dx + dy * dy + dz * dz > reach * reach:
        return math.inf
    qw, qx, qy, qz = deck[3], deck[4], deck[5], deck[6]
    up = 2.0 * (qx * qz + qw * qy) * dx + 2.0 * (qy * qz - qw * qx) * dy + (1.0 - 2.0 * (qx * qx + qy * qy)) * dz
    return float(up - deck[15])


@kernel
def nearness(y: Array, deck: Array, elapsed_s: float) -> int:
    """Return whether a surface may touch the drone, only lift it, or is too far for both."""
    ahead = elapsed_s + deck[17]
    vehicle = deck[0] + deck[7] * ahead, deck[1] + deck[8] * ahead
    ground_m = ground_height_kernel(y[0], y[1], vehicle[0], vehicle[1], deck[19], deck[18])
    height = min(y[2] - ground_m, height_over_roof(y, deck, elapsed_s))
    if height < TOUCH_M:
        return IN_TOUCH
    return IN_GROUND_EFFECT if height < GROUND_EFFECT_M else FAR


@kernel
def fill_thrust_wrench(speed: Array, gain: Array, body: Record, thrust: Array, out: Array) -> None:
    """Write [T, L, M, N] of rotor speeds (4,) with their ground effect; `thrust` (4,) is scratch."""
    for i in range(4):
        thrust[i] = body["thrust_coefficient_n_s2"] * speed[i] * speed[i] * gain[i]
    fill_wrench(thrust, body["arm_m"], body["torque_per_thrust_m"], out)


@kernel
def fill_rate(
    y: Array, stage: int, wind: Array, anchors: Array, body: Record, near: int, work: Workspace, out: Array
) -> int:
    """Write dy/dt at `stage` (0 start, 1 middle, 2 end of the step), leave loads in `work`, return what is touched."""
    _, _, frames, wrenches, rotation, loads, scratch = work
    fill_matrix(y[3:7], rotation)
    fill_flight_forces(y, rotation, wrenches[stage], wind, body, loads[0], loads[1])
    surface = 0
    if near == IN_TOUCH:
        surface = add_contact(y, rotation, frames[stage], anchors, body, scratch, loads[0], loads[1])
    fill_derivative(y, loads[0], loads[1], body, out)
    return surface


@kernel
def prepare(
    y: Array, speed: Array, command: Array, deck: Array, wind: Array, body: Record, near: int, elapsed_s: float,
    step_s: float, work: Workspace,
) -> None:  # fmt: skip
    """Fill the frames and the wrenches of the three stages, and bring `speed` (4,) to the end of the step.

    `command` (4,) is rotor speeds, or [T, L, M, N] of an airframe that takes them directly.
    """
    _, _, frames, wrenches, rotation, _, scratch = work
    gain, thrust, later = scratch[12:16], scratch[16:20], scratch[20:24]
    gain[:] = 1.0
    if near != FAR:
        for i in range(3):
            fill_frame(deck, elapsed_s + 0.5 * i * step_s, scratch[0:4], frames[i])
        if body["ground_effect"] == 1:
            fill_matrix(y[3:7], rotation)
            fill_gains(y, rotation, frames[0], wind, body, scratch[0:9], scratch[9:12], gain)
    for i in range(3):
        if body["direct"] == 1:
            wrenches[i] = command
        else:
            fill_lagged(speed, command, 0.5 * i * step_s, body["motor_time_constant_s"], later)
            fill_thrust_wrench(later, gain, body, thrust, wrenches[i])
    if body["direct"] == 0:
        speed[:] = later


@kernel
def runge_kutta(
    y: Array, speed: Array, command: Array, anchors: Array, deck: Array, wind: Array, body: Record, near: int,
    elapsed_s: float, step_s: float, work: Workspace,
) -> int:  # fmt: skip
    """Do what `advance_body` says, knowing how near the surfaces are."""
    stage_state, rates, frames, _, rotation, _, scratch = work
    prepare(y, speed, command, deck, wind, body, near, elapsed_s, step_s, work)
    surface = fill_rate(y, 0, wind, anchors, body, near, work, rates[0])
    for i in range(1, 4):
        part = step_s if i == 3 else 0.5 * step_s
        for j in range(STATE_SIZE):
            stage_state[j] = y[j] + part * rates[i - 1, j]
        surface = max(surface, fill_rate(stage_state, (i + 1) // 2, wind, anchors, body, near, work, rates[i]))
    for j in range(STATE_SIZE):
        y[j] += step_s / 6.0 * (rates[0, j] + 2.0 * rates[1, j] + 2.0 * rates[2, j] + rates[3, j])
    normalise(y)
    if near == IN_TOUCH:
        fill_matrix(y[3:7], rotation)
        update_anchors(y, rotation, frames[2], anchors, body, scratch[0:9])
    return surface


@kernel
def advance_body(
    y: Array, speed: Array, command: Array, anchors: Array, deck: Array, wind: Array, body: Record, solid: bool,
    elapsed_s: float, step_s: float, work: Workspace,
) -> int:  # fmt: skip
    """Advance state (13,), rotor speeds (4,) and anchors (8, 3) in place by one step, and return the surface touched.

    Args:
        y: (13,) state.
        speed: (4,) rotor speeds, rad/s.
        command: (4,) rotor speeds, rad/s, or [T, L, M, N] of an airframe that takes them directly.
        anchors: (8, 3) of the friction.
        deck: (20,) the vehicle at the start of the call.
        wind: (3,) m/s in W.
        body: the airframe's record.
        solid: whether ground and vehicle are there to be touched.
        elapsed_s: since the start of the call.
        step_s: to advance.
        work: of `workspace`.
    """
    near = nearness(y, deck, elapsed_s) if solid else FAR
    if near == FAR:
        # the same call with a constant, which lets the compiler leave everything about surfaces out
        return runge_kutta(y, speed, command, anchors, deck, wind, body, FAR, elapsed_s, step_s, work)
    return runge_kutta(y, speed, command, anchors, deck, wind, body, near, elapsed_s, step_s, work)


@kernel
def fill_specific_force(
    y: Array, wind: Array, anchors: Array, body: Record, near: int, work: Workspace, out: Array
) -> None:
    """Write what an accelerometer feels (3,) in B at the end of the step just made."""
    _, rates, _, _, rotation, loads, _ = work
    fill_rate(y, 2, wind, anchors, body, near, work, rates[0])
    for i in range(3):
        out[i] = (rotation[i] * loads[0, 0] + rotation[3 + i] * loads[0, 1] + rotation[6 + i] * loads[0, 2]) / body[
            "mass_kg"
        ]
