"""The view's lines and surfaces as arrays in W; pure numerics."""

import math
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from link.frames.rotations import quaternion_from_roll_pitch_yaw, rotate
from link.messages import Quaternion, Vector3
from scenarios.tracks.roads import Road
from scenarios.view.state import ForecastPath, ViewState

Array = NDArray[np.float64]
_ELLIPSE_POINTS = 48
_ELLIPSE_EVERY = 5  # points of the forecast: one a second
_ROAD_STEP_M = 2.0
_ROAD_AHEAD_MAX_M = 1500.0
_AHEAD_MAX_S = 0.3  # an older estimate is shown where it was
_COURSE_MIN_M_S = 0.5  # below it a course is no heading
Pose = tuple[Vector3, Quaternion]


def polyline(points: Array) -> Array:
    """Return the segments (n - 1, 2, 3) of a line through (n, 3)."""
    return np.stack([points[:-1], points[1:]], axis=1) if len(points) > 1 else np.empty((0, 2, 3))


def ellipses(forecast: ForecastPath, sigmas: float) -> Array:
    """Return the segments (n, 2, 3) of horizontal ellipses around every fifth point of a forecast."""
    angles = np.linspace(0.0, 2.0 * math.pi, _ELLIPSE_POINTS + 1)
    circle = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)
    centres, stds = forecast.position_enu_m[::_ELLIPSE_EVERY], forecast.std_m[::_ELLIPSE_EVERY]
    return np.concatenate(
        [np.empty((0, 2, 3)), *(polyline(c + sigmas * s * circle) for c, s in zip(centres, stds, strict=True))]
    )


def estimated_vehicle(state: ViewState) -> Pose | None:
    """Return the point on the road under the pad and q_WV as estimated, None while heading or pad are unknown.

    The estimate is told less often than motions are; it is carried on to the state's time.
    """
    estimate, pad = state.estimate, state.pad
    if estimate is None or pad is None:
        return None
    yaw_rad = estimate.yaw_rad
    if yaw_rad is None:
        x_m_s, y_m_s = estimate.velocity_enu_m_s[:2]
        if math.hypot(x_m_s, y_m_s) < _COURSE_MIN_M_S:
            return None
        yaw_rad = math.atan2(y_m_s, x_m_s)
    orientation = quaternion_from_roll_pitch_yaw(0.0, 0.0, yaw_rad)
    lever_x_m, lever_y_m, lever_z_m = rotate(orientation, pad.antenna_to_pad_m)
    ahead_s = min(max((state.t_ns - estimate.t_ns) * 1e-9, 0.0), _AHEAD_MAX_S)
    x_m, y_m, z_m = (float(value) for value in estimate.position_enu_m + ahead_s * estimate.velocity_enu_m_s)
    return (x_m + lever_x_m, y_m + lever_y_m, z_m + lever_z_m - pad.height_m), orientation


def true_vehicle(state: ViewState) -> Pose | None:
    """Return the point on the road under the pad and q_WV, None without truth."""
    truth = state.vehicle_truth
    return None if truth is None else (truth.position_enu_m, truth.orientation_wxyz)


def centre_line(road: Road) -> Array:
    """Return (n, 3) points along a road, as far as it is drawn."""
    lengths_m = np.arange(0.0, min(road.length_m, _ROAD_AHEAD_MAX_M) + _ROAD_STEP_M, _ROAD_STEP_M)
    points = [road.at(float(s_m)) for s_m in lengths_m]
    return np.array([(point.x_m, point.y_m, point.z_m) for point in points])


def ribbon(points: Array, width_m: float) -> tuple[Array, NDArray[np.int64]]:
    """Return vertices (2n, 3) and triangles (2n - 2, 3) of a band of `width_m` along (n, 3)."""
    along = np.gradient(points, axis=0)
    side = np.stack([-along[:, 1], along[:, 0], np.zeros(len(along))], axis=1)
    side *= 0.5 * width_m / np.maximum(np.linalg.norm(side, axis=1, keepdims=True), 1e-9)
    vertices = np.stack([points + side, points - side], axis=1).reshape(-1, 3)
    faces = [
        triangle
        for i, j in pairwise(range(len(points)))
        for triangle in ((2 * i, 2 * i + 1, 2 * j), (2 * j, 2 * i + 1, 2 * j + 1))
    ]
    return vertices, np.array(faces, dtype=np.int64)


def box_edges(size_m: Vector3) -> Array:
    """Return the twelve edges (12, 2, 3) of a box that stands on the middle of its bottom."""
    corners = [(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0.0, 1.0)]
    edges = [pair for pair in combinations(corners, 2) if sum(a != b for a, b in zip(*pair, strict=True)) == 1]
    return np.asarray(np.array(edges, dtype=np.float64) * np.array(size_m))


def cone(radius_at_pad_m: float, slope: float, height_m: float) -> tuple[Array, NDArray[np.int64]]:
    """Return vertices and triangles of the wall of a cone that widens upwards from the pad."""
    angles = np.linspace(0.0, 2.0 * math.pi, _ELLIPSE_POINTS, endpoint=False)
    rings = [
        np.stack([radius_m * np.cos(angles), radius_m * np.sin(angles), np.full_like(angles, z_m)], axis=1)
        for radius_m, z_m in ((radius_at_pad_m, 0.0), (radius_at_pad_m + slope * height_m, height_m))
    ]
    count = len(angles)
    faces = [
        triangle
        for i in range(count)
        for j in ((i + 1) % count,)
        for triangle in ((i, j, count + i), (count + i, j, count + j))
    ]
    return np.concatenate(rings), np.array(faces, dtype=np.int64)
