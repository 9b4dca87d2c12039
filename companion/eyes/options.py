"""The options that several commands of `pad-detector` take."""

from pathlib import Path
from typing import Annotated

import typer

BoardOption = Annotated[
    Path | None, typer.Option("--board", metavar="FILE", help="The board, in TOML [default: 1.5 m, ids 0 to 62].")
]
SourceOption = Annotated[
    str,
    typer.Option(
        "--source",
        metavar="CAMERA",
        help="/dev/videoN, picamera, rtsp://HOST/PATH, a video file, a folder of pictures, or zenoh.",
    ),
]
CalibrationOption = Annotated[
    Path,
    typer.Option("--calibration", metavar="FILE", help="Of the camera: ROS camera_info or kalibr's camchain, YAML."),
]
MountingOption = Annotated[
    Path | None,
    typer.Option("--mounting", metavar="FILE", help="Of the camera on the drone, TOML [default: straight down]."),
]
SizeOption = Annotated[
    tuple[int, int] | None,
    typer.Option("--size", metavar="WIDTH HEIGHT", help="Pixels to ask of the camera [default: the calibration's]."),
]
