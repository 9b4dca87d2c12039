"""How a vehicle's body moves on its wheels along a drive.

Model: heave z (m), pitch and roll (rad), each a damped oscillator, x'' + 2 d w x' + w^2 x = f. The road under the four
wheels drives all three from below, f = w^2 r + 2 d w r', with r the wheels' mean height, their slope along and their
slope across. Braking makes the body dive, f = w^2 c a, and a turn makes it lean outwards. The wheels follow the road
and do not steer about the body's middle; unsprung masses and tyres are left out, being faster than what the pad does.
Source: Gillespie, Fundamentals of Vehicle Dynamics (1992), chapters 5 and 6; Kiencke and Nielsen (2005), chapter 8.
The road's roughness is a sum of plane waves z = A sin(k (x + q y) + p) over the road's surface, whose mean and slopes
over four wheels are closed forms.

Each oscillator is advanced on a grid, exact for a force that is constant over a step: with the complex pole p,
y' = p y + f, x = Im(y) / w_d, x' = Im(p y) / w_d. Between the grid's times a cubic meets both values and rates, so the
motion is a pure function of time whose rate is its derivative.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenarios.tracks.drive_config import SuspensionConfig

Array = NDArray[np.float64]
STEP_S = 0.01
"""Of the grid: a tenth of the period of 1 m long waves at 10 m/s, which a wheelbase averages out."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Surface:
    """What the road's surface has beside its grade.

    Attributes:
        waves: amplitude (m), wavelength along the road (m), its ratio to that across, phase (rad) of each.
        humps: place of the middle (m), length (m), height (m) of each.
    """

    waves: Sequence[tuple[float, float, float, float]]
    humps: Sequence[tuple[float, float, float]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Driven:
    """A drive at times that are `STEP_S` apart, all (n,): place, speed, and acceleration along and to the left."""

    s_m: Array
    speed_m_s: Array
    along_m_s2: Array
    left_m_s2: Array


Motion = tuple[float, float, float]
"""A value, its rate and its acceleration."""
_AT_REST: Motion = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Sway:
    """The body's heave (m), pitch and roll (rad) from departure on, on a grid; at rest before it and behind its end."""

    heave: tuple[list[float], list[float]]
    pitch: tuple[list[float], list[float]]
    roll: tuple[list[float], list[float]]

    def at(self, t_s: float) -> tuple[Motion, Motion, Motion]:
        """Return heave, pitch and roll `t_s` seconds after departure."""
        if t_s <= 0.0:
            return _AT_REST, _AT_REST, _AT_REST
        i = int(t_s / STEP_S)
        if i + 1 >= len(self.heave[0]):
            return tuple((values[-1], 0.0, 0.0) for values, _ in (self.heave, self.pitch, self.roll))  # type: ignore[return-value]  # three of them
        part_s = t_s - i * STEP_S
        return _between(*self.heave, i, part_s), _between(*self.pitch, i, part_s), _between(*self.roll, i, part_s)


def _between(values: list[float], rates: list[float], i: int, part_s: float) -> Motion:
    """Return the cubic between grid points `i` and `i + 1` that meets their values and rates."""
    x0, x1, v0, v1 = values[i], values[i + 1], rates[i], rates[i + 1]
    mean = (x1 - x0) / STEP_S
    bend = (3.0 * mean - 2.0 * v0 - v1) / STEP_S
    twist = (v0 + v1 - 2.0 * mean) / STEP_S**2
    return (
        x0 + (v0 + (bend + twist * part_s) * part_s) * part_s,
        v0 + (2.0 * bend + 3.0 * twist * part_s) * part_s,
        2.0 * bend + 6.0 * twist * part_s,
    )


def sway_of(driven: Driven, surface: Surface, suspension: SuspensionConfig) -> Sway:
    """Return how the body moves; `driven` is given in the middle of each step of the grid."""
    c = suspension
    heave, slope, tilt = _road(driven, surface, c)
    dive, lean = -c.dive_rad_s2_m * driven.along_m_s2, c.lean_rad_s2_m * driven.left_m_s2
    return Sway(
        heave=_oscillate(c.heave_hz, c.damping, *heave, 0.0 * dive),
        pitch=_oscillate(c.pitch_hz, c.damping, -slope[0], -slope[1], dive),
        roll=_oscillate(c.roll_hz, c.damping, *tilt, lean),
    )


def dive_after(since_s: float, deceleration_m_s2: float, lasts_s: float, suspension: SuspensionConfig) -> Motion:
    """Return the pitch by which a body dives `since_s` after a brake began that lasts so long."""
    begun = _pushed(since_s, suspension.dive_rad_s2_m * deceleration_m_s2, suspension)
    ended = _pushed(since_s - lasts_s, -suspension.dive_rad_s2_m * deceleration_m_s2, suspension)
    return begun[0] + ended[0], begun[1] + ended[1], begun[2] + ended[2]


def _pushed(since_s: float, to_rad: float, suspension: SuspensionConfig) -> Motion:
    """Return how a body that was at rest pitches `since_s` after it began to be pushed to an angle."""
    if since_s <= 0.0:
        return _AT_REST
    w, d = 2.0 * math.pi * suspension.pitch_hz, suspension.damping
    damped, fade = w * math.sqrt(1.0 - d**2), math.exp(-d * w * since_s)
    sine, cosine = math.sin(damped * since_s), math.cos(damped * since_s)
    angle = to_rad * (1.0 - fade * (cosine + d * w / damped * sine))
    rate = to_rad * w**2 / damped * fade * sine
    return angle, rate, w**2 * (to_rad - angle) - 2.0 * d * w * rate


def _oscillate(
    frequency_hz: float, damping: float, base: Array, base_rate: Array, pushed: Array
) -> tuple[list[float], list[float]]:
    """Return values and rates on the grid of an oscillator on a moving `base` that is also `pushed` to a value."""
    from scipy.signal import lfilter  # noqa: PLC0415 (0.5 s, and only a road that shakes needs it)

    w = 2.0 * math.pi * frequency_hz
    damped = w * math.sqrt(1.0 - damping**2)
    pole = complex(-damping * w, damped)
    decay = np.exp(pole * STEP_S)
    force = w**2 * (base + pushed) + 2.0 * damping * w * base_rate
    response = np.append(0.0, lfilter([(decay - 1.0) / pole], [1.0, -decay], force))
    return (response.imag / damped).tolist(), ((pole * response).imag / damped).tolist()


def _road(driven: Driven, surface: Surface, c: SuspensionConfig) -> tuple[tuple[Array, Array], ...]:
    """Return the wheels' mean height (m), slope along and slope across, each with its rate in time."""
    sums = np.zeros((3, 2, len(driven.s_m)))
    for amplitude_m, wavelength_m, across, phase_rad in surface.waves:
        k = 2.0 * math.pi / wavelength_m
        ahead, aside = 0.5 * k * c.wheelbase_m, 0.5 * k * across * c.track_m
        sine, cosine = np.sin(k * driven.s_m + phase_rad), np.cos(k * driven.s_m + phase_rad)
        up = amplitude_m * math.cos(ahead) * math.cos(aside)
        along = amplitude_m * math.sin(ahead) * math.cos(aside) * 2.0 / c.wheelbase_m
        left = amplitude_m * math.cos(ahead) * math.sin(aside) * 2.0 / c.track_m
        sums[0] += up * np.array([sine, k * driven.speed_m_s * cosine])
        sums[1] += along * np.array([cosine, -k * driven.speed_m_s * sine])
        sums[2] += left * np.array([cosine, -k * driven.speed_m_s * sine])
    front, rear = (_humps(driven, surface.humps, side * 0.5 * c.wheelbase_m) for side in (1.0, -1.0))
    sums[0] += 0.5 * (front + rear)
    sums[1] += (front - rear) / c.wheelbase_m
    # Against where it stands: there the body is at rest.
    return tuple((value - value[0], rate) for value, rate in sums)


def _humps(driven: Driven, humps: Sequence[tuple[float, float, float]], ahead_m: float) -> Array:
    """Return height (m) and its rate in time (2, n) of an axle `ahead_m` of the middle; a hump is a raised cosine."""
    out = np.zeros((2, len(driven.s_m)))
    for place_m, length_m, height_m in humps:
        angle = 2.0 * math.pi * (driven.s_m + ahead_m - place_m) / length_m
        on = np.abs(angle) < math.pi
        out[0] += np.where(on, 0.5 * height_m * (1.0 + np.cos(angle)), 0.0)
        out[1] += np.where(on, -height_m * math.pi / length_m * np.sin(angle) * driven.speed_m_s, 0.0)
    return out
