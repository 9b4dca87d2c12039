"""The pose of the board in the camera: from corners without a guess, and from edges with one.

Without a guess: IPPE (Collins and Bartoli 2014) gives both poses that explain the corners of a plane; seen from far
away the two differ by a tilt to either side. With one: the distances of the edges from where they are expected are
brought to zero by Gauss-Newton, damped as by Levenberg and Marquardt, each weighted as by Huber, and looked for again
each time. A pose is the rotation vector and the translation of P in C.

How surely a pose is known is told by what is left of these distances. A point's error is noise of its own (sensor,
sampling) and what all points of its edge share (blur, light, the print's edge, a bend of the plate). Blur, contrast and
size are all in what is left, so none of them is modelled. A pose moves an edge by a shift and a slope: what is left of
these two, edge by edge, says how well the edges agree with one another, and so how far the pose may be off. What is
left beside them is the points' own noise; the edges do not agree better than that allows but by chance, of which there
is much where one tag of four edges is all that is seen. Source: analysis of variance with random effects (Searle,
Casella and McCulloch 1992, chapter 3), one per edge.
"""

from dataclasses import dataclass
from typing import NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from companion.eyes.board import CELLS, Board
from companion.eyes.camera import Camera, matrix_of
from companion.eyes.finding.edges import EdgePoints, edge_points, find_crossings
from companion.eyes.picture import Part

Array = NDArray[np.float64]

Pose = tuple[Array, Array]

_POSE = 6  # what is fitted: rotation and translation
AGREES_PX = 3.0
"""Three standard deviations of what a search finds: OpenCV's corners of blurred tags."""
_REACHES_PX = (40.0, 12.0, 5.0, 4.0)  # of the rounds: first as far as the guess may be off, then as fine as blur allows
_EDGE_STD_PX = 0.1  # of one point, at best: what is left of lenses and printing after a calibration
_HUBER = 1.5  # standard deviations
_DOUBT_SHARE = 0.25  # of the reach: an edge that is far off is no outlier before the guess has been brought near
_REWEIGHTINGS = 3
_DAMPING = 1e-6  # of the largest curvature: one tag far away leaves its tilt nearly open
_POINTS_MIN = 12
_INDEPENDENT = 2  # points of an edge
_SEEN_SHARE_MIN = 0.5
_EDGE_SHARE_MIN = 0.3  # of each edge of at least one tag: with three edges of one, the fourth may be anywhere


@dataclass(frozen=True)
class Refined:
    """A pose that the edges agree with.

    Attributes:
        pose: of P in C.
        covariance: (6, 6) of rotation (rad, about P's origin) and translation (m), from the edges' own scatter.
        rms_px: of the distances.
        points: how many edges' points it rests on.
        squares_px2: sum of the squared distances, each of them by Huber's weight.
        variance_px2: by which that sum is a number of standard deviations squared where poses are compared: points of
            one edge may err alike, and none is better than a calibration and a print are.
        independent: points, if those that err alike count once: about what that number should be.
    """

    pose: Pose
    covariance: Array
    rms_px: float
    points: int
    squares_px2: float
    variance_px2: float
    independent: float


def guesses(camera: Camera, board: Board, corners_px: dict[int, Array]) -> list[Pose]:
    """Return the two poses that most tags of a search agree with, or none.

    Args:
        camera: that took the picture.
        board: that they are on.
        corners_px: of each id the corners (4, 2); those of wrong ids agree with no others.
    """
    ids = list(corners_px)
    if len(ids) > 1:
        places = np.concatenate([board.corners_m[tag_id][:, :2] for tag_id in ids])
        rays = camera.rays(np.concatenate([corners_px[tag_id] for tag_id in ids]))
        _, agrees = cv2.findHomography(places, rays, cv2.RANSAC, AGREES_PX / camera.focal_px)
        if agrees is not None:
            kept = np.asarray(np.all(np.asarray(agrees).reshape(-1, 4), axis=1)).tolist()
            ids = [tag_id for tag_id, is_kept in zip(ids, kept, strict=True) if is_kept]
    return _two_poses(camera, board, corners_px, ids) if ids else []


def _two_poses(camera: Camera, board: Board, corners_px: dict[int, Array], ids: list[int]) -> list[Pose]:
    places = np.concatenate([board.corners_m[tag_id] for tag_id in ids])
    rays = camera.rays(np.concatenate([corners_px[tag_id] for tag_id in ids]))
    middle = places.mean(axis=0)  # IPPE wants a plane about its origin
    try:
        _, rotations, translations, _ = cv2.solvePnPGeneric(
            places - middle, rays, np.eye(3), None, flags=cv2.SOLVEPNP_IPPE
        )
    except cv2.error:
        return []  # corners on one line, or on one place
    found = []
    for rotation, translation in zip(rotations, translations, strict=True):
        vector = np.asarray(rotation, np.float64).ravel()
        shifted = np.asarray(translation, np.float64).ravel() - np.asarray(cv2.Rodrigues(vector)[0]) @ middle
        is_ahead = float(np.asarray(translation).ravel()[2]) > 0.0  # the tags; the board's middle may be behind
        if np.isfinite(vector).all() and np.isfinite(shifted).all() and is_ahead:
            found.append((vector, shifted))
    return found


def refine(part: Part, camera: Camera, board: Board, pose: Pose, sides_px: dict[int, float]) -> Refined | None:
    """Return the pose that the edges of tags agree with, None where too few of them are seen.

    Args:
        part: of the picture.
        camera: that took it.
        board: that is seen.
        pose: about.
        sides_px: of the tags to use, the lengths of their sides in the picture.
    """
    points = edge_points([board.corners_m[tag_id] for tag_id in sides_px], list(sides_px.values()), CELLS)
    points = points.only(camera.in_view(points.places_m, *pose))
    if len(points.places_m) < _POINTS_MIN:
        return None
    found: Refined | None = None
    for reach_px in _REACHES_PX:
        found = _round(part, camera, points, pose, reach_px)
        if found is None:
            return None
        pose = found.pose
    return found


def _round(part: Part, camera: Camera, points: EdgePoints, pose: Pose, reach_px: float) -> Refined | None:
    """Return the pose after looking for the edges once."""
    found = find_crossings(part, camera, points, pose, reach_px)
    seen = found.is_seen
    if seen.sum() < max(_POINTS_MIN, _SEEN_SHARE_MIN * len(seen)):
        return None
    if not _is_outlined(points.edges, seen):
        return None
    std_min_px = _EDGE_STD_PX if reach_px == _REACHES_PX[-1] else _DOUBT_SHARE * reach_px
    step = _least_squares(found.slopes[seen], found.distance_px[seen], std_min_px)
    if step is None:
        return None
    moved = (pose[0] + step.change[:3], pose[1] + step.change[3:])
    if (points.places_m @ matrix_of(moved[0])[2] + moved[1][2] <= 0.0).any():
        return None  # the board's middle may be behind the camera, no edge that is seen
    rms_px = float(np.sqrt(step.squares_px2 / max(float(step.weights.sum()) - 6.0, 1.0)))
    alike = _points_alike(points.edges[seen])
    return Refined(
        pose=moved,
        covariance=variance_px2(step.left_px, step.weights, points.edges[seen]) * step.inverse,
        rms_px=rms_px,
        points=int(seen.sum()),
        squares_px2=step.squares_px2,
        variance_px2=alike * max(rms_px, _EDGE_STD_PX) ** 2,
        independent=float(seen.sum()) / alike,
    )


def _is_outlined(edges: NDArray[np.int64], seen: NDArray[np.bool_]) -> bool:
    """Return whether of some tag each edge that is in view is seen; points (N,) by their edge, four edges to a tag."""
    numbers, index = np.unique(edges, return_inverse=True)
    shares = np.bincount(index, weights=seen) / np.bincount(index)
    tags = numbers // 4
    return any(bool((shares[tags == tag] >= _EDGE_SHARE_MIN).all()) for tag in np.unique(tags))


def _points_alike(edges: NDArray[np.int64]) -> float:
    """Return how many points of an edge (N,: of which each point is) err alike, on average.

    Blur, light and a plate's bend change slowly along an edge; so it tells its place and its slope, whatever the number
    of points that are looked for on it.
    """
    return max(len(edges) / (_INDEPENDENT * len(np.unique(edges))), 1.0)


class _Step(NamedTuple):
    """A weighted step: change (6,), inverse of the curvature (6, 6), what is left (N,), with which weights (N,)."""

    change: Array
    inverse: Array
    left_px: Array
    weights: Array

    @property
    def squares_px2(self) -> float:
        """The weighted sum of the squares of what is left."""
        return float(np.sum(self.weights * self.left_px**2))


def _least_squares(A: Array, distance_px: Array, std_min_px: float) -> _Step | None:
    """Return the step that brings distances (N,) with slopes A (N, 6) to zero; outliers count less, as by Huber."""
    change, inverse = np.zeros(6), np.zeros((6, 6))
    left_px, weights = distance_px, np.ones(len(distance_px))
    for _ in range(_REWEIGHTINGS):
        H = (A * weights[:, None]).T @ A
        try:
            inverse = np.asarray(np.linalg.inv(H + _DAMPING * np.diag(np.diag(H))), np.float64)
        except np.linalg.LinAlgError:
            return None
        change = inverse @ (A.T @ (weights * distance_px))
        left_px = distance_px - A @ change
        std_px = max(1.4826 * float(np.median(np.abs(left_px))), std_min_px)
        weights = np.minimum(1.0, _HUBER * std_px / np.maximum(np.abs(left_px), 1e-9))
    if not np.isfinite(change).all():
        return None
    return _Step(change, inverse, left_px, weights)


def variance_px2(left_px: Array, weights: Array, edges: NDArray[np.int64]) -> float:
    """Return the variance by which the inverse of the curvature becomes the covariance of the pose.

    Args:
        left_px: (N,) of the distances.
        weights: (N,) of the points, as they were fitted.
        edges: (N,) of which edge each point is, those of one together and in their order along it.
    """
    scaled = np.sqrt(weights) * left_px
    _, first, index, count = np.unique(edges, return_index=True, return_inverse=True, return_counts=True)
    along = np.arange(len(edges)) - first[index] - 0.5 * (count[index] - 1.0)
    lengths = np.bincount(index, along**2)
    has_slope = lengths > 0.0
    shifts = np.bincount(index, scaled) ** 2 / count
    slopes = np.bincount(index, along * scaled)[has_slope] ** 2 / lengths[has_slope]
    between = float(shifts.sum() + slopes.sum())
    own = max(float(scaled @ scaled) - between, 0.0)
    told = len(count) + int(has_slope.sum())
    return max(between / max(told - _POSE, 1), own / max(len(edges) - told, 1))
