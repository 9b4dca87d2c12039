"""The camera on the simulated drone and the detector behind it: frames rendered from truth, where the detector looks.

The camera is 5 cm in front of the drone's reference and 3 cm below it and looks down, with the long side of its picture
along the drone. How it is mounted and calibrated is told to the detector with errors that are drawn for each seed.
Only frames that the pad may be in are looked at, and of these only the parts that the detector asks for.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from companion.eyes.board import Board, nested_board
from companion.eyes.camera import Camera
from companion.eyes.mounting import Mounting, MountingConfig, mounting_of
from companion.eyes.picture import Box, Part
from companion.eyes.sight import Frame, SightMemory, SightSystem, sight_step
from link.frames.rotations import matrix_from_quaternion, quaternion_from_roll_pitch_yaw
from link.messages import BodyTruth, PadSighting
from scenarios.camera.lens import CAMERA, SIZE_PX
from scenarios.camera.rendering import Light, Renderer, Vehicle, View
from scenarios.config import Scenario
from scenarios.simulation.noise import Seed, SensorSchedule, named_rng
from scenarios.simulation.vehicle import VehicleState

Array = NDArray[np.float64]

MOUNTING = MountingConfig(position_flu_m=(0.05, 0.0, -0.03), yaw_rad=0.5 * math.pi)
_MOUNTING_STD_RAD = 0.003  # of the true camera from what is told: within what the mounting file states
_FOCAL_STD_SHARE = 0.001
_PAINT_RANGE = (0.1, 0.5)  # albedo of roofs, from dark gray to silver
_DRONE_AGE_MAX_S = 0.1  # an older truth of the drone makes no frame


@dataclass(frozen=True)
class _RenderedPicture:
    """A picture that is rendered where it is looked at."""

    renderer: Renderer
    view: View
    light: Light

    @property
    def size_px(self) -> tuple[int, int]:
        return SIZE_PX

    def part(self, box: Box) -> Part:
        return Part(self.renderer.render(self.view, self.light, box), box)


class CameraSensor:
    """A detector of `SensorSuite` that looks at rendered frames.

    Args:
        scenario: whose light and vehicle.
        seed: of the sun, the paint, the dirt, the noise, and the errors of mounting and calibration.
    """

    def __init__(self, scenario: Scenario, seed: Seed) -> None:
        self.schedule = SensorSchedule(scenario.camera, seed, "camera")
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
        self._renderer = Renderer(vehicle, scenario.camera.dirt_share, rng)
        self._pad_v_m = np.array([0.0, 0.0, scenario.vehicle.roof_height_m])
        self._mounting = _misaligned(mounting_of(MOUNTING), rng)
        self._system = SightSystem(camera=_miscalibrated(rng), mounting=mounting_of(MOUNTING), board=Board(board))
        self._memory = SightMemory()

    def sample(self, vehicle: VehicleState, drone: BodyTruth, _elapsed_s: float) -> PadSighting | None:
        """Return what the detector makes of a frame at the drone's own time, None where it sees no pad."""
        age_s = (vehicle.t_ns - drone.t_ns) * 1e-9
        if age_s > _DRONE_AGE_MAX_S:
            return None
        view = view_of(vehicle, drone, self._mounting, age_s)
        if not self._may_see(view):
            return None
        R_WV = matrix_from_quaternion(vehicle.orientation_wxyz)
        light = Light(
            daylight_lx=self._config.daylight_lx,
            sun_v=None if self._sun_enu is None else R_WV.T @ self._sun_enu,
            lamp_lm=self._config.lamp_lm,
            is_glossy=self._config.is_glossy,
        )
        picture = _RenderedPicture(self._renderer, view, light)
        frame = Frame(t_ns=drone.t_ns, picture=picture, orientation_wxyz=drone.orientation_wxyz)
        self._memory, sight = sight_step(self._memory, frame, self._system)
        return sight.sighting

    def _may_see(self, view: View) -> bool:
        """Return whether any of the board's plate may be in the picture."""
        in_c = (self._system.board.outline_m + self._pad_v_m - view.camera_m) @ view.R_VC
        depth = in_c[:, 2]
        if (depth <= 0.0).all():
            return False
        reach = self._system.camera.radius_max
        beside = [(sign * in_c[:, axis] > reach * depth).all() for axis in (0, 1) for sign in (1.0, -1.0)]
        return not any(beside)


def view_of(vehicle: VehicleState, drone: BodyTruth, mounting: Mounting, age_s: float) -> View:
    """Return how a camera on the drone stands and moves against a vehicle whose state is `age_s` newer."""
    R_WV, R_WB = matrix_from_quaternion(vehicle.orientation_wxyz), matrix_from_quaternion(drone.orientation_wxyz)
    turning_v = np.array(vehicle.angular_velocity_flu_rad_s)
    velocity_w = np.array(vehicle.velocity_enu_m_s)
    R_VB = R_WV.T @ R_WB
    away_v = R_WV.T @ (np.array(drone.position_enu_m) - np.array(vehicle.position_enu_m) + age_s * velocity_w)
    camera_v = away_v + R_VB @ mounting.position_flu_m
    swing_b = np.cross(np.array(drone.angular_velocity_flu_rad_s), mounting.position_flu_m)
    velocity_v = (
        R_VB @ (np.array(drone.velocity_flu_m_s) + swing_b) - R_WV.T @ velocity_w - np.cross(turning_v, camera_v)
    )
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
    return Mounting(
        R_BC=turn @ told.R_BC,
        position_flu_m=told.position_flu_m,
        rotation_std_rad=told.rotation_std_rad,
        focal_std_share=told.focal_std_share,
    )


def _miscalibrated(rng: np.random.Generator) -> Camera:
    matrix = CAMERA.matrix.copy()
    matrix[[0, 1], [0, 1]] *= 1.0 + _FOCAL_STD_SHARE * float(rng.standard_normal())
    return Camera(model=CAMERA.model, matrix=matrix, distortion=CAMERA.distortion, size_px=CAMERA.size_px)
