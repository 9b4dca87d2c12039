"""Frames drawn over what a camera on a drone may meet: range, angle, light and motion, with their truth.

Drawn evenly: the logarithm of the range from 0.1 to 20 m, the angle between the line of sight and the deck's normal to
60 degrees, the side that the drone is seen from, its heading, and where in the picture the pad's middle is (near, where
the picture shows less than the board, some other place on it). The deck is tilted by 0.05 rad (standard deviation)
about either axis; the drone moves against it by 0.3 m/s on each axis, as in a descent, and turns by 0.3 rad/s.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from companion.eyes.mounting import Mounting
from companion.eyes.picture import WholePicture, whole
from companion.eyes.sight import Frame
from link.frames.rotations import matrix_from_quaternion, quaternion_from_matrix, quaternion_from_roll_pitch_yaw
from scenarios.camera.lens import CAMERA, SIZE_PX
from scenarios.camera.lighting import Light
from scenarios.camera.planes import View
from scenarios.camera.rendering import Renderer

Array = NDArray[np.float64]

RANGE_M = (0.1, 20.0)
ANGLE_MAX_RAD = math.radians(60.0)
_EDGE_SHARE = 0.8  # of the picture's half sides, within which the pad's middle is
_REACH_M = 0.4  # from the pad's middle, near: where a drone comes down
_DECK_TILT_STD_RAD = 0.05
_SPEED_STD_M_S, _TURNING_STD_RAD_S = 0.3, 0.3


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawn:
    """A frame with its truth.

    Attributes:
        frame: for the detector.
        range_m: from the camera to the place on the deck that it was drawn for.
        angle_rad: between that line and the deck's normal.
        away_flu_m: of the pad's middle from the drone, in B.
        R_BP: of the pad's attitude.
    """

    frame: Frame
    range_m: float
    angle_rad: float
    away_flu_m: Array
    R_BP: Array


def draw_frame(
    renderer: Renderer, light: Light, mounting: Mounting, roof_height_m: float, rng: np.random.Generator
) -> Drawn:
    """Return a drawn frame of a renderer's vehicle."""
    range_m = math.exp(rng.uniform(*np.log(RANGE_M)))
    angle_rad = float(rng.uniform(0.0, ANGLE_MAX_RAD))
    R_VC, camera_m = _draw_camera(range_m, angle_rad, roof_height_m, rng)
    R_VB = R_VC @ mounting.R_BC.T
    tilt_x, tilt_y = (_DECK_TILT_STD_RAD * rng.standard_normal(2)).tolist()
    R_WV = matrix_from_quaternion(quaternion_from_roll_pitch_yaw(tilt_x, tilt_y, 0.0))
    drone_m = camera_m - R_VB @ mounting.position_flu_m
    view = View(
        R_VC=R_VC,
        camera_m=camera_m,
        velocity_m_s=_SPEED_STD_M_S * rng.standard_normal(3),
        turning_c_rad_s=_TURNING_STD_RAD_S * rng.standard_normal(3),
        drone_m=drone_m,
    )
    frame = Frame(
        t_ns=0,
        picture=WholePicture(renderer.render(view, light, whole(SIZE_PX))),
        orientation_wxyz=quaternion_from_matrix(R_WV @ R_VB),
    )
    away = R_VB.T @ (np.array([0.0, 0.0, roof_height_m]) - drone_m)
    return Drawn(frame=frame, range_m=range_m, angle_rad=angle_rad, away_flu_m=away, R_BP=R_VB.T)


def _draw_camera(
    range_m: float, angle_rad: float, roof_height_m: float, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Return R_VC and where the camera is in V."""
    side_rad, roll_rad = rng.uniform(-math.pi, math.pi, 2).tolist()
    towards = np.array(
        [math.sin(angle_rad) * math.cos(side_rad), math.sin(angle_rad) * math.sin(side_rad), math.cos(angle_rad)]
    )
    aside_m = rng.uniform(-_REACH_M, _REACH_M, 2) * min(1.0, 0.5 / range_m)
    target = np.array([*aside_m, roof_height_m])
    half_px = 0.5 * np.array(SIZE_PX)
    pixel = half_px + _EDGE_SHARE * half_px * rng.uniform(-1.0, 1.0, 2)
    ray = np.append(CAMERA.rays(pixel[None, :])[0], 1.0)
    # the camera is turned so that this ray leads to the target, and about it by any angle
    z_v, z_c = -towards, ray / np.linalg.norm(ray)
    return _frame_of(z_v, roll_rad) @ _frame_of(z_c, 0.0).T, target + range_m * towards


def _frame_of(z: Array, roll_rad: float) -> Array:
    """Return a right-handed frame (3, 3) whose third column is `z`, turned about it."""
    other = np.eye(3)[int(np.argmin(np.abs(z)))]
    x = np.cross(other, z)
    x = x / np.linalg.norm(x)
    y = np.cross(z, x)
    cosine, sine = math.cos(roll_rad), math.sin(roll_rad)
    return np.column_stack([cosine * x + sine * y, cosine * y - sine * x, z])


def draw_light(kind: str, rng: np.random.Generator) -> Light:
    """Return the light of one of `LIGHTS`, with the sun at any side."""
    azimuth_rad, up_rad = float(rng.uniform(-math.pi, math.pi)), float(rng.uniform(*_SUN_UP_RAD.get(kind, (0.3, 1.5))))
    level = math.cos(up_rad)
    sun_v = np.array([level * math.cos(azimuth_rad), level * math.sin(azimuth_rad), math.sin(up_rad)])
    if kind == "dusk":
        return Light(daylight_lx=40.0)
    if kind == "dark":
        return Light(daylight_lx=0.1, lamp_lm=1500.0)
    return Light(daylight_lx=50_000.0, sun_v=sun_v, is_glossy=kind == "glare")


LIGHTS = ("day", "dusk", "dark", "glare", "dirty")
"""As the presets of `+camera=`; `dirty` is a day."""
_SUN_UP_RAD = {"day": (0.35, 1.4), "dirty": (0.35, 1.4), "glare": (0.9, 1.5)}
DIRT_SHARE = 0.16
