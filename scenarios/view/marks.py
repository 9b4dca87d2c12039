"""The view's compass and scale on the ground, and the labels of drone and vehicle."""

import math
from typing import Any

import numpy as np

from link.messages import BodyTruth, LandingStatus, Vector3
from scenarios.view.state import ViewState

_INK = (45, 55, 72)
_PLACE_M = (2.4, -4.6)  # of compass and scale from what the camera follows, beside the road
_NORTH_M, _HEAD_M = 2.0, 0.3
_SCALE_M, _TICK_M = 5.0, 0.2
_RISE_M = 0.03  # over the ground, so that the grid does not cut them
_DRONE_LABEL_M, _VEHICLE_LABEL_M = (0.0, 0.0, 0.35), (-2.3, 0.0, 0.1)

_OVER_PAD_M = 1.0  # from its middle


class Marks:
    """What helps to read the scene; it hangs on the frames of drone and vehicle."""

    def __init__(self, scene: Any) -> None:
        self._compass = scene.add_frame("/compass", show_axes=False)
        self._place: Vector3 | None = None
        lines = [
            ((0.0, 0.0), (0.0, _NORTH_M)),
            ((0.0, _NORTH_M), (-0.5 * _HEAD_M, _NORTH_M - _HEAD_M)),
            ((0.0, _NORTH_M), (0.5 * _HEAD_M, _NORTH_M - _HEAD_M)),
            ((-0.5 * _SCALE_M, 0.0), (0.5 * _SCALE_M, 0.0)),
            *(((x * _SCALE_M, -_TICK_M), (x * _SCALE_M, _TICK_M)) for x in (-0.5, 0.5)),
        ]
        points = np.array([[(*start, 0.0), (*end, 0.0)] for start, end in lines], dtype=np.float32)
        scene.add_line_segments("/compass/lines", points, _INK, thickness=2.5, thickness_units="screen")
        scene.add_label("/compass/north", "N", position=(0.0, _NORTH_M + 0.3, 0.0), anchor="center-center")
        scene.add_label("/compass/scale", f"{_SCALE_M:g} m", position=(0.0, -0.5, 0.0), anchor="center-center")
        self._drone = scene.add_label("/world/drone/label", "", position=_DRONE_LABEL_M, anchor="bottom-center")
        self._vehicle = scene.add_label("/world/vehicle/label", "", position=_VEHICLE_LABEL_M, anchor="top-center")

    def put_on_ground(self, ground_m: float) -> None:
        """Put compass and scale on the ground, whose height in the scene is `ground_m`."""
        place = (*_PLACE_M, ground_m + _RISE_M)
        if place != self._place:
            self._place = self._compass.position = place

    def write(self, state: ViewState) -> None:
        """Write the labels as it is now; a browser lays a changed text out again, so twice a second will do."""
        _write(self._drone, drone_label(state.status))
        speed = _speed_m_s(state.vehicle_truth)
        _write(self._vehicle, "vehicle" if speed is None else f"vehicle {speed:.1f} m/s")


def drone_label(status: LandingStatus | None) -> str:
    """Return how high the drone is above the pad, or above the pad's height and how far away."""
    if status is None or status.height_above_pad_m is None:
        return "drone"
    height = f"{round(status.height_above_pad_m, 1) + 0.0:.1f} m"
    position = status.relative_position_enu_m
    away_m = 0.0 if position is None else math.hypot(*position[:2])
    return f"drone {height} above the pad" if away_m < _OVER_PAD_M else f"drone {height} higher, {away_m:.0f} m away"


def _write(label: Any, text: str) -> None:
    if label.text != text:
        label.text = text


def _speed_m_s(body: BodyTruth | None) -> float | None:
    return None if body is None else math.hypot(*body.velocity_flu_m_s)
