"""Tracking on SE(3): the thrust axis and the heading as one rotation (Lee, Leok, McClamroch, CDC 2010, eqs. 10-16).

The outer loop's specific force f gives the wanted attitude R_d, its z along f, its yaw (ZYX) the heading; then
`T = m f . R e3` and `torque = I (-kR eR - kw (w - w_d)) + w x I w`, `eR = (R_d'R - R'R_d)^v / 2`.

The gains are placed poles, not tuned ones. Along a horizontal axis, near hover, position follows from torque through
four integrators and the motors: `p'''' = g torque / I`, the torque lagging by 1 / c. Motors of 0.05 s (20 rad/s) are
overdriven to c = 60 rad/s (`fill_commands`). With the cascade's gains the closed loop is
`s^5 + c s^4 + c kw s^3 + c kR s^2 + c kR kv s + c kR kp`, whose roots sum to -c. Two poles at `PLACE_POLE_RAD_S`
set the response (5.8 / pole: the 2 % settling time of a double pole), the three others share the rest, a factor of four
beyond. Vertically `s^3 + c s^2 + c kv s + c kp`: the same double pole and one at the rest of the sum.
"""

import math

import numpy as np

from link.compiled import kernel
from sim_autopilot.control.outer_loop import approach_speed
from sim_autopilot.control.parameters import HEADING, CascadeGains
from sim_autopilot.core.data import Array
from sim_autopilot.physics.parameters import Record

MOTOR_POLE_RAD_S = 60.0
"""Of the overdriven motors: twelve control periods of 5 ms in its time constant's circle, 2 pi / 60 s."""
PLACE_POLE_RAD_S = 5.2
HEADING_POLE_RAD_S = 4.0
"""The yaw torque of propellers' drag is small: 7 rad/s2 at most, reached by an error of 25 degrees."""


def geometric_gains() -> CascadeGains:
    """Return the gains that put the poles where the module's text says."""
    c = MOTOR_POLE_RAD_S
    place = np.poly([-PLACE_POLE_RAD_S] * 2)
    rest = (c - 2.0 * PLACE_POLE_RAD_S) / 3.0
    _, _, c_kw, c_kr, c_kr_kv, c_kr_kp = np.polymul(place, np.poly([-rest] * 3))
    _, _, c_kv, c_kp = np.polymul(place, [1.0, c - 2.0 * PLACE_POLE_RAD_S])
    kp, kv, kr, kw = c_kr_kp / c_kr, c_kr_kv / c_kr, c_kr / c, c_kw / c
    return CascadeGains(
        position=(kp, kp, c_kp / c),
        velocity=(kv, kv, c_kv / c),
        attitude=(kr, kr, HEADING_POLE_RAD_S**2),
        rate=(kw, kw, 2.0 * HEADING_POLE_RAD_S),
    )


@kernel
def fill_wanted_attitude(force: Array, heading_rad: float, out: Array) -> None:
    """Write R_d (9,) whose z axis is along `force` (3,) and whose yaw (ZYX) is the heading."""
    size = math.sqrt(force[0] ** 2 + force[1] ** 2 + force[2] ** 2)
    zx, zy, zz = force[0] / size, force[1] / size, force[2] / size
    cosine = math.cos(heading_rad)
    sine = math.sin(heading_rad)
    # x = (left of the heading) x z: in the vertical plane of the heading, whatever the tilt
    xx, xy, xz = zz * cosine, zz * sine, -zx * cosine - zy * sine
    level = math.sqrt(xx * xx + xy * xy + xz * xz)
    xx, xy, xz = xx / level, xy / level, xz / level
    out[0], out[1], out[2] = xx, zy * xz - zz * xy, zx
    out[3], out[4], out[5] = xy, zz * xx - zx * xz, zy
    out[6], out[7], out[8] = xz, zx * xy - zy * xx, zz


@kernel
def fill_geometric_wrench(
    y: Array, rotation: Array, force: Array, memory: Array, heading_rate_rad_s: float, control: Record, body: Record,
    wanted: Array, out: Array,
) -> None:  # fmt: skip
    """Write [T, L, M, N] that turns the thrust axis to the specific force `force` (3,); `wanted` (9,) is scratch."""
    inertia = body["inertia_kg_m2"]
    fill_wanted_attitude(force, memory[HEADING], wanted)
    out[0] = body["mass_kg"] * (force[0] * rotation[2] + force[1] * rotation[5] + force[2] * rotation[8])
    wx, wy, wz = y[10], y[11], y[12]
    gyro = (
        wy * wz * (inertia[2] - inertia[1]),
        wz * wx * (inertia[0] - inertia[2]),
        wx * wy * (inertia[1] - inertia[0]),
    )
    for i in range(3):
        # component i of (R_d'R - R'R_d)^v is the entry (k, j) of that matrix, i j k in cyclic order
        j, k = (i + 1) % 3, (i + 2) % 3
        error = 0.0
        for row in (0, 3, 6):
            error += 0.5 * (wanted[row + k] * rotation[row + j] - rotation[row + k] * wanted[row + j])
        out[1 + i] = error
    tilt = math.sqrt(out[1] ** 2 + out[2] ** 2)
    slope = control["attitude_gain"][0] / control["rate_gain"][0]
    braked = 1.0
    if tilt > 0.0:
        braked = approach_speed(tilt, slope, control["tilt_braking_rad_s2"]) / (slope * tilt)
    for i in range(3):
        turn = control["attitude_gain"][i] * out[1 + i] * (braked if i < 2 else 1.0)
        rate = y[10 + i] - heading_rate_rad_s * rotation[6 + i]
        out[1 + i] = inertia[i] * (-turn - control["rate_gain"][i] * rate) + gyro[i]
