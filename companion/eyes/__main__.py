"""The `pad-detector` command."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from link.errors import UserError
from link.program.cli import make_app, run_app

app = make_app("See the landing pad by a camera on the drone, and publish where it is.")

BoardOption = Annotated[
    Path | None, typer.Option("--board", metavar="FILE", help="The board, in TOML [default: 1.5 m, ids 0 to 62].")
]


@app.callback()
def pad_detector() -> None:
    """See the landing pad by a camera on the drone, and publish where it is."""


@app.command("print")
def print_board(
    out: Annotated[Path, typer.Option("--out", metavar="FILE", help="Write the PDF here.")] = Path("pad.pdf"),
    board: BoardOption = None,
    size: Annotated[
        float | None, typer.Option("--size", metavar="M", help="A nested board of this side in place of --board.")
    ] = None,
    first_id: Annotated[int, typer.Option("--first-id", min=0, help="With --size: the board's lowest id.")] = 0,
    save_board: Annotated[
        Path | None, typer.Option("--save-board", metavar="FILE", help="Write the board here, for `run --board`.")
    ] = None,
) -> None:
    """Draw the board as a PDF in true size, with a ruler to check the print by."""
    from companion.eyes.board import load_board, nested_board
    from companion.eyes.pdf import write_pdf
    from link.program.toml_config import dump_toml

    if size is not None and board is not None:
        raise UserError("--size makes a board and --board names one: give one of them")
    if size is not None and not 0.1 <= size <= 5.0:
        raise UserError(f"--size {size:g} is not from 0.1 to 5 m")
    config = load_board(board).config if size is None else nested_board(size, first_id)
    write_pdf(config, out)
    if save_board is not None:
        try:
            save_board.write_text(dump_toml(config), encoding="utf-8")
        except OSError as error:
            raise UserError(f"{save_board}: cannot be written ({error.strerror})") from None
    sys.stdout.write(f"{out}: {config.size_m[0]:g} x {config.size_m[1]:g} m, {len(config.tags)} tags\n")


def main() -> None:
    """Run the command."""
    sys.exit(run_app("pad-detector", app))


if __name__ == "__main__":
    main()
