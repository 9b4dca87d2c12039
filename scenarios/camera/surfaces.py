"""The surfaces that the camera sees, as albedo in V: the vehicle's roof with the board on it, and the road around it.

Albedo: white print 0.8, black print 0.06 (matt toner and paper), paint 0.15 to 0.5, asphalt about 0.12 with a speckle
of its stones; its lane marks 0.5. A level of a pyramid is half as fine as the one below it, each texel the mean of
four.
"""

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from companion.eyes.board import BoardConfig
from companion.eyes.plate import raster_of

Albedo = NDArray[np.float32]
Matrix = NDArray[np.float64]

_WHITE, _BLACK, _MUD, _DROPPING = 0.8, 0.06, 0.12, 0.7
_BOARD_TEXELS = 2400  # along its side: 7 of a cell of the smallest tags
_ROOF_TEXEL_M = 0.01
_ROAD_TEXEL_M, _ROAD_SIZE = 0.02, 2048  # repeated every 41 m
_STONE_STD, _PATCH_STD = 0.25, 0.12  # shares of the mean
_MARK_WIDTH_M, _MARK_LENGTH_M, _MARK_GAP_M, _LANE_M = 0.15, 3.0, 6.0, 3.5


@dataclass(frozen=True, slots=True)
class Surface:
    """A pyramid of textures on a plane of V.

    Attributes:
        levels: albedo, finest first.
        texel_m: of the finest.
        corner_m: forward and left coordinates of the first texel's outer corner; rows go backwards, columns right.
        repeats: the texture goes on for ever.
    """

    levels: tuple[Albedo, ...]
    texel_m: float
    corner_m: tuple[float, float]
    repeats: bool = False

    def from_plane(self, level: int) -> Matrix:
        """Return the matrix (3, 3) from (forward, left, 1) on the plane to column and row of a level."""
        texel_m = self.texel_m * 2.0**level
        forward_m, left_m = self.corner_m
        return np.array(
            [
                [0.0, -1.0 / texel_m, left_m / texel_m - 0.5],
                [-1.0 / texel_m, 0.0, forward_m / texel_m - 0.5],
                [0.0, 0.0, 1.0],
            ]
        )


def _pyramid(finest: Albedo) -> tuple[Albedo, ...]:
    levels = [finest]
    while min(levels[-1].shape) >= 8:
        rows, columns = (size - size % 2 for size in levels[-1].shape)
        even = levels[-1][:rows, :columns]
        levels.append(np.asarray(cv2.resize(even, (columns // 2, rows // 2), interpolation=cv2.INTER_AREA), np.float32))
    return tuple(levels)


@lru_cache(maxsize=4)  # a campaign flies the same few boards again and again
def _printed(board: BoardConfig) -> Albedo:
    return np.asarray(_BLACK + (_WHITE - _BLACK) * raster_of(board, max(board.size_m) / _BOARD_TEXELS), np.float32)


def board_surface(board: BoardConfig, dirt_share: float, rng: np.random.Generator) -> Surface:
    """Return the board, of which mud and droppings cover a share."""
    albedo = _printed(board)
    if dirt_share > 0.0:
        albedo = _soil(albedo, dirt_share, rng)
    length_m, width_m = board.size_m
    return Surface(_pyramid(albedo), max(board.size_m) / _BOARD_TEXELS, (0.5 * length_m, 0.5 * width_m))


def _soil(albedo: Albedo, share: float, rng: np.random.Generator) -> Albedo:
    """Return the surface with splashes: where smooth noise of some centimetres is highest."""
    coarse = rng.standard_normal((60, 60)).astype(np.float32)
    noise = cv2.resize(cv2.GaussianBlur(coarse, (0, 0), 0.8), albedo.shape[::-1], interpolation=cv2.INTER_CUBIC)
    limits = np.quantile(noise, [0.15 * share, 1.0 - 0.85 * share])
    soft = 0.05 * float(noise.std())
    mud = np.clip((noise - limits[1]) / soft, 0.0, 1.0)
    dropping = np.clip((limits[0] - noise) / soft, 0.0, 1.0)
    soiled = albedo + 0.9 * mud * (_MUD - albedo)
    return np.asarray(soiled + 0.9 * dropping * (_DROPPING - soiled), np.float32)


def roof_surface(length_m: float, width_m: float, paint: float) -> Surface:
    """Return a roof of one colour, darker at its edges."""
    rows, columns = (max(round(size / _ROOF_TEXEL_M), 8) for size in (length_m, width_m))
    albedo = np.full((rows, columns), paint, np.float32)
    albedo[:4], albedo[-4:], albedo[:, :4], albedo[:, -4:] = 0.3 * paint, 0.3 * paint, 0.3 * paint, 0.3 * paint
    return Surface(_pyramid(albedo), _ROOF_TEXEL_M, (0.5 * length_m, 0.5 * width_m))


@lru_cache(maxsize=1)  # the same road for all: only what is on the vehicle matters for long
def road_surface() -> Surface:
    """Return asphalt with stones, patches and lane marks along V's x axis, half a lane to either side."""
    rng = np.random.default_rng(20)
    stones = rng.standard_normal((_ROAD_SIZE, _ROAD_SIZE)).astype(np.float32)
    patches = cv2.resize(
        rng.standard_normal((_ROAD_SIZE // 64, _ROAD_SIZE // 64)).astype(np.float32), (_ROAD_SIZE, _ROAD_SIZE)
    )
    albedo = 0.12 * np.clip(1.0 + _STONE_STD * stones + _PATCH_STD * patches, 0.2, 2.0)
    half_m = 0.5 * _ROAD_SIZE * _ROAD_TEXEL_M
    rows_m = half_m - (np.arange(_ROAD_SIZE) + 0.5) * _ROAD_TEXEL_M
    is_dashed = np.mod(rows_m, _MARK_LENGTH_M + _MARK_GAP_M) < _MARK_LENGTH_M
    for side in (-0.5, 0.5):
        columns = np.abs(half_m - (np.arange(_ROAD_SIZE) + 0.5) * _ROAD_TEXEL_M - side * _LANE_M) < 0.5 * _MARK_WIDTH_M
        albedo[np.ix_(is_dashed, columns)] = 0.5
    return Surface(_pyramid(np.asarray(albedo, np.float32)), _ROAD_TEXEL_M, (half_m, half_m), repeats=True)
