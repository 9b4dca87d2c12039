"""Thrust gained over a surface, rotor by rotor: `1 / (1 - (R / 4z)^2 / (1 + (V / vi)^2))`.

R is the rotor's radius, z its height above the surface, V the airspeed, vi the induced velocity in hover
`sqrt(T / (2 rho A))`. Source: Cheeseman and Bennett, ARC R&M 3021 (1955). The formula holds from z = R / 2, so below
that the gain stays what it is there (4/3 in hover); above 8 R it is under 0.1 % and left out.
"""

import math

from link.compiled import kernel
from sim_autopilot.core.data import Array
from sim_autopilot.physics.airframe import GRAVITY_M_S2
from sim_autopilot.physics.contact import GROUND_FRAME, localise, over
from sim_autopilot.physics.ground import ground_height_kernel
from sim_autopilot.physics.parameters import Record
from sim_autopilot.physics.rotors import ROTOR_X, ROTOR_Y

AIR_DENSITY_KG_M3 = 1.225
REACH_RADII = 8.0
LOWEST_RADII = 0.5


@kernel
def thrust_gain(height_m: float, rotor_radius_m: float, airspeed_m_s: float, induced_m_s: float) -> float:
    """Return thrust near a surface over thrust far from it, at the same rotor speed."""
    if height_m > REACH_RADII * rotor_radius_m:
        return 1.0
    height = max(height_m, LOWEST_RADII * rotor_radius_m)
    image = (rotor_radius_m / (4.0 * height)) ** 2
    return 1.0 / (1.0 - image / (1.0 + (airspeed_m_s / induced_m_s) ** 2))


@kernel
def induced_velocity(body: Record) -> float:
    """Return vi, m/s, of one of four rotors in hover."""
    disc = math.pi * body["rotor_radius_m"] ** 2
    return math.sqrt(body["mass_kg"] * GRAVITY_M_S2 / 4.0 / (2.0 * AIR_DENSITY_KG_M3 * disc))


@kernel
def fill_gains(
    y: Array, rotation: Array, frame: Array, wind: Array, body: Record, local: Array, point: Array, out: Array
) -> None:
    """Write the gain of each rotor (4,), over the roof or over the ground; `local` (9,), `point` (3,) are scratch."""
    airspeed = math.sqrt((y[7] - wind[0]) ** 2 + (y[8] - wind[1]) ** 2 + (y[9] - wind[2]) ** 2)
    induced = induced_velocity(body)
    point[2] = 0.0
    for i in range(4):
        point[0] = ROTOR_X[i] * body["arm_m"]
        point[1] = ROTOR_Y[i] * body["arm_m"]
        localise(y, rotation, point, frame, local)
        height = local[2] - frame[20]
        if not over(local, frame) or height < 0.0:
            localise(y, rotation, point, GROUND_FRAME, local)
            height = local[2] - ground_height_kernel(y[0], y[1], frame[0], frame[1], frame[23], frame[22])
        out[i] = thrust_gain(height, body["rotor_radius_m"], airspeed, induced)
