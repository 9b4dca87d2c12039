"""How a ship's hull answers waves in heave, pitch and roll, in closed form.

Model: a box of the ship's length, breadth and draught in long-crested waves. Added mass equals the displaced mass, so
heave and pitch share one natural frequency, sqrt(g / 2 T); their damping is that of the sections, after Yamamoto. Roll
is an oscillator of told natural period and damping, excited by what its own damping radiates (Haskind).
Frames: the body's FLU, so pitch is positive with the bow down and roll with port up. The angle `beta` is that between
the ship's heading and where the waves go: pi is head seas.
Source: Jensen, Mansour and Olsen 2004, Estimation of ship motions using closed-form expressions, Ocean Engineering 31,
61-85; roll with one prism and a told damping, as in Fossen's Marine Systems Simulator.
"""

import math
from dataclasses import dataclass

from scenarios.tracks.drive_config import HullConfig
from sim_autopilot.physics.airframe import GRAVITY_M_S2

_WATER_KG_M3 = 1025.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Response:
    """Complex amplitudes for a wave of amplitude 1 m; the motion is the real part of them times `exp(i phase)`.

    The phase is that of the wave's crest amidships, growing with time.
    """

    heave: complex
    pitch_rad_m: complex
    roll_rad_m: complex


def response(hull: HullConfig, omega_rad_s: float, beta_rad: float, speed_m_s: float) -> Response:
    """Return the answer to waves of angular frequency `omega_rad_s` (against the water) at `speed_m_s`.

    Raises:
        ValueError: the ship outruns the waves, where the formulae end.
    """
    k = omega_rad_s**2 / GRAVITY_M_S2
    met_rad_s = omega_rad_s - k * speed_m_s * math.cos(beta_rad)
    if met_rad_s <= 0.0:
        raise ValueError(f"waves of {omega_rad_s:g} rad/s are overtaken at {speed_m_s:g} m/s")
    alpha = met_rad_s / omega_rad_s
    kt, kb = k * hull.draught_m, k * hull.breadth_m
    radiated = 2.0 * math.sin(0.5 * kb * alpha**2) * math.exp(-kt * alpha**2)
    along_per_m = abs(k * math.cos(beta_rad))
    force = math.exp(-along_per_m * hull.draught_m) * math.hypot(1.0 - kt, radiated**2 / (kb * alpha**3))
    sigma = 0.5 * along_per_m * hull.length_m
    lifts, turns = _over_length(sigma)
    follows = 1.0 / complex(1.0 - 2.0 * kt * alpha**2, radiated**2 / (kb * alpha**2))
    slope = -1j  # a sine, a quarter of a period behind the crest
    pitch = -math.copysign(force * turns * 6.0 / hull.length_m, math.cos(beta_rad)) * slope * follows
    return Response(
        heave=force * lifts * follows,
        pitch_rad_m=pitch,
        roll_rad_m=_roll(hull, omega_rad_s, met_rad_s, beta_rad) * slope,
    )


def _over_length(sigma: float) -> tuple[float, float]:
    """Return the mean over the length, and the first moment, of a wave with phase `sigma` from middle to end."""
    if sigma < 1e-3:
        return 1.0, sigma / 3.0
    return math.sin(sigma) / sigma, (math.sin(sigma) / sigma - math.cos(sigma)) / sigma


def _roll(hull: HullConfig, omega_rad_s: float, met_rad_s: float, beta_rad: float) -> complex:
    """Return the roll (rad) for 1 m of amplitude, against the wave's slope across the ship.

    A damping that does not fall with the frequency overstates long waves: they turn a ship by their own slope at most.
    """
    natural_rad_s = 2.0 * math.pi / hull.roll_period_s
    displaced_m3 = hull.block_coefficient * hull.length_m * hull.breadth_m * hull.draught_m
    stiffness_n_m = _WATER_KG_M3 * GRAVITY_M_S2 * displaced_m3 * hull.metacentric_height_m
    damping_n_m_s = 2.0 * hull.roll_damping * stiffness_n_m / natural_rad_s
    moment_n = math.sin(beta_rad) * math.sqrt(damping_n_m_s * _WATER_KG_M3 * GRAVITY_M_S2**2 / met_rad_s)
    ratio = met_rad_s / natural_rad_s
    slope_rad_m = abs(math.sin(beta_rad)) * omega_rad_s**2 / GRAVITY_M_S2
    leans_rad_m = math.copysign(min(abs(moment_n) / stiffness_n_m, slope_rad_m), moment_n)
    return leans_rad_m / complex(1.0 - ratio**2, 2.0 * hull.roll_damping * ratio)
