"""The detector over drawn frames: whether it sees the pad, how far off, and whether it says so.

A pose is flipped if its normal is off by more than 20 degrees. NEES is of the position, with 3 degrees of freedom;
camera, mounting and print are exactly known here, so it is that of the edges alone.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from companion.eyes.board import Board, BoardConfig, nested_board
from companion.eyes.mounting import mounting_of
from companion.eyes.sight import SightMemory, SightSystem, sight_step
from link.frames.rotations import matrix_from_quaternion
from scenarios.camera.lens import CAMERA
from scenarios.camera.rendering import Renderer, Vehicle
from scenarios.eyes.draws import DIRT_SHARE, LIGHTS, Drawn, draw_frame, draw_light
from scenarios.simulation.camera_scene import MOUNTING

Array = NDArray[np.float64]

BOARD_M = 1.5
ROOF_M = 1.5
FLIP_RAD = math.radians(20.0)
_FRAMES_A_SCENE = 25  # with the same dirt and paint
_OTHER_IDS = (63, 126, 315)  # of boards that are not looked for


@dataclass(frozen=True, slots=True, kw_only=True)
class Look:
    """What came of a frame; errors None where no pad was seen.

    Attributes:
        light: one of `LIGHTS`.
        range_m: from the camera to the board, as it was drawn.
        angle_rad: of the view off the board's normal, as it was drawn.
        has_board: whether the board was there to be seen.
        error_m: of the pad's middle.
        nees: of its position.
        tilt_rad: between the normals, seen and true.
    """

    light: str
    range_m: float
    angle_rad: float
    has_board: bool
    error_m: float | None = None
    nees: float | None = None
    tilt_rad: float | None = None


def study(frames: int, seed: int, *, has_board: bool, tell: Callable[[int], None]) -> Iterator[Look]:
    """Yield what the detector makes of drawn frames: of its own board, or of none and of others.

    Args:
        frames: how many.
        seed: of everything drawn.
        has_board: the board is there; else there is none in half of the frames, and another one in the rest.
        tell: called with the number of each frame that is done.
    """
    known = {"rotation_std_rad": 0.0, "focal_std_share": 0.0, "board_std_m": 0.0}
    mounting = mounting_of(MOUNTING.model_copy(update=known))
    system = SightSystem(camera=CAMERA, mounting=mounting, board=Board(nested_board(BOARD_M)))
    renderer: Renderer | None = None
    light_name = LIGHTS[0]
    for number in range(frames):
        rng = np.random.default_rng([seed, number, int(has_board)])
        scene, within = divmod(number, _FRAMES_A_SCENE)
        if renderer is None or within == 0:
            light_name = LIGHTS[scene % len(LIGHTS)]
            renderer = _renderer(light_name, _board_of(scene, has_board=has_board), rng)
        drawn = draw_frame(renderer, draw_light(light_name, rng), mounting, ROOF_M, rng)
        yield _look(drawn, system, light_name, has_board=has_board)
        tell(number + 1)


def _board_of(scene: int, *, has_board: bool) -> BoardConfig | None:
    if has_board:
        return nested_board(BOARD_M)
    return None if scene // len(LIGHTS) % 2 == 0 else nested_board(BOARD_M, _OTHER_IDS[scene % len(_OTHER_IDS)])


def _renderer(light_name: str, board: BoardConfig | None, rng: np.random.Generator) -> Renderer:
    paint = float(rng.uniform(0.1, 0.5))
    vehicle = Vehicle(board=board, length_m=4.2, width_m=1.8, roof_height_m=ROOF_M, paint=paint)
    return Renderer(vehicle, DIRT_SHARE if light_name == "dirty" else 0.0, rng)


def _look(drawn: Drawn, system: SightSystem, light_name: str, *, has_board: bool) -> Look:
    _, sight = sight_step(SightMemory(), drawn.frame, system)
    plain = Look(light=light_name, range_m=drawn.range_m, angle_rad=drawn.angle_rad, has_board=has_board)
    if sight.sighting is None:
        return plain
    error = np.array(sight.sighting.position_flu_m) - drawn.away_flu_m
    covariance = np.array(sight.sighting.position_covariance_m2).reshape(3, 3)
    normal = matrix_from_quaternion(sight.sighting.orientation_wxyz)[:, 2]
    return Look(
        light=plain.light,
        range_m=plain.range_m,
        angle_rad=plain.angle_rad,
        has_board=has_board,
        error_m=float(np.linalg.norm(error)),
        nees=float(error @ np.linalg.solve(covariance, error)),
        tilt_rad=math.acos(min(max(float(normal @ drawn.R_BP[:, 2]), -1.0), 1.0)),
    )
