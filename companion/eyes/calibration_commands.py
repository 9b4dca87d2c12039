"""`pad-detector calibrate` and `pad-detector latency`: what has to be known of a camera before it is flown."""

import json
import math
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from msgspec import structs

from link.errors import UserError
from link.program.cli import JsonOption
from link.zenoh.command_line import DroneOption, NamespaceOption, ZenohArguments

if TYPE_CHECKING:
    from companion.eyes.calibrating import Quality
    from companion.eyes.latency import Latency


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
    typer.Option(
        "--size",
        metavar="WIDTH HEIGHT",
        help="Pixels to ask of the camera [default: the calibration's, without one its own].",
    ),
]


_RMS_GOOD_PX, _HALVES_GOOD_PX, _FOCAL_GOOD, _COVERED_GOOD, _TILT_GOOD_RAD = 0.5, 1.0, 0.002, 0.7, math.radians(30.0)
_STD_GOOD_S = 0.002  # a drone that turns at 0.5 rad/s sees a pad 5 m away 5 mm beside its place


def register(app: typer.Typer) -> None:
    """Add the commands."""
    app.command("calibrate")(calibrate_command)
    app.command("latency")(latency_command)


def calibrate_command(
    *,
    source: SourceOption = "/dev/video0",
    board: BoardOption = None,
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="Write it here.")] = Path("camera.yaml"),
    fisheye: Annotated[bool, typer.Option("--fisheye", help="For lenses of more than 120 degrees.")] = False,
    pictures: Annotated[
        int, typer.Option("--pictures", min=8, max=500, help="To collect, each with the board elsewhere.")
    ] = 40,
    size: SizeOption = None,
    as_json: JsonOption = False,
    namespace: NamespaceOption = "decklander",
    drone: DroneOption = "drone",
    endpoints: ZenohArguments,
) -> None:
    """Calibrate a camera by pictures of the board, say how good that is, and write it as ROS's camera_info.

    Hold still for a moment at each place; of a folder or a video all pictures are looked at.
    """
    from companion.eyes.board import load_board
    from companion.eyes.calibrating import calibrate
    from companion.eyes.calibration import dump_calibration
    from companion.eyes.collecting import collect_shots
    from companion.eyes.sources.opening import SourceOptions, open_source
    from companion.eyes.sources.zenoh_source import PICTURE_MAX_BYTES
    from link.records import replace
    from link.zenoh.keys import Keys
    from link.zenoh.session import open_session

    plate = load_board(board)
    with open_session(replace(endpoints.options(), message_max_bytes=PICTURE_MAX_BYTES)) as zenoh:
        options = SourceOptions(size_px=size, latency_s=0.0, rate_hz=30.0)
        frames = open_source(source, options, Keys(namespace, drone=drone), zenoh)
        try:
            shots, size_px = collect_shots(frames, plate, pictures, lambda line: typer.echo(line, err=True))
        finally:
            frames.close()
    camera, quality = calibrate(shots, plate, size_px, "fisheye" if fisheye else "pinhole")
    try:
        out.write_text(dump_calibration(camera), encoding="utf-8")
    except OSError as error:
        raise UserError(f"{out}: cannot be written ({error.strerror}); choose another --out") from None
    if as_json:
        told = {"camera": str(out), "focal_px": camera.focal_px, **structs.asdict(quality)}
        sys.stdout.write(json.dumps(told, indent=2) + "\n")
        return
    sys.stdout.write("\n".join([*quality_lines(quality, camera.focal_px), f"written to {out}"]) + "\n")


def quality_lines(quality: "Quality", focal_px: float) -> list[str]:
    """Return how good a calibration is, a line for each figure, with what to do about a poor one."""
    lines = (
        (f"pictures used    {quality.shots}, left out {quality.left_out}", True, ""),
        (f"left over        {quality.rms_px:.2f} px", quality.rms_px <= _RMS_GOOD_PX, "put the board on a flat plate"),
        (
            f"focal length     {focal_px:.1f} px, to {100.0 * quality.focal_std_share:.2f} %",
            quality.focal_std_share <= _FOCAL_GOOD,
            "take more pictures, tilted to all sides",
        ),
        (f"for the mounting focal_std_share = {max(quality.focal_std_share, 1e-4):.4f}", True, ""),
        (
            f"both halves      differ by {quality.halves_px:.2f} px",
            quality.halves_px <= _HALVES_GOOD_PX,
            "take more pictures",
        ),
        (
            f"covered          {100.0 * quality.covered_share:.0f} % of the picture",
            quality.covered_share >= _COVERED_GOOD,
            "bring the board into the corners as well",
        ),
        (
            f"tilted           by up to {math.degrees(quality.tilt_max_rad):.0f} degrees",
            quality.tilt_max_rad >= _TILT_GOOD_RAD,
            "tilt it by 45 degrees to all sides",
        ),
    )
    return [text if is_good else f"{text}: poor, {advice}" for text, is_good, advice in lines]


def latency_command(
    calibration: CalibrationOption,
    *,
    source: SourceOption = "/dev/video0",
    board: BoardOption = None,
    mounting: MountingOption = None,
    size: SizeOption = None,
    seconds: Annotated[
        float, typer.Option("--duration", min=3.0, max=600.0, help="Seconds for which it is turned.")
    ] = 15.0,
    as_json: JsonOption = False,
    namespace: NamespaceOption = "decklander",
    drone: DroneOption = "drone",
    endpoints: ZenohArguments,
) -> None:
    """Measure how late a camera's pictures are stamped, while the drone is turned to and fro over a pad that stands.

    The attitude comes from a companion beside it (`companion --dry-run`).
    """
    from companion.eyes.board import load_board
    from companion.eyes.calibration import load_calibration
    from companion.eyes.collecting import collect_rotation
    from companion.eyes.latency import fit_latency
    from companion.eyes.mounting import load_mounting
    from companion.eyes.sight import SightSystem
    from companion.eyes.sources.opening import SourceOptions, open_source
    from companion.eyes.sources.zenoh_source import PICTURE_MAX_BYTES
    from link.records import replace
    from link.zenoh.keys import Keys
    from link.zenoh.session import open_session

    keys, camera = Keys(namespace, drone=drone), load_calibration(calibration)
    system = SightSystem(camera=camera, mounting=load_mounting(mounting), board=load_board(board))
    with open_session(replace(endpoints.options(), message_max_bytes=PICTURE_MAX_BYTES)) as zenoh:
        own = zenoh.subscribe(keys.record("own"))
        options = SourceOptions(size_px=size or camera.size_px, latency_s=0.0, rate_hz=30.0)
        frames = open_source(source, options, keys, zenoh)
        try:
            found = collect_rotation(frames, own, system, seconds, lambda line: typer.echo(line, err=True))
        finally:
            frames.close()
    _show_latency(fit_latency(*found), as_json=as_json)


def _show_latency(latency: "Latency", *, as_json: bool) -> None:
    if as_json:
        sys.stdout.write(json.dumps(asdict(latency), indent=2) + "\n")
        return
    poor = "" if latency.std_s <= _STD_GOOD_S else ": poor, turn it faster or for longer"
    sys.stdout.write(
        f"latency {1e3 * latency.latency_s:.1f} ms, standard deviation {1e3 * latency.std_s:.1f} ms{poor}\n"
        f"of {latency.sightings} sightings, turned by {latency.turning_rad_s:.2f} rad/s, "
        f"{math.degrees(latency.left_rad):.2f} degrees left over\n"
        f"give it as --latency {max(latency.latency_s, 0.0):.3f} to `pad-detector run`\n"
    )
