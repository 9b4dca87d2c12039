"""Where the camera is on the drone, from TOML: from its frame C to the drone's body B (FLU).

Unturned, the camera looks straight down with the upper edge of its picture forwards. Roll, pitch and yaw then turn it
about B's axes (ZYX): a pitch of -0.5 looks forwards by that, a yaw of pi/2 has the picture's upper edge to the left.
"""

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from link.frames.rotations import (
    matrix_from_quaternion,
    quaternion_from_matrix,
    quaternion_from_roll_pitch_yaw,
    roll_pitch_yaw_of,
)
from link.program.toml_config import StrictModel, load_config

Array = NDArray[np.float64]
Angle = Annotated[float, Field(ge=-math.pi, le=math.pi)]
Coordinate = Annotated[float, Field(ge=-5.0, le=5.0)]

_R_BC_DOWN = np.array([[0.0, -1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])


class MountingConfig(StrictModel):
    """The camera on the drone; the doubts are standard deviations on each axis, of what does not change in flight."""

    position_flu_m: tuple[Coordinate, Coordinate, Coordinate] = (0.0, 0.0, 0.0)  # p_BC, from the autopilot's reference
    roll_rad: Angle = 0.0
    pitch_rad: Angle = 0.0
    yaw_rad: Angle = 0.0
    rotation_std_rad: Annotated[float, Field(ge=0.0, le=0.2)] = 0.005  # 0.3 degrees: aligned by eye along an edge
    focal_std_share: Annotated[float, Field(ge=0.0, le=0.1)] = (
        0.002  # of the focal length; calibrations state 1 to 2 px
    )
    # Of the board's middle: a print that is not quite true on a plate that is not quite flat.
    board_std_m: Annotated[float, Field(ge=0.0, le=0.1)] = 0.001
    # From reading the picture's first row to its last, 0 for a global shutter. A sighting's time is then that of the
    # rows that show the pad: at 0.5 rad/s and 20 ms a pad 5 m away is seen up to 2.5 cm beside its place without this.
    readout_s: Annotated[float, Field(ge=0.0, le=0.2)] = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Mounting:
    """The same as arrays: R_BC (3, 3) and where C's origin is in B (3,), with the doubts and the shutter."""

    R_BC: Array
    position_flu_m: Array
    rotation_std_rad: float
    focal_std_share: float
    board_std_m: float
    readout_s: float = 0.0


def mounting_of(config: MountingConfig) -> Mounting:
    """Return the mounting that `config` describes."""
    turn = matrix_from_quaternion(quaternion_from_roll_pitch_yaw(config.roll_rad, config.pitch_rad, config.yaw_rad))
    return Mounting(
        R_BC=turn @ _R_BC_DOWN,
        position_flu_m=np.array(config.position_flu_m),
        rotation_std_rad=config.rotation_std_rad,
        focal_std_share=config.focal_std_share,
        board_std_m=config.board_std_m,
        readout_s=config.readout_s,
    )


def covariance_flu_m2(mounting: Mounting, place_c_m: Array, covariance_c_m2: Array) -> Array:
    """Return the covariance (3, 3) in B of a place that is seen, with the doubts of the mounting.

    Args:
        mounting: of the camera.
        place_c_m: (3,) in C.
        covariance_c_m2: (3, 3) in C, of the place alone.
    """
    in_c = covariance_c_m2 + mounting.focal_std_share**2 * np.outer(place_c_m, place_c_m)
    in_c += mounting.board_std_m**2 * np.eye(3)
    arm = mounting.R_BC @ place_c_m
    in_b = mounting.R_BC @ in_c @ mounting.R_BC.T
    in_b += mounting.rotation_std_rad**2 * (float(arm @ arm) * np.eye(3) - np.outer(arm, arm))
    return np.asarray(0.5 * (in_b + in_b.T))


def angles_of(R_BC: Array) -> tuple[float, float, float]:
    """Return roll, pitch and yaw of a camera's attitude (3, 3), as `MountingConfig` has them."""
    return roll_pitch_yaw_of(quaternion_from_matrix(R_BC @ _R_BC_DOWN.T))


def load_mounting(path: Path | None) -> Mounting:
    """Return the mounting in a TOML file, straight down from the drone's reference for None.

    Raises:
        UserError: the file cannot be read or does not fit.
    """
    return mounting_of(load_config(path, MountingConfig))
