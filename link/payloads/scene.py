"""A landing as transforms, a 3-D scene, a place on the map and a log: ROS 2 messages that Foxglove shows as they are.

Frames: `map` is W, `base_link` the drone's body B, `vehicle` the vehicle's body V on the road under the pad, and `pad`
the middle of the pad. What stands still in one of them is drawn there, so that it moves with the transforms.
"""

from collections.abc import Iterator
from math import cos, degrees, pi, sin
from typing import Any

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from link.messages import PadGeometry, Quaternion, Vector3
from link.payloads.decklander_msgs import RosMessage, typestore
from link.payloads.foxglove_msgs import PACKAGE
from link.payloads.ros_fields import ANTENNA_FRAME, BODY_FRAME, WORLD_FRAME, to_header, to_time
from link.payloads.scene_parts import (
    Color,
    make_cube,
    make_cylinder,
    make_entity,
    make_line,
    make_message,
    make_quaternion,
    make_text,
    make_vector,
)

Array = NDArray[np.float64]
Pose = tuple[Vector3, Quaternion]

VEHICLE_FRAME, PAD_FRAME = "vehicle", "pad"
TRANSFORM_TOPIC = "tf"

_BLUE: Color = (0.15, 0.39, 0.92, 1.0)
_ORANGE: Color = (0.92, 0.43, 0.08, 1.0)
_GREEN: Color = (0.09, 0.57, 0.27, 1.0)
_DARK: Color = (0.16, 0.17, 0.2, 1.0)
_GREY: Color = (0.73, 0.77, 0.82, 1.0)
_WHITE: Color = (0.96, 0.96, 0.96, 1.0)
_CONE_COLOR: Color = (0.09, 0.57, 0.27, 0.13)

_CAR_M = (4.2, 1.8)  # where the vehicle does not tell: a car's length and width
_CONE_HEIGHT_M = 3.0
_ARM_M, _ROTOR_M, _BODY_M = 0.18, 0.32, (0.26, 0.16, 0.09)
_ELLIPSE_POINTS = 24
_ELLIPSE_EVERY = 5  # points of the forecast: one a second
_LEVEL: Quaternion = (1.0, 0.0, 0.0, 0.0)
_CENTRE: Vector3 = (0.0, 0.0, 0.0)
_INFO = 20  # rcl_interfaces/msg/Log

_CIRCLE = [
    (cos(2.0 * pi * index / _ELLIPSE_POINTS), sin(2.0 * pi * index / _ELLIPSE_POINTS))
    for index in range(_ELLIPSE_POINTS)
]


class Cone(Struct, frozen=True, kw_only=True):
    """In which the drone descends: its radius at the pad, and how much wider it is per metre of height."""

    radius_at_pad_m: float
    slope: float


class Scene(Struct, frozen=True, kw_only=True, eq=False):
    """What is known at `t_ns`; None where it is not.

    Attributes:
        t_ns: UTC.
        drone: its place in W and q_WB.
        vehicle: the point on the road under the pad in W, and q_WV.
        pad: as the vehicle describes it.
        cone: above the pad.
        forecast_enu_m: (n, 3) in W, the vehicle's antenna over the horizon.
        forecast_std_m: (n, 3), its standard deviations.
        plan_enu_m: (n, 3) in W, the drone's planned way.
        label: for people, above the drone.
    """

    t_ns: int
    drone: Pose | None = None
    vehicle: Pose | None = None
    pad: PadGeometry | None = None
    cone: Cone | None = None
    forecast_enu_m: Array | None = None
    forecast_std_m: Array | None = None
    plan_enu_m: Array | None = None
    label: str = ""


def transform_message(scene: Scene) -> RosMessage | None:
    """Return the transforms of a scene on `/tf`, None without any."""
    placed = [(WORLD_FRAME, frame, pose) for frame, pose in _placed(scene) if pose is not None]
    if scene.vehicle is not None and scene.pad is not None:
        placed.append((VEHICLE_FRAME, PAD_FRAME, ((0.0, 0.0, scene.pad.height_m), _LEVEL)))
    if not placed:
        return None
    types = typestore().types
    transforms = [
        types["geometry_msgs/msg/TransformStamped"](
            header=to_header(max(scene.t_ns, 0), parent),
            child_frame_id=child,
            transform=types["geometry_msgs/msg/Transform"](
                translation=make_vector(place), rotation=make_quaternion(attitude)
            ),
        )
        for parent, child, (place, attitude) in placed
    ]
    return _message(TRANSFORM_TOPIC, "tf2_msgs/msg/TFMessage", transforms=transforms)


def scene_message(scene: Scene, topic: str) -> RosMessage:
    """Return a scene as a SceneUpdate; all of it, since a reader may begin anywhere. What is unknown is deleted."""
    entities = dict(_entities(scene))
    missing = [name for name in _NAMES if name not in entities]
    stamp = to_time(max(scene.t_ns, 0))
    deletions = [make_message("SceneEntityDeletion", timestamp=stamp, type=0, id=name) for name in missing]
    return _message(topic, f"{PACKAGE}/SceneUpdate", deletions=deletions, entities=list(entities.values()))


def location_message(topic: str, t_ns: int, geodetic_rad_m: Vector3) -> RosMessage:
    """Return a latitude, longitude (rad) and altitude (m) for the map, with an unknown covariance."""
    latitude_rad, longitude_rad, altitude_m = geodetic_rad_m
    types = typestore().types
    return _message(
        topic,
        "sensor_msgs/msg/NavSatFix",
        header=to_header(max(t_ns, 0), ANTENNA_FRAME),
        status=types["sensor_msgs/msg/NavSatStatus"](status=0, service=1),
        latitude=degrees(latitude_rad),
        longitude=degrees(longitude_rad),
        altitude=altitude_m,
        position_covariance=np.zeros(9),
        position_covariance_type=0,
    )


def log_message(topic: str, t_ns: int, name: str, text: str) -> RosMessage:
    """Return a line of a log by the program `name`."""
    return _message(
        topic,
        "rcl_interfaces/msg/Log",
        stamp=to_time(max(t_ns, 0)),
        level=_INFO,
        name=name,
        msg=text,
        file="",
        function="",
        line=0,
    )


def _placed(scene: Scene) -> tuple[tuple[str, Pose | None], ...]:
    return ((BODY_FRAME, scene.drone), (VEHICLE_FRAME, scene.vehicle))


_NAMES = ("drone", "vehicle", "cone", "forecast", "plan")


def _entities(scene: Scene) -> Iterator[tuple[str, Any]]:
    """Return what is known of a scene, by name."""
    t_ns = scene.t_ns
    if scene.drone is not None:
        cubes, rotors = _drone()
        texts = [make_text(scene.label)] if scene.label else []
        yield "drone", make_entity("drone", t_ns, BODY_FRAME, cubes=cubes, cylinders=rotors, texts=texts)
    if scene.vehicle is not None and scene.pad is not None:
        yield "vehicle", make_entity("vehicle", t_ns, VEHICLE_FRAME, cubes=_vehicle(scene.pad))
        if scene.cone is not None:
            yield "cone", make_entity("cone", t_ns, PAD_FRAME, cylinders=[_wall(scene.cone)])
    if scene.forecast_enu_m is not None:
        lines = [make_line(scene.forecast_enu_m.tolist(), _ORANGE), *_ellipses(scene)]
        yield "forecast", make_entity("forecast", t_ns, WORLD_FRAME, lines=lines)
    if scene.plan_enu_m is not None:
        yield "plan", make_entity("plan", t_ns, WORLD_FRAME, lines=[make_line(scene.plan_enu_m.tolist(), _GREEN)])


def _drone() -> tuple[list[Any], list[Any]]:
    """Return a quadrotor's body with its orange nose, and its rotors."""
    cubes = [make_cube(_CENTRE, _BODY_M, _DARK), make_cube((0.15, 0.0, 0.0), (0.06, 0.1, 0.06), _ORANGE)]
    rotors = [
        make_cylinder((x * _ARM_M, y * _ARM_M, 0.05), (_ROTOR_M, _ROTOR_M, 0.012), _ORANGE if x > 0 else _BLUE)
        for x, y in ((1, 1), (1, -1), (-1, 1), (-1, -1))
    ]
    return cubes, rotors


def _vehicle(pad: PadGeometry) -> list[Any]:
    """Return a car as high as its pad, and the pad on its roof."""
    length_m, width_m = max(_CAR_M[0], pad.size_m[0] + 0.4), max(_CAR_M[1], pad.size_m[1] + 0.2)
    roof_m = max(pad.height_m, 0.1)
    return [
        make_cube((0.0, 0.0, 0.38 * roof_m), (length_m, width_m, 0.5 * roof_m), _GREY),
        make_cube((0.0, 0.0, 0.8 * roof_m), (0.62 * length_m, 0.94 * width_m, 0.36 * roof_m), _DARK),
        make_cube((0.0, 0.0, pad.height_m - 0.01), (*pad.size_m, 0.02), _WHITE),
        make_cube((0.0, 0.0, pad.height_m - 0.005), (0.86 * pad.size_m[0], 0.86 * pad.size_m[1], 0.02), _BLUE),
    ]


def _wall(cone: Cone) -> Any:
    width_m = 2.0 * (cone.radius_at_pad_m + cone.slope * _CONE_HEIGHT_M)
    bottom = 2.0 * cone.radius_at_pad_m / width_m
    return make_cylinder((0.0, 0.0, 0.5 * _CONE_HEIGHT_M), (width_m, width_m, _CONE_HEIGHT_M), _CONE_COLOR, bottom)


def _ellipses(scene: Scene) -> Iterator[Any]:
    """Return horizontal ellipses of one standard deviation, one a second."""
    if scene.forecast_enu_m is None or scene.forecast_std_m is None:
        return
    centres, stds = scene.forecast_enu_m[::_ELLIPSE_EVERY].tolist(), scene.forecast_std_m[::_ELLIPSE_EVERY].tolist()
    for (x_m, y_m, z_m), (a_m, b_m, _) in zip(centres, stds, strict=True):
        points = [(x_m + a_m * along, y_m + b_m * across, z_m) for along, across in _CIRCLE]
        yield make_line(points, _ORANGE, is_closed=True)


def _message(topic: str, type_name: str, **values: Any) -> RosMessage:
    store = typestore()
    payload = bytes(store.serialize_cdr(store.types[type_name](**values), type_name, little_endian=True))
    return RosMessage(topic=topic, type_name=type_name, payload=payload)
