"""The view's 3-D scene: drone, vehicle, pad, road, estimate, forecast, plan, cone, trails, compass and scale.

The camera follows a vehicle by moving the world instead: everything hangs on one frame, so that the mouse keeps
turning and zooming as it likes.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import viser

from companion.config.descent import DescentConfig
from link.messages import PadGeometry, Quaternion, Vector3
from scenarios.tracks.roads import Road
from scenarios.view.marks import Marks
from scenarios.view.models import BLUE, GREEN, GREY, ORANGE, draw_cone, draw_drone, draw_outline, draw_vehicle
from scenarios.view.shapes import (
    Array,
    Pose,
    centre_line,
    ellipses,
    estimated_vehicle,
    polyline,
    ribbon,
    true_vehicle,
)
from scenarios.view.state import ViewState

_ROAD, _WHITE = (88, 94, 102), (245, 245, 245)
_ROAD_WIDTH_M = 4.5
_SIGMAS = 1.0
_HOME_PAD = PadGeometry(size_m=(1.5, 1.5), height_m=1.5, antenna_to_pad_m=(0.0, 0.0, 0.0))
_LEVEL: Quaternion = (1.0, 0.0, 0.0, 0.0)
_CONE_PHASES = frozenset({"chase", "align", "descend"})
_PLANNED_PHASES = _CONE_PHASES | {"takeoff", "waiting", "abort", "hold"}
_SKY_TOP, _SKY_HORIZON = (146, 186, 224), (226, 231, 223)
CAMERAS: Mapping[str, tuple[Vector3, Vector3]] = MappingProxyType(
    {
        "chase": ((-5.6, -5.4, 4.2), (0.7, 0.5, 1.6)),
        "side": ((0.6, -9.0, 2.6), (0.6, 0.0, 2.0)),
        "top": ((0.0, -0.1, 16.0), (0.0, 0.0, 0.0)),  # north up
        "pad": ((-2.6, -1.6, 2.6), (0.0, 0.0, 1.6)),
    }
)
"""Of each name: where the camera stands and what it looks at, from what it follows, along east, north and up."""

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
        server.initial_camera.position, server.initial_camera.look_at = CAMERAS["chase"]
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
        self._drone = draw_drone(scene)
        self._vehicle = draw_vehicle(scene, _HOME_PAD)
        self._estimated = draw_outline(scene, _HOME_PAD)
        self._pad = _HOME_PAD
        self._cone = draw_cone(scene, descent)
        self._marks = Marks(scene)
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
        shown = true or estimated
        _place(self._vehicle, shown)
        _place(self._estimated, estimated)
        drone = None if state.drone is None else (state.drone.position_enu_m, state.drone.orientation_wxyz)
        _place(self._drone, drone)
        matters = shown is not None and _phase(state) in _CONE_PHASES
        _place(self._cone, (_raise_by(shown[0], self._pad.height_m), _LEVEL) if shown and matters else None)
        followed = {"vehicle": shown or drone, "drone": drone}.get(self.followed)
        if followed is not None:
            self._world.position = _negative(followed[0])
        self._marks.put_on_ground(float(self._world.position[2]))

    def write_labels(self, state: ViewState) -> None:
        """Write beside drone and vehicle what is to be read there; a few times a second does."""
        self._marks.write(state)

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
        self._vehicle = draw_vehicle(self._scene, pad)
        self._estimated = draw_outline(self._scene, pad)
        self._marks = Marks(self._scene)  # the labels went with the frames that they hung on


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
