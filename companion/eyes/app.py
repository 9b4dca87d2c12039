"""The `pad-detector` command."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from companion.eyes import calibration_commands
from companion.eyes.calibration_commands import BoardOption, CalibrationOption, MountingOption, SizeOption, SourceOption
from link.errors import UserError
from link.program.cli import JsonOption, make_app
from link.program.extras import require
from link.zenoh.command_line import NameArguments, ZenohArguments

_EXAMPLES = {
    "": ("pad-detector run --source /dev/video0 --calibration camera.yaml --mounting mounting.toml",),
    "run": (
        "pad-detector run --source /dev/video0 --calibration camera.yaml --mounting mounting.toml",
        "pad-detector run --source picamera --calibration camera.yaml --mounting mounting.toml",
        "pad-detector run --source zenoh --calibration camera.yaml --mounting mounting.toml --board b.toml",
    ),
    "print": ("pad-detector print --out pad.pdf", "pad-detector print --side 0.5 --out b.pdf --save-board b.toml"),
    "calibrate": (
        "pad-detector calibrate --source /dev/video0 --out camera.yaml",
        "pad-detector calibrate --source pictures/ --pictures 60 --out camera.yaml",
    ),
    "latency": ("pad-detector latency --source /dev/video0 --calibration camera.yaml",),
    "bench": ("pad-detector bench",),
}
"""What the help of `pad-detector` shows as examples, by command."""

app = make_app("See the landing pad by a camera on the drone, and publish where it is.", _EXAMPLES)


@app.callback()
def pad_detector() -> None:
    """See the landing pad by a camera on the drone, and publish where it is."""
    require("camera", "pad-detector")


_LatencyOption = Annotated[
    float | None,
    typer.Option(
        "--latency",
        metavar="S",
        min=0.0,
        max=2.0,
        help="From the middle of an exposure to its stamp [default: 0.03 as it arrives, 0 of its own].",
    ),
]
_RateOption = Annotated[
    float, typer.Option("--rate", min=0.1, max=1000.0, help="Of a folder's pictures whose names are no times, in Hz.")
]


@app.command("run")
def run_detector(
    *,
    calibration: CalibrationOption,
    source: SourceOption = "/dev/video0",
    board: BoardOption = None,
    mounting: MountingOption = None,
    size: SizeOption = None,
    latency: _LatencyOption = None,
    rate: _RateOption = 30.0,
    record: Annotated[
        Path | None, typer.Option("--record", metavar="DIR", help="Keep pictures with what was seen here, as MCAP.")
    ] = None,
    names: NameArguments,
    endpoints: ZenohArguments,
) -> None:
    """Look at a camera's frames and publish where the pad is."""
    from companion.eyes.board import load_board
    from companion.eyes.calibration import load_calibration
    from companion.eyes.loop import EyesLoop
    from companion.eyes.mounting import load_mounting
    from companion.eyes.node import EyesNode
    from companion.eyes.recording import open_recorder
    from companion.eyes.sight import SightSystem
    from companion.eyes.sources.opening import SourceOptions, open_source
    from companion.eyes.sources.zenoh_source import PICTURE_MAX_BYTES
    from link.recording.log import Log
    from link.records import replace
    from link.zenoh.session import open_session

    keys = names.keys()
    camera = load_calibration(calibration)
    mounted = load_mounting(mounting)
    system = SightSystem(camera=camera, mounting=mounted, board=load_board(board))
    options = SourceOptions(
        size_px=size or camera.size_px, latency_s=latency, rate_hz=rate, readout_s=mounted.readout_s
    )
    with open_session(replace(endpoints.options(), message_max_bytes=PICTURE_MAX_BYTES)) as zenoh:
        frames = open_source(source, options, keys, zenoh)
        recorder = None if record is None else open_recorder(record, keys)
        log = Log("pad-detector")
        try:
            EyesLoop(EyesNode(system, keys), frames, keys, zenoh=zenoh, log=log, recorder=recorder).run()
        finally:
            frames.close()
            log.close()
            if recorder is not None:
                recorder.close()


@app.command("print")
def print_board(
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="Write the PDF here.")] = Path("pad.pdf"),
    board: BoardOption = None,
    size: Annotated[
        float | None, typer.Option("--side", metavar="M", help="A nested board of this side in place of --board.")
    ] = None,
    first_id: Annotated[int, typer.Option("--first-id", min=0, help="With --side: the board's lowest id.")] = 0,
    save_board: Annotated[
        Path | None, typer.Option("--save-board", metavar="FILE", help="Write the board here, for `run --board`.")
    ] = None,
) -> None:
    """Draw the board as a PDF in true size, with a ruler to check the print by."""
    from companion.eyes.board import load_board, nested_board
    from companion.eyes.pdf import write_pdf
    from link.program.toml_config import dump_toml

    if size is not None and board is not None:
        raise UserError("--side makes a board and --board names one: give one of them")
    if first_id and size is None:
        raise UserError("--first-id is for a board that --side makes: give --side, or leave it out")
    if size is not None and not 0.1 <= size <= 5.0:
        raise UserError(f"--side {size:g} is not from 0.1 to 5 m")
    if size is not None and save_board is None:  # taken for the default board it would be seen too far away
        raise UserError("--side makes a board that `run` has to know: add --save-board FILE, and give run --board FILE")
    config = load_board(board).config if size is None else nested_board(size, first_id)
    write_pdf(config, out)
    if save_board is not None:
        try:
            save_board.write_text(dump_toml(config), encoding="utf-8")
        except OSError as error:
            raise UserError(f"{save_board}: cannot be written ({error.strerror})") from None
    sys.stdout.write(f"{out}: {config.size_m[0]:g} x {config.size_m[1]:g} m, {len(config.tags)} tags\n")


@app.command("bench")
def bench_detector(*, as_json: JsonOption = False) -> None:
    """Measure how fast the detector is here, against OpenCV's bare one on the same pictures; takes some seconds."""
    import json

    from companion.eyes.bench import bench, text_lines

    table = bench()
    sys.stdout.write((json.dumps(table, indent=2) if as_json else "\n".join(text_lines(table))) + "\n")


calibration_commands.register(app)
