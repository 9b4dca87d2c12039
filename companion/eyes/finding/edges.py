"""Where in the picture the edges of tags are, found along short lines across where they are expected.

Model: a tag's black square is seen with its edges at the projection of its sides; shades rise outwards. Along the
normal of each edge the shades are sampled, and the edge is where they rise most, to a fraction of a sample by a
parabola.
Source: the RAPiD tracker (Harris 1990), with known places in 3-D and one distance for each point.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from companion.eyes.camera import Camera, matrix_of
from companion.eyes.picture import Part

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

_POINTS_MAX = 12  # along an edge
_POINT_SPACING_PX = 3.0  # at least: what one pixel's noise moves is one point
_HALF_SAMPLES = 7  # to either side of the expected edge
_END_SHARE = 0.06  # of an edge at either end, where the corner rounds it off
_BASE = 2  # samples to either side over which the shades' rise is taken
_RISE_MIN = 5.0  # shades; less is noise
_RISE_SHARE_MIN = 0.15  # of what most edges rise by: in a shadow a quarter of the light is left


class EdgePoints(NamedTuple):
    """Points on the edges of tags.

    Attributes:
        places_m: (N, 3) in P.
        alongs_m: (N, 3) unit vectors in P, along the edge.
        outwards_m: (N, 3) unit vectors in P, from the tag outwards.
        reach_m: (N,) how far across the edge may be looked for: no farther than the next change of colour.
        edges: (N,) of which edge each is, numbered.
    """

    places_m: Array
    alongs_m: Array
    outwards_m: Array
    reach_m: Array
    edges: NDArray[np.int64]

    def only(self, kept: Flags) -> "EdgePoints":
        """Return those of which `kept` (N,) is true."""
        return EdgePoints(
            self.places_m[kept], self.alongs_m[kept], self.outwards_m[kept], self.reach_m[kept], self.edges[kept]
        )


def edge_points(corners_m: list[Array], sides_px: list[float], cells: int) -> EdgePoints:
    """Return the points of some tags: corners (4, 3) in P, and how many pixels their sides are long about."""
    places, alongs, outwards, reaches = [], [], [], []
    edges: list[NDArray[np.int64]] = []
    for corners, side_px in zip(corners_m, sides_px, strict=True):
        count = int(np.clip(side_px / _POINT_SPACING_PX, 3, _POINTS_MAX))
        shares = np.linspace(_END_SHARE, 1.0 - _END_SHARE, count)[:, None]
        center, side_m = corners.mean(axis=0), float(np.linalg.norm(corners[1] - corners[0]))
        for begin, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            places.append(begin + shares * (end - begin))
            alongs.append(np.tile((end - begin) / np.linalg.norm(end - begin), (count, 1)))
            outward = 0.5 * (begin + end) - center
            outwards.append(np.tile(outward / np.linalg.norm(outward), (count, 1)))
            reaches.append(np.full(count, side_m / cells))
            edges.append(np.full(count, len(edges)))
    return EdgePoints(
        np.concatenate(places),
        np.concatenate(alongs),
        np.concatenate(outwards),
        np.concatenate(reaches),
        np.concatenate(edges),
    )


def _normals(points: EdgePoints, moves: Array) -> tuple[Array, Array]:
    """Return the edges' normals in the picture (N, 2), outwards, and how far across they may be looked for (N,).

    What is at a right angle on the board is not in a picture from aside: along its outward direction an edge that moves
    along itself would seem to come nearer.

    Args:
        points: on the edges.
        moves: (N, 2, 3) how pixels move with places in P.
    """
    tangents = np.einsum("nij,nj->ni", moves, points.alongs_m)
    normals = np.column_stack([-tangents[:, 1], tangents[:, 0]])
    normals /= np.maximum(np.hypot(normals[:, 0], normals[:, 1]), 1e-9)[:, None]
    outwards = np.einsum("nij,nj->ni", moves, points.outwards_m * points.reach_m[:, None])
    reach_px = np.sum(normals * outwards, axis=1)
    return normals * np.sign(reach_px)[:, None], np.abs(reach_px)


class Crossings(NamedTuple):
    """Where the edges are.

    Attributes:
        distance_px: (N,) from the expected place outwards.
        slopes: (N, 6) how the expected place moves outwards with the pose: rotation vector, then translation.
        is_seen: (N,) whether an edge was found there.
    """

    distance_px: Array
    slopes: Array
    is_seen: Flags


def find_crossings(
    part: Part, camera: Camera, points: EdgePoints, pose: tuple[Array, Array], reach_max_px: float
) -> Crossings:
    """Return where the edges are.

    Args:
        part: of the picture.
        camera: that took it.
        points: on the edges.
        pose: rotation vector and translation of P in C, about.
        reach_max_px: how far to look, where the points' own reach allows it.
    """
    pixels, slopes = camera.pixels(points.places_m, *pose)
    normals, reach_px = _normals(points, slopes[:, :, 3:] @ matrix_of(pose[0]))
    step_px = np.minimum(0.9 * reach_px, reach_max_px) / _HALF_SAMPLES
    offsets = np.arange(-_HALF_SAMPLES, _HALF_SAMPLES + 1) * step_px[:, None]
    at = pixels[:, None, :] + offsets[:, :, None] * normals[:, None, :]
    inside = part.holds(at[:, [0, -1]]).all(axis=1)
    profiles = part.sample(at)
    rise = profiles[:, 2 * _BASE :] - profiles[:, : -2 * _BASE]
    peak = np.argmax(rise, axis=1)
    index = np.arange(len(rise))
    at_peak = rise[index, peak]
    within = (peak > 0) & (peak < rise.shape[1] - 1)
    before, after = rise[index, np.maximum(peak - 1, 0)], rise[index, np.minimum(peak + 1, rise.shape[1] - 1)]
    bend = before - 2.0 * at_peak + after
    fraction = np.where(bend < 0.0, 0.5 * (before - after) / np.where(bend < 0.0, bend, -1.0), 0.0)
    distance_px = (peak + fraction - (_HALF_SAMPLES - _BASE)) * step_px
    typical = float(np.quantile(at_peak, 0.9)) if len(at_peak) else 0.0
    is_seen = inside & within & (at_peak >= max(_RISE_MIN, _RISE_SHARE_MIN * typical))
    return Crossings(distance_px, np.einsum("nk,nkj->nj", normals, slopes), is_seen)
