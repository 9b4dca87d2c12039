"""A long-crested sea, and how a deck on a ship moves in it: closed forms of time and of the ship's way.

Model: Bretschneider's (ITTC's two-parameter) spectrum, S(w) = 5/16 H^2 wp^4 / w^5 exp(-5/4 (wp/w)^4), of which
exp(-5/4 (wp/w)^4) is the share of the variance below w. `COMPONENTS` waves of equal variance, one drawn frequency in
each band and a drawn phase, are superposed; a wave's phase at the ship is w t - k s cos(beta) + e, so that what the
ship meets is right at any speed. The hull answers as it does at the cruising speed (`scenarios.tracks.hull`).
Source: Bretschneider 1959; ITTC Recommended Procedures 7.5-02-07-01.1; sea states: STANAG 4194, table for the open
North Atlantic (Bales 1983), in the catalogue.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenarios.tracks.drive_config import VesselTrack
from scenarios.tracks.hull import response
from scenarios.tracks.profiles import Motion
from scenarios.tracks.suspension import Motion as Swing
from sim_autopilot.physics.airframe import GRAVITY_M_S2

COMPONENTS = 60
"""Waves of a sea: their frequencies have no common period within any run."""

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Waves:
    """The waves of a sea, all (n,): angular frequency (rad/s), phase (rad), and the amplitude (m) that all have."""

    omega_rad_s: Array
    phase_rad: Array
    amplitude_m: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Seaway:
    """How a deck moves in a sea.

    Attributes:
        omega_rad_s: (n,) of the waves, against the water.
        along_per_m: (n,) their wave number in the direction of travel, negative where they come from ahead.
        motions: (3, n) complex amplitudes of heave (m) at the deck, pitch and roll (rad), the waves' own phases in it.
    """

    omega_rad_s: Array
    along_per_m: Array
    motions: NDArray[np.complex128]

    def at(self, t_s: float, way: Motion) -> tuple[Swing, Swing, Swing]:
        """Return heave, pitch and roll, each with rate and acceleration, at `t_s` of a ship on its `way`."""
        turning = np.exp(1j * (self.omega_rad_s * t_s - self.along_per_m * way.s_m))
        rate = self.omega_rad_s - self.along_per_m * way.speed_m_s
        change = -self.along_per_m * way.acceleration_m_s2
        factors = np.array([turning, 1j * rate * turning, (1j * change - rate**2) * turning])
        heave, pitch, roll = (self.motions @ factors.T).real.tolist()
        return tuple(heave), tuple(pitch), tuple(roll)


def draw_waves(significant_height_m: float, modal_period_s: float, rng: np.random.Generator) -> Waves:
    """Return the waves of a sea; `rng` decides their frequencies and phases."""
    shares = (np.arange(COMPONENTS) + rng.uniform(0.0, 1.0, COMPONENTS)) / COMPONENTS
    modal_rad_s = 2.0 * math.pi / modal_period_s
    return Waves(
        omega_rad_s=modal_rad_s * (1.25 / -np.log(shares)) ** 0.25,
        phase_rad=rng.uniform(0.0, 2.0 * math.pi, COMPONENTS),
        amplitude_m=0.25 * significant_height_m * math.sqrt(2.0 / COMPONENTS),
    )


def seaway_of(track: VesselTrack, speed_m_s: float, beta_rad: float, rng: np.random.Generator) -> Seaway:
    """Return how the deck of `track` moves at a cruising speed in waves that go at `beta_rad` from the bow's way."""
    waves = draw_waves(track.significant_height_m, track.modal_period_s, rng)
    answers = [response(track.hull, omega, beta_rad, speed_m_s) for omega in waves.omega_rad_s.tolist()]
    heave = np.array([answer.heave - track.deck_forward_m * answer.pitch_rad_m for answer in answers])
    pitch, roll = (np.array(one) for one in zip(*((a.pitch_rad_m, a.roll_rad_m) for a in answers), strict=True))
    return Seaway(
        omega_rad_s=waves.omega_rad_s,
        along_per_m=waves.omega_rad_s**2 / GRAVITY_M_S2 * math.cos(beta_rad),
        motions=np.array([heave, pitch, roll]) * waves.amplitude_m * np.exp(1j * waves.phase_rad),
    )
