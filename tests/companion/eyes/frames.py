"""Frames rendered from truth, and what the detector should say of them."""

from dataclasses import dataclass
from functools import cache
from math import pi

import numpy as np
from numpy.typing import NDArray

from companion.eyes.board import Board, BoardConfig, load_board
from companion.eyes.mounting import MountingConfig, mounting_of
from companion.eyes.picture import WholePicture, whole
from companion.eyes.sight import Frame, SightSystem
from link.frames.rotations import matrix_from_quaternion, quaternion_from_roll_pitch_yaw
from scenarios.camera.lens import CAMERA, SIZE_PX
from scenarios.camera.lighting import Light
from scenarios.camera.planes import View
from scenarios.camera.rendering import Renderer, Vehicle

Array = NDArray[np.float64]

MOUNTING = mounting_of(
    MountingConfig(
        position_flu_m=(0.05, 0.0, -0.03), yaw_rad=0.5 * pi, rotation_std_rad=0.0, focal_std_share=0.0, board_std_m=0.0
    )
)
DAY = Light(daylight_lx=50_000.0, sun_v=np.array([0.3, 0.4, 0.866]))
ROOF_M = 1.5


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A frame with the pad's true place in B and its true attitude R_BP."""

    frame: Frame
    away_flu_m: Array
    R_BP: Array


@cache
def renderer(board: BoardConfig | None) -> Renderer:
    """Return the renderer of a car with `board` on its roof."""
    car = Vehicle(board=board, length_m=4.2, width_m=1.8, roof_height_m=ROOF_M)
    return Renderer(car, 0.0, np.random.default_rng(3))


def system(board: Board | None = None) -> SightSystem:
    """Return the rendered camera, exactly calibrated."""
    return SightSystem(camera=CAMERA, mounting=MOUNTING, board=board or load_board(None))


def case(
    range_m: float,
    *,
    roll_pitch_yaw_rad: tuple[float, float, float] = (0.05, -0.08, 0.7),
    aside_m: tuple[float, float] = (0.0, 0.0),
    board: BoardConfig | None = None,
    light: Light = DAY,
    t_ns: int = 1_000_000_000,
) -> Case:
    """Return a frame whose camera's axis meets the deck `range_m` away and `aside_m` from the pad's middle."""
    q_VB = quaternion_from_roll_pitch_yaw(*roll_pitch_yaw_rad)
    R_VB = matrix_from_quaternion(q_VB)
    R_VC = R_VB @ MOUNTING.R_BC
    camera_m = np.array([*aside_m, ROOF_M]) - range_m * R_VC[:, 2]
    drone_m = camera_m - R_VB @ MOUNTING.position_flu_m
    view = View(R_VC=R_VC, camera_m=camera_m, velocity_m_s=np.zeros(3), turning_c_rad_s=np.zeros(3), drone_m=drone_m)
    shades = renderer(board).render(view, light, whole(SIZE_PX))
    frame = Frame(t_ns=t_ns, picture=WholePicture(shades), orientation_wxyz=q_VB)
    return Case(frame=frame, away_flu_m=R_VB.T @ (np.array([0.0, 0.0, ROOF_M]) - drone_m), R_BP=R_VB.T)
