"""What a vehicle drives: the road, the speed along it, its roughness and what the vehicle reacts to."""

import math
from dataclasses import dataclass

from scenarios.tracks.drive_config import SuspensionConfig
from scenarios.tracks.profiles import Profile
from scenarios.tracks.roads import Road
from scenarios.tracks.seaway import Seaway
from scenarios.tracks.suspension import Sway


@dataclass(frozen=True, slots=True, kw_only=True)
class Wave:
    """A sine along the road."""

    amplitude: float
    wavelength_m: float
    phase_rad: float

    def at(self, s_m: float) -> tuple[float, float, float]:
        """Return the value at `s_m` and its first two derivatives by arc length."""
        number_per_m = 2.0 * math.pi / self.wavelength_m
        angle_rad = number_per_m * s_m + self.phase_rad
        value = self.amplitude * math.sin(angle_rad)
        return value, number_per_m * self.amplitude * math.cos(angle_rad), -(number_per_m**2) * value


@dataclass(frozen=True, slots=True, kw_only=True)
class Roughness:
    """How the body heaves (m), rolls and pitches (rad) along the road."""

    heave: Wave
    roll: Wave
    pitch: Wave


@dataclass(frozen=True, slots=True, kw_only=True)
class BrakeEvent:
    """Braking to a stop when the drone is `height_above_roof_m` or less above the roof.

    The body dives by it on `suspension`, if it has one.
    """

    deceleration_m_s2: float
    height_above_roof_m: float
    suspension: SuspensionConfig | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Course:
    """What a vehicle drives; `brake`, `roughness`, `sway` and `seaway` are None where the track has none.

    At each of `cusps_m` along the road it stops and drives on the other way round: with its rear ahead, or its front.
    """

    road: Road
    profile: Profile
    roughness: Roughness | None = None
    brake: BrakeEvent | None = None
    sway: Sway | None = None
    seaway: Seaway | None = None
    cusps_m: tuple[float, ...] = ()
