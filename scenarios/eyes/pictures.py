"""What the detector sees on the way down, with the detection drawn in, for the manual."""

import math
from pathlib import Path

import cv2
import numpy as np

from companion.eyes.annotation import annotate, drawing_of
from companion.eyes.board import Board, nested_board
from companion.eyes.mounting import mounting_of
from companion.eyes.picture import whole
from companion.eyes.sight import Frame, SightMemory, SightSystem, sight_step
from link.errors import UserError
from link.frames.rotations import matrix_from_quaternion, quaternion_from_roll_pitch_yaw
from scenarios.camera.lens import CAMERA, SIZE_PX
from scenarios.camera.lighting import Light
from scenarios.camera.planes import View
from scenarios.camera.rendering import Renderer, Vehicle
from scenarios.eyes.study import BOARD_M, ROOF_M
from scenarios.simulation.camera_scene import MOUNTING, RenderedPicture

_HEIGHTS_M = (8.0, 2.0, 0.2)
_ATTITUDE_RAD = (0.05, -0.1, 0.5)  # roll, pitch and yaw against the vehicle
_ASIDE_M = (-0.12, 0.08)
_WIDTH_PX = 640  # of the pictures: the manual needs no more


def write_pictures(folder: Path, seed: int) -> None:
    """Write `eyes_8m.jpg` and so on: by day, from three heights of the camera above the board.

    Raises:
        UserError: the folder cannot be written.
    """
    board = nested_board(BOARD_M)
    vehicle = Vehicle(board=board, length_m=4.2, width_m=1.8, roof_height_m=ROOF_M)
    renderer = Renderer(vehicle, 0.0, np.random.default_rng(seed))
    system = SightSystem(camera=CAMERA, mounting=mounting_of(MOUNTING), board=Board(board))
    light = Light(daylight_lx=50_000.0, sun_v=np.array([0.5, 0.3, math.sqrt(0.66)]))
    q_VB = quaternion_from_roll_pitch_yaw(*_ATTITUDE_RAD)
    for height_m in _HEIGHTS_M:
        picture = RenderedPicture(renderer, _view(height_m, system, q_VB), light, may_show_pad=True)
        shades = picture.part(whole(SIZE_PX)).shades
        _, sight = sight_step(SightMemory(), Frame(t_ns=0, picture=picture, orientation_wxyz=q_VB), system)
        drawn = annotate(shades, drawing_of(sight, system))
        small = cv2.resize(drawn, (_WIDTH_PX, _WIDTH_PX * SIZE_PX[1] // SIZE_PX[0]), interpolation=cv2.INTER_AREA)
        path = folder / f"eyes_{height_m:g}m.jpg"
        if not folder.is_dir() or not cv2.imwrite(str(path), small):
            raise UserError(f"{path}: cannot be written; choose another --examples")


def _view(height_m: float, system: SightSystem, q_VB: tuple[float, float, float, float]) -> View:
    R_VB = matrix_from_quaternion(q_VB)
    R_VC = R_VB @ system.mounting.R_BC
    axis = R_VC[:, 2]
    camera_m = np.array([*_ASIDE_M, ROOF_M]) - height_m / abs(axis[2]) * axis
    return View(
        R_VC=R_VC,
        camera_m=camera_m,
        velocity_m_s=np.array([0.1, 0.05, -0.3]),
        turning_c_rad_s=np.array([0.05, -0.1, 0.05]),
        drone_m=camera_m - R_VB @ system.mounting.position_flu_m,
    )
