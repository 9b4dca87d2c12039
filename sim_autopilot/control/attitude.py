"""Following an attitude or turn rates with a given thrust, for setpoints and sticks that bypass the outer loop.

`torque = I (-kR eR - kw (w - w_d)) + w x I w` with the tracking error on SO(3) and the gains of `control.geometric`;
of turn rates alone kR is zero.
"""

from link.compiled import kernel
from sim_autopilot.control.parameters import ATTITUDE, HAS_ATTITUDE, RATE, THRUST
from sim_autopilot.core.data import Array
from sim_autopilot.physics.parameters import Record
from sim_autopilot.physics.rotation import fill_matrix


@kernel
def fill_attitude_wrench(
    y: Array, rotation: Array, reference: Array, control: Record, body: Record, wanted: Array, out: Array
) -> None:
    """Write [T, L, M, N] that turns as `reference` (25,) says; `wanted` (9,) is scratch."""
    inertia = body["inertia_kg_m2"]
    fill_matrix(reference[ATTITUDE : ATTITUDE + 4], wanted)
    out[0] = body["mass_kg"] * reference[THRUST]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        error = 0.0
        if reference[HAS_ATTITUDE] > 0.0:
            for row in (0, 3, 6):
                error += 0.5 * (wanted[row + k] * rotation[row + j] - rotation[row + k] * wanted[row + j])
        rate = y[10 + i] - reference[RATE + i]
        gyro = y[10 + j] * y[10 + k] * (inertia[k] - inertia[j])
        out[1 + i] = inertia[i] * (-control["attitude_gain"][i] * error - control["rate_gain"][i] * rate) + gyro
