"""What shines on the surfaces: the day, the sun that a glossy board mirrors, and a lamp beside the camera."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from scenarios.camera.planes import View

Array = NDArray[np.float64]
Floats = NDArray[np.float32]

_LAMP_HALF_ANGLE_RAD = math.radians(45.0)
_GLARE_STD_RAD = 0.12  # of a semi-gloss print: half width of its highlight
_GLARE_PEAK = 4.0  # in units of what white paper throws back


@dataclass(frozen=True, slots=True, kw_only=True)
class Light:
    """What shines: the day, and a lamp beside the camera.

    Attributes:
        daylight_lx: on level ground, of sun and sky together.
        sun_v: unit vector in V towards the sun; None where the sky is overcast or the sun has set.
        lamp_lm: of the lamp.
        is_glossy: the board mirrors the sun.
    """

    daylight_lx: float
    sun_v: Array | None = None
    lamp_lm: float = 0.0
    is_glossy: bool = False


def lamp_lx(light: Light, depth_m: float) -> float:
    """Return what the lamp throws on a surface before the camera."""
    solid_sr = 2.0 * math.pi * (1.0 - math.cos(_LAMP_HALF_ANGLE_RAD))
    return light.lamp_lm / solid_sr / max(depth_m, 0.05) ** 2


def lamp_lit(light: Light, rays: Floats, depth_m: float) -> Floats:
    """Return the lamp's light on a plane across the axis: the cosine to the fourth power, and less off its cone."""
    tangent2 = rays[..., 0] ** 2 + rays[..., 1] ** 2
    falloff = 1.0 / (1.0 + tangent2) ** 2 / (1.0 + (tangent2 / math.tan(_LAMP_HALF_ANGLE_RAD) ** 2) ** 2)
    return np.asarray(lamp_lx(light, depth_m) * falloff, np.float32)


def glare(sun_v: Array, daylight_lx: float, view: View, rays: Floats) -> Floats:
    """Return the highlight where level surfaces mirror the sun into the camera, and the veil it lays over all."""
    mirrored_c = view.R_VC.T @ (np.array([sun_v[0], sun_v[1], -sun_v[2]]))
    cosine = (rays @ mirrored_c[:2].astype(np.float32) + np.float32(mirrored_c[2])) / np.sqrt(
        1.0 + rays[..., 0] ** 2 + rays[..., 1] ** 2
    )
    angle2 = 2.0 * (1.0 - np.clip(cosine, -1.0, 1.0))
    return np.asarray(0.8 * daylight_lx * (_GLARE_PEAK * np.exp(-0.5 * angle2 / _GLARE_STD_RAD**2) + 0.05), np.float32)
