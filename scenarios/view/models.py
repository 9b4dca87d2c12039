"""What stands in the view's scene: the drone, the vehicle with its pad, its estimated outline, the cone."""

from typing import Any

import numpy as np

from companion.config.descent import DescentConfig
from link.messages import PadGeometry, Vector3
from scenarios.view.shapes import box_edges, cone

BLUE, ORANGE, GREEN, GREY = (0, 114, 178), (213, 94, 0), (0, 158, 115), (110, 118, 130)
"""Told apart with any kind of colour vision: blue, vermilion and bluish green of Okabe and Ito."""

_BODY, _GLASS, _DARK, _WHITE = (186, 196, 208), (70, 84, 100), (40, 44, 52), (245, 245, 245)
_CAR_M = (4.2, 1.8)  # where the vehicle does not tell: a car's length and width
_CONE_HEIGHT_M = 3.0
_ARM_M, _ROTOR_M, _FEET_M = 0.26, 0.16, 0.15


def draw_drone(scene: Any) -> Any:
    """Draw a quadrotor: body, arms, rotors and legs, its nose orange."""
    frame = scene.add_frame("/world/drone", show_axes=False)
    scene.add_box("/world/drone/body", _DARK, (0.26, 0.16, 0.09))
    scene.add_box("/world/drone/nose", ORANGE, (0.06, 0.1, 0.06), position=(0.15, 0.0, 0.0))
    for index, (x, y) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        half = np.arctan2(y, x) / 2.0
        tip = (x * _ARM_M * 0.7071, y * _ARM_M * 0.7071, 0.0)
        middle = (tip[0] / 2.0, tip[1] / 2.0, 0.0)
        turned = (float(np.cos(half)), 0.0, 0.0, float(np.sin(half)))
        scene.add_box(f"/world/drone/arm{index}", _DARK, (_ARM_M, 0.035, 0.03), position=middle, wxyz=turned)
        rotor = (tip[0], tip[1], 0.05)
        color = ORANGE if x > 0 else BLUE
        scene.add_cylinder(f"/world/drone/rotor{index}", _ROTOR_M, 0.012, color, opacity=0.75, position=rotor)
        leg = (0.55 * tip[0], 0.55 * tip[1], -_FEET_M / 2.0)
        scene.add_box(f"/world/drone/leg{index}", _DARK, (0.02, 0.02, _FEET_M), position=leg)
    return frame


def draw_vehicle(scene: Any, pad: PadGeometry) -> Any:
    """Draw a car whose roof carries the pad; V is on the road under the pad."""
    name = "/world/vehicle"
    frame = scene.add_frame(name, show_axes=False)
    length_m, width_m, roof_m = _size(pad)
    boxes = (
        ("body", _BODY, (length_m, width_m, 0.5 * roof_m), (0.0, 0.0, 0.38 * roof_m)),
        ("cabin", _GLASS, (0.62 * length_m, 0.94 * width_m, 0.33 * roof_m), (-0.02 * length_m, 0.0, 0.79 * roof_m)),
        ("roof", _BODY, (0.6 * length_m, 0.95 * width_m, 0.05 * roof_m), (-0.02 * length_m, 0.0, 0.965 * roof_m)),
    )
    for part, paint, size, place in boxes:
        scene.add_box(f"{name}/{part}", paint, size, position=place)
    _wheels(scene, name, length_m, width_m)
    _pad_marks(scene, name, pad)
    return frame


def draw_outline(scene: Any, pad: PadGeometry) -> Any:
    """Draw the edges of the same car, for where it is estimated to be."""
    edges = box_edges(_size(pad))
    return scene.add_line_segments("/world/estimated", edges, ORANGE, thickness=2.0, thickness_units="screen")


def _size(pad: PadGeometry) -> Vector3:
    return max(_CAR_M[0], pad.size_m[0] + 0.4), max(_CAR_M[1], pad.size_m[1] + 0.2), max(pad.height_m, 0.1)


def _wheels(scene: Any, name: str, length_m: float, width_m: float) -> None:
    across = (0.7071, 0.7071, 0.0, 0.0)
    for index, (x, y) in enumerate(((1, 1), (1, -1), (-1, 1), (-1, -1))):
        place = (0.31 * x * length_m, 0.48 * y * width_m, 0.31)
        scene.add_cylinder(f"{name}/wheel{index}", 0.31, 0.2, _DARK, position=place, wxyz=across)


def _pad_marks(scene: Any, name: str, pad: PadGeometry) -> None:
    """The pad: a white square with a blue one and a cross in it."""
    (length_m, width_m), height_m = pad.size_m, pad.height_m
    squares = (
        ("pad", _WHITE, (length_m, width_m, 0.01), 0.0),
        ("field", BLUE, (0.86 * length_m, 0.86 * width_m, 0.01), 0.004),
        ("bar", _WHITE, (0.5 * length_m, 0.08 * width_m, 0.01), 0.008),
        ("cross", _WHITE, (0.08 * length_m, 0.5 * width_m, 0.01), 0.008),
    )
    for part, color, size, above_m in squares:
        scene.add_box(f"{name}/{part}", color, size, position=(0.0, 0.0, height_m + above_m - 0.005), cast_shadow=False)


def draw_cone(scene: Any, descent: DescentConfig) -> Any:
    """Draw the cone that the drone must stay in to sink, on the pad's centre."""
    frame = scene.add_frame("/world/cone", show_axes=False)
    vertices, faces = cone(descent.cone.radius_at_pad_m, descent.cone.slope, _CONE_HEIGHT_M)
    scene.add_mesh_simple(
        "/world/cone/wall", vertices, faces, color=GREEN, opacity=0.13, side="double", cast_shadow=False
    )
    return frame
