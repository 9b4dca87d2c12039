"""What all figures share: their style, colours that no kind of sight confuses, and their two forms, PNG and SVG."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from link.errors import UserError

_DPI = 150
STYLES: dict[Any, Any] = {
    "svg.hashsalt": "decklander",
    "font.size": 9,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "0.85",
    "grid.linewidth": 0.5,
}
DARK, MIDDLE, LIGHT = "0.0", "0.4", "0.65"
BLUE, VERMILION, GREEN, ORANGE, SKY, PURPLE = "#0072b2", "#d55e00", "#009e73", "#e69f00", "#56b4e9", "#cc79a7"
"""Colours that are told apart with any kind of colour vision. Lines also differ in dashes, for prints in grey.

Source: Okabe and Ito, Color Universal Design (2008).
"""

PHASE_COLORS = {
    "takeoff": LIGHT,
    "waiting": LIGHT,
    "chase": SKY,
    "align": ORANGE,
    "descend": BLUE,
    "touchdown": GREEN,
    "secured": GREEN,
    "abort": VERMILION,
    "hold": PURPLE,
    "pilot in command": DARK,
}
"""Of each phase in which something is flown or has landed; the others are as `LIGHT`."""


def save_all(figures: Mapping[str, Figure], folder: Path) -> list[Path]:
    """Write figures as PNG and SVG by name, without the time of day, so that the same figure is the same file.

    Raises:
        UserError: the folder cannot be written.
    """
    files: list[Path] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with mpl.rc_context(STYLES):
            for name, figure in figures.items():
                png, svg = folder / f"{name}.png", folder / f"{name}.svg"
                figure.savefig(png, dpi=_DPI)
                figure.savefig(svg, metadata={"Date": None})
                files += [png, svg]
    except OSError as error:
        raise UserError(f"{folder}: cannot be written ({error.strerror}); choose another --out") from None
    return files
