"""The camera on the simulated drone: what it looks at, and what its detector is told of it and makes of it.

The camera is 5 cm in front of the drone's reference and 3 cm below it and looks down, with the long side of its picture
along the drone. How it is mounted and calibrated is told to the detector with errors that are drawn for each seed.
The detector is the real one, in step with the simulation: only frames that the pad may be in are looked at, and of
these only the parts that it asks for are rendered.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from companion.eyes.board import Board, nested_board
from companion.eyes.calibration import dump_calibration
from companion.eyes.camera import Camera
from companion.eyes.mounting import Mounting, MountingConfig, mounting_of
from companion.eyes.picture import Box, Part
from companion.eyes.sight import Frame, SightMemory, SightSystem, sight_step
from link.errors import UserError
from link.frames.rotations import matrix_from_quaternion, quaternion_from_roll_pitch_yaw
from link.messages import BodyTruth, PadSighting
from link.program.toml_config import dump_toml
from link.records import replace
from scenarios.camera.lens import CAMERA, SIZE_PX
from scenarios.camera.lighting import Light
from scenarios.camera.optics import Optics
from scenarios.camera.planes import View
from scenarios.camera.rendering import Renderer, Vehicle
from scenarios.config import Scenario
from scenarios.simulation.noise import Seed, SensorSchedule, named_rng
from scenarios.simulation.vehicle import VehicleState, vehicle_truth

Array = NDArray[np.float64]

MOUNTING = MountingConfig(position_flu_m=(0.05, 0.0, -0.03), yaw_rad=0.5 * math.pi)
_MOUNTING_STD_RAD = 0.003  # of the true camera from what is told: within what the mounting file states
_FOCAL_STD_SHARE = 0.001
_PAINT_RANGE = (0.1, 0.5)  # albedo of roofs, from dark gray to silver


@dataclass(frozen=True)
class RenderedPicture:
    """A picture that is rendered where it is looked at.

    Attributes:
        renderer: of the scene.
        view: from where.
        light: by which.
        may_show_pad: some of the board's plate may be in it.
    """

    renderer: Renderer
    view: View
    light: Light
    may_show_pad: bool

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height."""
        return SIZE_PX

    def part(self, box: Box) -> Part:
        """Return what is within `box`."""
        return Part(self.renderer.render(self.view, self.light, box), box)


class CameraScene:
    """The scene of a scenario and a seed.

    Args:
        scenario: whose light and vehicle.
        seed: of the sun, the paint, the dirt, the noise, and the errors of mounting and calibration.

    Attributes:
        system: what the detector is told of camera, mounting and board.
    """

    def __init__(self, scenario: Scenario, seed: Seed) -> None:
        rng = named_rng(seed, "camera scene")
        self._config = scenario.camera
        board = nested_board(min(scenario.vehicle.pad_size_m))
        vehicle = Vehicle(
            board=board,
            length_m=scenario.vehicle.length_m,
            width_m=scenario.vehicle.width_m,
            roof_height_m=scenario.vehicle.roof_height_m,
            paint=float(rng.uniform(*_PAINT_RANGE)),
        )
        self._sun_enu = _draw_sun(scenario.camera.sun_elevation_range_rad, rng)
        optics = Optics(readout_s=scenario.camera.readout_s, wet_share=scenario.camera.wet_share)
        self._renderer = Renderer(vehicle, scenario.camera.dirt_share, rng, optics)
        self._pad_v_m = np.array([0.0, 0.0, scenario.vehicle.roof_height_m])
        told = mounting_of(mounting_told(scenario))
        self._mounting = _misaligned(told, rng)
        self.system = SightSystem(camera=_miscalibrated(rng), mounting=told, board=Board(board))

    def picture(self, vehicle: BodyTruth, drone: BodyTruth) -> RenderedPicture:
        """Return what the camera sees at the drone's time, to which the vehicle is carried by its velocity."""
        view = view_of(vehicle, drone, self._mounting)
        sun_v = None
        if self._sun_enu is not None:
            sun_v = matrix_from_quaternion(vehicle.orientation_wxyz).T @ self._sun_enu
        light = Light(
            daylight_lx=self._config.daylight_lx,
            sun_v=sun_v,
            lamp_lm=self._config.lamp_lm,
            is_glossy=self._config.is_glossy,
        )
        return RenderedPicture(self._renderer, view, light, self._may_see(view))

    def _may_see(self, view: View) -> bool:
        """Return whether any of the board's plate may be in the picture."""
        in_c = (self.system.board.outline_m + self._pad_v_m - view.camera_m) @ view.R_VC
        depth = in_c[:, 2]
        if (depth <= 0.0).all():
            return False
        reach = self.system.camera.radius_max
        beside = [(sign * in_c[:, axis] > reach * depth).all() for axis in (0, 1) for sign in (1.0, -1.0)]
        return not any(beside)


def mounting_told(scenario: Scenario) -> MountingConfig:
    """Return what the detector is told of how the camera is mounted, and of its shutter."""
    return MOUNTING.model_copy(update={"readout_s": scenario.camera.readout_s})


def view_of(vehicle: BodyTruth, drone: BodyTruth, mounting: Mounting) -> View:
    """Return how a camera on the drone stands and moves against a vehicle."""
    age_s = (vehicle.t_ns - drone.t_ns) * 1e-9
    R_WV, R_WB = matrix_from_quaternion(vehicle.orientation_wxyz), matrix_from_quaternion(drone.orientation_wxyz)
    R_VB = R_WV.T @ R_WB
    driving_v, turning_v = np.array(vehicle.velocity_flu_m_s), np.array(vehicle.angular_velocity_flu_rad_s)
    away_v = R_WV.T @ (np.array(drone.position_enu_m) - np.array(vehicle.position_enu_m)) + age_s * driving_v
    camera_v = away_v + R_VB @ mounting.position_flu_m
    swing_b = np.cross(np.array(drone.angular_velocity_flu_rad_s), mounting.position_flu_m)
    velocity_v = R_VB @ (np.array(drone.velocity_flu_m_s) + swing_b) - driving_v - np.cross(turning_v, camera_v)
    turning_b = np.array(drone.angular_velocity_flu_rad_s) - R_VB.T @ turning_v
    return View(
        R_VC=R_VB @ mounting.R_BC,
        camera_m=camera_v,
        velocity_m_s=velocity_v,
        turning_c_rad_s=mounting.R_BC.T @ turning_b,
        drone_m=away_v,
    )


def _draw_sun(elevation_range_rad: tuple[float, float] | None, rng: np.random.Generator) -> Array | None:
    """Return a unit vector in W towards the sun, from any side."""
    azimuth_rad = float(rng.uniform(-math.pi, math.pi))
    if elevation_range_rad is None:
        return None
    up_rad = float(rng.uniform(*elevation_range_rad))
    level = math.cos(up_rad)
    return np.array([level * math.cos(azimuth_rad), level * math.sin(azimuth_rad), math.sin(up_rad)])


def _misaligned(told: Mounting, rng: np.random.Generator) -> Mounting:
    roll, pitch, yaw = (_MOUNTING_STD_RAD * rng.standard_normal(3)).tolist()
    turn = matrix_from_quaternion(quaternion_from_roll_pitch_yaw(roll, pitch, yaw))
    return replace(told, R_BC=turn @ told.R_BC)


def _miscalibrated(rng: np.random.Generator) -> Camera:
    matrix = CAMERA.matrix.copy()
    matrix[[0, 1], [0, 1]] *= 1.0 + _FOCAL_STD_SHARE * float(rng.standard_normal())
    return Camera(model=CAMERA.model, matrix=matrix, distortion=CAMERA.distortion, size_px=CAMERA.size_px)


CALIBRATION, MOUNTED, BOARD = "camera.yaml", "mounting.toml", "board.toml"


def write_camera_files(scenario: Scenario, seed: Seed, folder: Path) -> None:
    """Write calibration, mounting and board, with the errors of the seed, into a folder.

    Raises:
        UserError: the folder cannot be written.
    """
    system = CameraScene(scenario, seed).system
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / CALIBRATION).write_text(dump_calibration(system.camera), encoding="utf-8")
        (folder / MOUNTED).write_text(dump_toml(mounting_told(scenario)), encoding="utf-8")
        (folder / BOARD).write_text(dump_toml(system.board.config), encoding="utf-8")
    except OSError as error:
        raise UserError(f"{folder}: cannot be written ({error.strerror}); choose another folder") from None


def detector_arguments(folder: Path) -> list[str]:
    """Return the options of `pad-detector run` by which it reads them."""
    return [
        *("--calibration", str(folder / CALIBRATION)),
        *("--mounting", str(folder / MOUNTED)),
        *("--board", str(folder / BOARD)),
    ]


_DRONE_AGE_MAX_NS = 100_000_000  # an older truth of the drone makes no frame


class CameraSensor:
    """A detector of `SensorSuite`.

    Args:
        scenario: whose camera.
        seed: of what it sees, and of its samples' way.
    """

    def __init__(self, scenario: Scenario, seed: Seed) -> None:
        self.schedule = SensorSchedule(scenario.camera, seed, "camera")
        self._scene = CameraScene(scenario, seed)
        self._memory = SightMemory()

    def sample(self, vehicle: VehicleState, drone: BodyTruth, _elapsed_s: float) -> PadSighting | None:
        """Return what the detector makes of a frame at the drone's own time, None where it sees no pad."""
        if vehicle.t_ns - drone.t_ns > _DRONE_AGE_MAX_NS:
            return None
        picture = self._scene.picture(vehicle_truth(vehicle), drone)
        if not picture.may_show_pad:
            return None
        frame = Frame(t_ns=drone.t_ns, picture=picture, orientation_wxyz=drone.orientation_wxyz)
        self._memory, sight = sight_step(self._memory, frame, self._scene.system)
        return sight.sighting
