"""The view's 3-D scene: drone, vehicle, pad, road, estimate, forecast, plan, cone and trails.

The camera follows a vehicle by moving the world instead: everything hangs on one frame, so that the mouse keeps
turning and zooming as it likes.
"""

from typing import Any

import numpy as np
import viser

from companion.config.descent import DescentConfig
from link.messages import PadGeometry, Quaternion, Vector3
from scenarios.tracks.roads import Road
from scenarios.view.shapes import (
    Array,
    Pose,
    box_edges,
    centre_line,
    cone,
    ellipses,
    estimated_vehicle,
    polyline,
    ribbon,
    true_vehicle,
)
from scenarios.view.state import ViewState

BLUE, ORANGE, GREEN, GREY = (37, 99, 235), (234, 110, 20), (22, 145, 70), (110, 118, 130)
_BODY, _GLASS, _ROAD, _DARK, _WHITE = (186, 196, 208), (70, 84, 100), (88, 94, 102), (40, 44, 52), (245, 245, 245)
_CAR_M = (4.2, 1.8)  # where the vehicle does not tell: a car's length and width
_ROAD_WIDTH_M = 4.5
_CONE_HEIGHT_M = 3.0
_ARM_M, _ROTOR_M, _FEET_M = 0.26, 0.16, 0.15
_SIGMAS = 1.0
_HOME_PAD = PadGeometry(size_m=(1.5, 1.5), height_m=1.5, antenna_to_pad_m=(0.0, 0.0, 0.0))
_LEVEL: Quaternion = (1.0, 0.0, 0.0, 0.0)
_CONE_PHASES = frozenset({"chase", "align", "descend"})
_PLANNED_PHASES = _CONE_PHASES | {"takeoff", "waiting", "touchdown", "abort", "hold"}
_SKY_TOP, _SKY_HORIZON = (146, 186, 224), (226, 231, 223)
FOLLOWED = ("vehicle", "drone", "nothing")


class Scene:
    """What is drawn, and where it is now."""

    def __init__(self, server: viser.ViserServer, descent: DescentConfig) -> None:
        self._scene = scene = server.scene
        self.followed = FOLLOWED[0]
        scene.set_up_direction("+z")
        scene.configure_environment_map(hdri=None)
        scene.configure_default_lights(enabled=True, cast_shadow=True)
        scene.add_light_ambient("/ambient", intensity=1.6)
        scene.set_background_image(_sky())
        server.initial_camera.position = (-5.6, -5.4, 4.2)
        server.initial_camera.look_at = (0.7, 0.5, 1.6)
        self._world = scene.add_frame("/world", show_axes=False)
        scene.add_grid(
            "/world/ground",
            infinite_grid=True,
            cell_size=5.0,
            section_size=25.0,
            cell_color=(208, 214, 206),
            section_color=(190, 198, 188),
            plane_color=(226, 231, 223),
            plane_opacity=1.0,
            fade_distance=400.0,
            position=(0.0, 0.0, -0.02),
        )
        self._drone = _drone(scene)
        self._vehicle = _vehicle(scene, _HOME_PAD)
        self._estimated = _outline(scene, _HOME_PAD)
        self._pad = _HOME_PAD
        self._cone = _cone(scene, descent)
        self._lines = {
            "drone": self._line("drone_trail", BLUE, 2.5),
            "pad": self._line("pad_trail", GREY, 2.0),
            "forecast": self._line("forecast", ORANGE, 2.5),
            "ellipses": self._line("ellipses", ORANGE, 1.0),
            "plan": self._line("plan", GREEN, 3.0),
        }

    def draw_road(self, road: Road) -> None:
        """Draw the road with its middle line."""
        line = centre_line(road)
        vertices, faces = ribbon(line, _ROAD_WIDTH_M)
        self._scene.add_mesh_simple("/world/road", vertices, faces, color=_ROAD, side="double", cast_shadow=False)
        dashes = polyline(line + np.array([0.0, 0.0, 0.02]))[::2]
        self._scene.add_line_segments("/world/dashes", dashes, _WHITE, thickness=2.0, thickness_units="screen")

    def show(self, state: ViewState) -> None:
        """Move everything to where it is now."""
        true, estimated = true_vehicle(state), estimated_vehicle(state)
        if state.pad is not None and state.pad != self._pad:
            self._rebuild(state.pad)
        _place(self._vehicle, true)
        _place(self._estimated, estimated)
        shown = true or estimated
        drone = None if state.drone is None else (state.drone.position_enu_m, state.drone.orientation_wxyz)
        _place(self._drone, drone)
        matters = shown is not None and _phase(state) in _CONE_PHASES
        _place(self._cone, (_raise_by(shown[0], self._pad.height_m), _LEVEL) if shown and matters else None)
        followed = {"vehicle": shown or drone, "drone": drone}.get(self.followed)
        if followed is not None:
            self._world.position = _negative(followed[0])

    def show_lines(self, state: ViewState, drone: Array, pad: Array) -> None:
        """Draw trails, forecast and plan; fewer times a second do."""
        flies = _phase(state) in _PLANNED_PHASES
        forecast, plan = (state.forecast, state.plan_enu_m) if flies else (None, None)
        empty = np.empty((0, 2, 3))
        self._draw("drone", polyline(drone))
        self._draw("pad", polyline(pad))
        self._draw("forecast", empty if forecast is None else polyline(forecast.position_enu_m))
        self._draw("ellipses", empty if forecast is None else ellipses(forecast, _SIGMAS))
        self._draw("plan", empty if plan is None else polyline(plan))

    def _line(self, name: str, color: tuple[int, int, int], thickness: float) -> Any:
        points = np.zeros((1, 2, 3), dtype=np.float32)
        return self._scene.add_line_segments(
            f"/world/{name}", points, color, thickness=thickness, thickness_units="screen", visible=False
        )

    def _draw(self, name: str, segments: Array) -> None:
        handle = self._lines[name]
        handle.visible = bool(len(segments))
        if len(segments):
            handle.points = segments.astype(np.float32)

    def _rebuild(self, pad: PadGeometry) -> None:
        """Draw the vehicle as high and its pad as large as it has told."""
        self._pad = pad
        for frame in (self._vehicle, self._estimated):
            frame.remove()
        self._vehicle = _vehicle(self._scene, pad)
        self._estimated = _outline(self._scene, pad)


def _phase(state: ViewState) -> str:
    return "" if state.status is None else state.status.phase


def _sky() -> Array:
    """Return an image, (rows, columns, rgb): blue above, and below the middle, where the horizon is, as the ground."""
    rows = np.clip(np.linspace(0.0, 2.0, 64), 0.0, 1.0)[:, None, None]
    shades = (1.0 - rows) * np.array(_SKY_TOP) + rows * np.array(_SKY_HORIZON)
    return np.broadcast_to(shades, (64, 8, 3)).astype(np.uint8)


def _place(handle: Any, pose: Pose | None) -> None:
    handle.visible = pose is not None
    if pose is not None:
        handle.position, handle.wxyz = pose


def _negative(position: Vector3) -> Vector3:
    x_m, y_m, z_m = position
    return -x_m, -y_m, -z_m


def _raise_by(position: Vector3, height_m: float) -> Vector3:
    x_m, y_m, z_m = position
    return x_m, y_m, z_m + height_m


def _drone(scene: Any) -> Any:
    """A quadrotor: body, arms, rotors and legs, its nose orange."""
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


def _vehicle(scene: Any, pad: PadGeometry) -> Any:
    """A car whose roof carries the pad; V is on the road under the pad."""
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


def _outline(scene: Any, pad: PadGeometry) -> Any:
    """The edges of the same car, for where it is estimated to be."""
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


def _cone(scene: Any, descent: DescentConfig) -> Any:
    frame = scene.add_frame("/world/cone", show_axes=False)
    vertices, faces = cone(descent.cone.radius_at_pad_m, descent.cone.slope, _CONE_HEIGHT_M)
    scene.add_mesh_simple(
        "/world/cone/wall", vertices, faces, color=GREEN, opacity=0.13, side="double", cast_shadow=False
    )
    return frame
