"""Gear and blades against the ground and a moving box: spring and damper along the normal, Coulomb friction across.

Eight points of B touch: four feet and the four outer edges of the rotor discs. A point inside a surface by depth d,
with d' its rate, is pushed out by `max(0, k d + c d')`: contacts never pull. Friction on a top face is a spring and
damper from an anchor on that face, bounded by mu times the normal force; at the bound the anchor is dragged along
(Cundall and Strack 1979), so a drone at rest stays where it is. On a flank friction is viscous below the bound.
Surfaces are frames (24,): origin 0:3, R_WV 3:12, velocity 12:15, angular velocity in W 15:18, half length, half width,
height, presence, lowest road, present road. The ground is such a frame without end (`ground`), but under the vehicle
only the vehicle counts.

With four feet of 2000 N/m the drone sinks 1.8 mm at rest and swings at 73 rad/s; 55 N s/m a foot is critical damping.
"""

import math

import numpy as np

from link.compiled import kernel
from sim_autopilot.core.data import Array, Surface
from sim_autopilot.physics.ground import ground_height_kernel
from sim_autopilot.physics.parameters import Record
from sim_autopilot.physics.rotation import fill_matrix, fill_turned

GEAR_HEIGHT_M = 0.12
"""Of the centre of mass above the feet."""
FOOT_OFFSET_M = 0.15
"""Of each foot from the body's x and y axes: wide enough not to trip over its own friction (mu 0.8 * 0.12 < 0.15)."""
BLADE_REACH_M = 0.215 + 0.127
"""Of the outer edge of a rotor disc from the centre of mass: arm and rotor radius."""
CONTACT_POINTS_FLU_M: Array = np.array(
    [
        [FOOT_OFFSET_M, FOOT_OFFSET_M, -GEAR_HEIGHT_M],
        [FOOT_OFFSET_M, -FOOT_OFFSET_M, -GEAR_HEIGHT_M],
        [-FOOT_OFFSET_M, FOOT_OFFSET_M, -GEAR_HEIGHT_M],
        [-FOOT_OFFSET_M, -FOOT_OFFSET_M, -GEAR_HEIGHT_M],
        [BLADE_REACH_M, 0.0, 0.0],
        [-BLADE_REACH_M, 0.0, 0.0],
        [0.0, BLADE_REACH_M, 0.0],
        [0.0, -BLADE_REACH_M, 0.0],
    ]
)
STIFFNESS_N_M = 2000.0
DAMPING_N_S_M = 55.0
FRICTION_STIFFNESS_N_M = 2000.0
FRICTION_DAMPING_N_S_M = 40.0
EDGE_M = 0.02
"""A point less deep than this under the roof is on it, however near its edge."""

NO_SURFACE = Surface.NONE.value
GROUND = Surface.GROUND.value
DECK = Surface.DECK.value
SIDE = Surface.SIDE.value

DECK_SIZE = 20
"""Position 3, orientation 4, velocity 3, angular velocity 3, half length, half width, height, presence, age, lowest,
road."""
FRAME_SIZE = 24
GROUND_FRAME: Array = np.array(
    [0.0] * 3 + [1.0, 0, 0, 0, 1.0, 0, 0, 0, 1.0] + [0.0] * 6 + [np.inf, np.inf, 0.0, 1.0, 0.0, 0.0]
)


@kernel
def fill_frame(deck: Array, elapsed_s: float, turned: Array, out: Array) -> None:
    """Write the frame (24,) of `deck` (20,) carried on by its velocities for `elapsed_s`; `turned` (4,) is scratch."""
    elapsed_s += deck[17]
    fill_turned(deck[3:7], (deck[10] * elapsed_s, deck[11] * elapsed_s, deck[12] * elapsed_s), turned)
    fill_matrix(turned, out[3:12])
    for i in range(3):
        out[i] = deck[i] + deck[7 + i] * elapsed_s
        out[12 + i] = deck[7 + i]
        out[15 + i] = deck[10 + i]
    for i in range(4):
        out[18 + i] = deck[13 + i]
    out[22] = deck[18]
    out[23] = deck[19]


@kernel
def localise(y: Array, rotation: Array, point: Array, frame: Array, out: Array) -> None:
    """Write into `out` (9,) where a body point is: 0:3 in `frame`, in its axes; 6:9 its arm from B in W."""
    for i in range(3):
        out[6 + i] = rotation[3 * i] * point[0] + rotation[3 * i + 1] * point[1] + rotation[3 * i + 2] * point[2]
    dx = y[0] + out[6] - frame[0]
    dy = y[1] + out[7] - frame[1]
    dz = y[2] + out[8] - frame[2]
    for i in range(3):
        out[i] = frame[3 + i] * dx + frame[6 + i] * dy + frame[9 + i] * dz


@kernel
def add_motion(y: Array, rotation: Array, frame: Array, out: Array) -> None:
    """Write into 3:6 of `out` (9,), as `localise` left it, the point's velocity against `frame`, in its axes."""
    dx = y[0] + out[6] - frame[0]
    dy = y[1] + out[7] - frame[1]
    dz = y[2] + out[8] - frame[2]
    wx = rotation[0] * y[10] + rotation[1] * y[11] + rotation[2] * y[12]
    wy = rotation[3] * y[10] + rotation[4] * y[11] + rotation[5] * y[12]
    wz = rotation[6] * y[10] + rotation[7] * y[11] + rotation[8] * y[12]
    ux = y[7] + wy * out[8] - wz * out[7] - frame[12] - frame[16] * dz + frame[17] * dy
    uy = y[8] + wz * out[6] - wx * out[8] - frame[13] - frame[17] * dx + frame[15] * dz
    uz = y[9] + wx * out[7] - wy * out[6] - frame[14] - frame[15] * dy + frame[16] * dx
    for i in range(3):
        out[3 + i] = frame[3 + i] * ux + frame[6 + i] * uy + frame[9 + i] * uz


@kernel
def over(local: Array, frame: Array) -> bool:
    """Return whether a point (local coordinates first) is over or under a frame's top face."""
    return bool(frame[21] > 0.0 and abs(local[0]) < frame[18] and abs(local[1]) < frame[19])


@kernel
def touched_axis(local: Array, frame: Array) -> int:
    """Return which face's axis pushes a point out of a box: 2 its top, 0 and 1 its flanks, -1 none."""
    depth = frame[20] - local[2]
    if not over(local, frame) or depth <= 0.0:
        return -1
    across_x = frame[18] - abs(local[0])
    across_y = frame[19] - abs(local[1])
    if frame[20] <= 0.0 or depth <= max(EDGE_M, min(across_x, across_y)):
        return 2
    return 0 if across_x < across_y else 1


@kernel
def top_normal_force(local: Array, frame: Array) -> float:
    """Return the force, N, that pushes a point up from a top face."""
    return float(max(0.0, STIFFNESS_N_M * (frame[20] - local[2]) - DAMPING_N_S_M * local[5]))


@kernel
def fill_top_force(local: Array, frame: Array, anchor: Array, surface: int, mu: float, out: Array) -> None:
    """Write the force (3,) of a top face on a point, in the frame's axes."""
    normal = top_normal_force(local, frame)
    held = FRICTION_STIFFNESS_N_M if anchor[2] == surface else 0.0
    fx = -held * (local[0] - anchor[0]) - FRICTION_DAMPING_N_S_M * local[3]
    fy = -held * (local[1] - anchor[1]) - FRICTION_DAMPING_N_S_M * local[4]
    size = math.sqrt(fx * fx + fy * fy)
    scale = 1.0 if size <= mu * normal else mu * normal / size
    out[0] = scale * fx
    out[1] = scale * fy
    out[2] = normal


@kernel
def fill_flank_force(local: Array, frame: Array, axis: int, mu: float, out: Array) -> None:
    """Write the force (3,) of a flank across `axis` on a point, in the frame's axes."""
    sign = 1.0 if local[axis] > 0.0 else -1.0
    other = 1 - axis
    depth = frame[18 + axis] - abs(local[axis])
    normal = max(0.0, STIFFNESS_N_M * depth - DAMPING_N_S_M * sign * local[3 + axis])
    fo = -FRICTION_DAMPING_N_S_M * local[3 + other]
    fz = -FRICTION_DAMPING_N_S_M * local[5]
    size = math.sqrt(fo * fo + fz * fz)
    scale = 1.0 if size <= mu * normal else mu * normal / size
    out[axis] = sign * normal
    out[other] = scale * fo
    out[2] = scale * fz


@kernel
def touched_surface(y: Array, rotation: Array, i: int, frame: Array, local: Array) -> int:
    """Return the code of the surface that point `i` is in, and leave where and how it moves there in `local` (9,)."""
    if frame[21] > 0.0:
        localise(y, rotation, CONTACT_POINTS_FLU_M[i], frame, local)
        if over(local, frame):
            axis = touched_axis(local, frame)
            if axis < 0:
                return NO_SURFACE
            add_motion(y, rotation, frame, local)
            return DECK if axis == 2 else SIDE
    localise(y, rotation, CONTACT_POINTS_FLU_M[i], GROUND_FRAME, local)
    local[2] -= ground_height_kernel(y[0], y[1], frame[0], frame[1], frame[23], frame[22])
    if local[2] >= 0.0:
        return NO_SURFACE
    add_motion(y, rotation, GROUND_FRAME, local)
    return GROUND


@kernel
def add_contact(
    y: Array, rotation: Array, frame: Array, anchors: Array, body: Record, scratch: Array, force: Array, torque: Array
) -> int:
    """Add the contacts' force in W and torque in B to `force` and `torque` (3,), and return the surface's code.

    Args:
        y: (13,) state.
        rotation: (9,) R_WB.
        frame: (24,) the vehicle.
        anchors: (8, 3) friction anchor on its surface, x and y m, and that surface's code.
        body: the airframe's record.
        scratch: (15,) overwritten.
        force: (3,) N.
        torque: (3,) N m.
    """
    local, push, f = scratch[0:9], scratch[9:12], scratch[12:15]
    mu = body["friction_coefficient"]
    touched = NO_SURFACE
    for i in range(CONTACT_POINTS_FLU_M.shape[0]):
        surface = touched_surface(y, rotation, i, frame, local)
        if surface == NO_SURFACE:
            continue
        touched = max(touched, surface)
        axes = GROUND_FRAME if surface == GROUND else frame
        if surface == SIDE:
            fill_flank_force(local, frame, touched_axis(local, frame), mu, push)
        else:
            fill_top_force(local, axes, anchors[i], surface, mu, push)
        for j in range(3):
            f[j] = axes[3 + 3 * j] * push[0] + axes[4 + 3 * j] * push[1] + axes[5 + 3 * j] * push[2]
            force[j] += f[j]
        tx = local[7] * f[2] - local[8] * f[1]
        ty = local[8] * f[0] - local[6] * f[2]
        tz = local[6] * f[1] - local[7] * f[0]
        for j in range(3):
            torque[j] += rotation[j] * tx + rotation[3 + j] * ty + rotation[6 + j] * tz
    return touched


@kernel
def drag_anchor(local: Array, frame: Array, surface: int, mu: float, anchor: Array) -> None:
    """Set a new anchor (3,) where a point came to stand on a top face, or pull it along behind a sliding one."""
    if anchor[2] != surface:
        anchor[0], anchor[1], anchor[2] = local[0], local[1], surface
    dx = local[0] - anchor[0]
    dy = local[1] - anchor[1]
    size = math.sqrt(dx * dx + dy * dy)
    reach = mu * top_normal_force(local, frame) / FRICTION_STIFFNESS_N_M
    if size > reach:
        anchor[0] = local[0] - dx * reach / size
        anchor[1] = local[1] - dy * reach / size


@kernel
def update_anchors(y: Array, rotation: Array, frame: Array, anchors: Array, body: Record, local: Array) -> None:
    """Move the anchors (8, 3) after a step; points in the air or on a flank lose theirs. `local` (9,) is scratch."""
    for i in range(CONTACT_POINTS_FLU_M.shape[0]):
        surface = touched_surface(y, rotation, i, frame, local)
        if surface == DECK:
            drag_anchor(local, frame, DECK, body["friction_coefficient"], anchors[i])
        elif surface == GROUND:
            drag_anchor(local, GROUND_FRAME, GROUND, body["friction_coefficient"], anchors[i])
        else:
            anchors[i, 2] = NO_SURFACE
