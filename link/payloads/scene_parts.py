"""The parts of a 3-D scene as messages of `foxglove_msgs`: boxes, cylinders, lines and texts, in entities."""

from typing import Any

import numpy as np

from link.messages import Quaternion, Vector3
from link.payloads.decklander_msgs import typestore
from link.payloads.foxglove_msgs import PACKAGE
from link.payloads.ros_fields import WORLD_FRAME, to_time

Color = tuple[float, float, float, float]

_DARK: Color = (0.16, 0.17, 0.2, 1.0)
_CENTRE: Vector3 = (0.0, 0.0, 0.0)
_LEVEL: Quaternion = (1.0, 0.0, 0.0, 0.0)
_LABEL_M: Vector3 = (0.0, 0.0, 0.6)  # above the drone


def make_entity(name: str, t_ns: int, frame: str, **primitives: list[Any]) -> Any:
    """Return an entity; what is in another frame than W moves with it."""
    kinds = ("arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models")
    return make_message(
        "SceneEntity",
        timestamp=to_time(max(t_ns, 0)),
        frame_id=frame,
        id=name,
        lifetime=typestore().types["builtin_interfaces/msg/Duration"](sec=0, nanosec=0),
        frame_locked=frame != WORLD_FRAME,
        metadata=[],
        **{kind: primitives.get(kind, []) for kind in kinds},
    )


def make_cube(place: Vector3, size_m: Vector3, color: Color) -> Any:
    """Return a box about `place`."""
    return make_message("CubePrimitive", pose=_pose(place), size=make_vector(size_m), color=make_color(color))


def make_cylinder(place: Vector3, size_m: Vector3, color: Color, bottom_scale: float = 1.0) -> Any:
    """Return an upright cylinder about `place`; a smaller `bottom_scale` makes it a cone that widens upwards."""
    return make_message(
        "CylinderPrimitive",
        pose=_pose(place),
        size=make_vector(size_m),
        bottom_scale=bottom_scale,
        top_scale=1.0,
        color=make_color(color),
    )


def make_line(points: list[Any], color: Color, *, is_closed: bool = False) -> Any:
    """Return a line two pixels wide through (n, 3) points."""
    point = typestore().types["geometry_msgs/msg/Point"]
    return make_message(
        "LinePrimitive",
        type=1 if is_closed else 0,
        pose=_pose(_CENTRE),
        thickness=2.0,
        scale_invariant=True,
        points=[point(x, y, z) for x, y, z in points],
        color=make_color(color),
        colors=[],
        indices=np.empty(0, dtype=np.uint32),
    )


def make_text(text: str) -> Any:
    """Return a text above the drone that faces the camera."""
    return make_message(
        "TextPrimitive",
        pose=_pose(_LABEL_M),
        billboard=True,
        font_size=14.0,
        scale_invariant=True,
        color=make_color(_DARK),
        text=text,
    )


def _pose(place: Vector3) -> Any:
    types = typestore().types
    return types["geometry_msgs/msg/Pose"](types["geometry_msgs/msg/Point"](*place), make_quaternion(_LEVEL))


def make_vector(vector: Vector3) -> Any:
    """Return a Vector3."""
    return typestore().types["geometry_msgs/msg/Vector3"](*vector)


def make_quaternion(wxyz: Quaternion) -> Any:
    """Return a Quaternion."""
    w, x, y, z = wxyz
    return typestore().types["geometry_msgs/msg/Quaternion"](x, y, z, w)


def make_color(color: Color) -> Any:
    """Return a color: red, green, blue and opacity, each from 0 to 1."""
    return make_message("Color", r=color[0], g=color[1], b=color[2], a=color[3])


def make_message(name: str, **values: Any) -> Any:
    """Return a message of `foxglove_msgs`."""
    return typestore().types[f"{PACKAGE}/{name}"](**values)
