"""Where a camera sees planes of V, and surfaces painted there.

Frames: V the vehicle's body (FLU, origin on the road), C the camera.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from companion.eyes.picture import remapped
from scenarios.camera.surfaces import Surface

Array = NDArray[np.float64]
Floats = NDArray[np.float32]

_EVERY = 4  # points of a picture, along and across: enough to find where a surface is


@dataclass(frozen=True, slots=True, kw_only=True)
class View:
    """Where the camera is and how it moves against the vehicle: R_VC, places and velocity in V, turning in C."""

    R_VC: Array
    camera_m: Array
    velocity_m_s: Array
    turning_c_rad_s: Array
    drone_m: Array


def where_on_plane(homography: Array, rays: Floats, center: Array, radius_m: float) -> tuple[slice, slice]:
    """Return the rows and columns that show a square on a plane; all of them where that cannot be told simply."""
    square = center + radius_m * np.array([[1.0, 1.0], [1.0, -1.0], [-1.0, -1.0], [-1.0, 1.0]])
    seen = np.column_stack([square, np.ones(4)]) @ np.linalg.inv(homography).T
    height, width = rays.shape[:2]
    if (seen[:, 2] <= 0.0).any():
        return slice(0, height), slice(0, width)
    directions = seen[:, :2] / seen[:, 2:]
    along, down = rays[height // 2, :, 0], rays[:, width // 2, 1]
    spare = 0.1  # of the tangent: lines of equal direction are bent by the distortion
    first, last = np.searchsorted(along, [directions[:, 0].min() - spare, directions[:, 0].max() + spare]).tolist()
    top, bottom = np.searchsorted(down, [directions[:, 1].min() - spare, directions[:, 1].max() + spare]).tolist()
    return slice(top, bottom), slice(first, last)


def to_plane(view: View, height_m: float) -> Array:
    """Return the homography (3, 3) from a ray (x, y, 1) in C to (forward, left, 1) on V's plane at a height."""
    from_plane = view.R_VC.T @ np.column_stack(
        [np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, height_m]) - view.camera_m]
    )
    return np.asarray(np.linalg.inv(from_plane))


def on_plane(homography: Array, rays: Floats) -> Floats:
    """Return where rays (rows, columns, 2) meet a plane, by the homography from rays to it."""
    flat = cv2.perspectiveTransform(np.ascontiguousarray(rays).reshape(-1, 1, 2), homography)
    return np.asarray(flat, np.float32).reshape(rays.shape)


def fills(surface: Surface, view: View, height_m: float, rays: Floats) -> bool:
    """Return whether nothing but a surface is seen."""
    edges = np.concatenate([rays[[0, -1]].reshape(-1, 1, 2), rays[:, [0, -1]].reshape(-1, 1, 2)])
    if surface.repeats or float(np.max(edges @ view.R_VC[2, :2] + view.R_VC[2, 2])) > 0.0:
        return False
    at = on_plane(surface.from_plane(0) @ to_plane(view, height_m), edges.astype(np.float32))
    limit = np.array(surface.levels[0].shape[::-1]) - 0.5
    return bool(((at > -0.5) & (at < limit)).all())


def paint(albedo: Floats, surface: Surface, onto_plane: Array, rays: Floats) -> None:
    """Lay a surface over what is there already."""
    texels = _texels_per_point(surface, onto_plane, rays)
    level = min(max(math.floor(math.log2(max(texels, 1e-6))), 0), len(surface.levels) - 1)
    texture = surface.levels[level]
    at = on_plane(surface.from_plane(level) @ onto_plane, rays)
    if surface.repeats:
        albedo[:] = remapped(texture, at, cv2.BORDER_WRAP)
        return
    inside = _is_inside(at, texture)
    if inside.any():
        np.copyto(albedo, remapped(texture, at, cv2.BORDER_REPLICATE), where=inside)


def _is_inside(at: Floats, texture: Floats) -> NDArray[np.bool_]:
    rows, columns = texture.shape
    x, y = at[..., 0], at[..., 1]
    return np.asarray((x > -0.5) & (x < columns - 0.5) & (y > -0.5) & (y < rows - 0.5))


def _texels_per_point(surface: Surface, onto_plane: Array, rays: Floats) -> float:
    """Return how many of the finest texels a point of the picture is wide, in the middle of what the surface fills."""
    middle = rays[rays.shape[0] // 2, rays.shape[1] // 2]
    onto_texels = surface.from_plane(0) @ onto_plane
    if not surface.repeats:  # elsewhere the plane may be much farther away, and its texels far too coarse
        some = np.ascontiguousarray(rays[::_EVERY, ::_EVERY])
        inside = _is_inside(on_plane(onto_texels, some), surface.levels[0])
        middle = some[inside].mean(axis=0) if inside.any() else middle
    step = float(rays[0, 1, 0] - rays[0, 0, 0])
    three = (middle + np.array([[0.0, 0.0], [step, 0.0], [0.0, step]])).reshape(-1, 1, 2)
    at = cv2.perspectiveTransform(three, onto_texels).reshape(3, 2)
    return float(math.sqrt(abs(np.linalg.det(at[1:] - at[0]))))
