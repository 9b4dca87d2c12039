"""What a study of the detector says, as tables."""

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from scenarios.eyes.draws import ANGLE_MAX_RAD, LIGHTS
from scenarios.eyes.study import FLIP_RAD, Look

Table = dict[str, Any]

RANGES_M = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)
ANGLES_RAD = (0.0, math.radians(20.0), math.radians(40.0), ANGLE_MAX_RAD)


def summary_of(looks: Sequence[Look]) -> Table:
    """Return the shares and errors by range, light and angle, and what was seen that was not there."""
    there = [look for look in looks if look.has_board]
    bare = [look for look in looks if not look.has_board]
    return {
        "frames": len(there),
        "all": _row(there),
        "by_range_m": {
            f"{low:g} to {high:g}": _row(look for look in there if low <= look.range_m < high)
            for low, high in pairwise(RANGES_M)
        },
        "by_light": {light: _row(look for look in there if look.light == light) for light in LIGHTS},
        "by_angle_deg": {
            f"{math.degrees(low):g} to {math.degrees(high):g}": _row(
                look for look in there if low <= look.angle_rad < high
            )
            for low, high in pairwise(ANGLES_RAD)
        },
        "frames_without_the_board": len(bare),
        "false_detections": sum(look.error_m is not None for look in bare),
    }


def _row(looks: Iterable[Look]) -> Table:
    """Return the figures of some frames, None where nothing was seen."""
    chosen = list(looks)
    seen = [look for look in chosen if look.error_m is not None]
    errors_m = np.array([look.error_m for look in seen], np.float64)
    limits_m = np.array([0.01 + 0.01 * look.range_m for look in seen])
    row: Table = {"frames": len(chosen), "seen_share": len(seen) / len(chosen) if chosen else None}
    row["flips"] = sum(look.tilt_rad is not None and look.tilt_rad > FLIP_RAD for look in seen)
    if not seen:
        return row | {"error_median_m": None, "error_p95_m": None, "within_limit_share": None, "nees_mean": None}
    return row | {
        "error_median_m": float(np.median(errors_m)),
        "error_p95_m": float(np.quantile(errors_m, 0.95)),
        "within_limit_share": float(np.mean(errors_m <= limits_m)),
        "nees_mean": float(np.mean([look.nees for look in seen])),
    }


def text_lines(table: Table) -> list[str]:
    """Return the tables in Markdown."""
    head = "frames | seen | error, median | error, 95 % | within 1 cm + 1 % | NEES | flipped"
    lines: list[str] = []
    for title, rows in (
        ("range, m", table["by_range_m"] | {"all": table["all"]}),
        ("light", table["by_light"]),
        ("angle, degrees", table["by_angle_deg"]),
    ):
        lines += [f"| {title} | {head} |", "|---" * 8 + "|"]
        lines += [f"| {name} | {' | '.join(_cells(row))} |" for name, row in rows.items()]
        lines.append("")
    lines.append(
        f"without the board: {table['frames_without_the_board']} frames, {table['false_detections']} false detections"
    )
    return lines


def _cells(row: Table) -> list[str]:
    if row["error_median_m"] is None:
        return [str(row["frames"]), "0 %" if row["frames"] else "", "", "", "", "", ""]
    return [
        str(row["frames"]),
        f"{100.0 * row['seen_share']:.1f} %",
        f"{1000.0 * row['error_median_m']:.1f} mm",
        f"{1000.0 * row['error_p95_m']:.1f} mm",
        f"{100.0 * row['within_limit_share']:.1f} %",
        f"{row['nees_mean']:.2f}",
        str(row["flips"]),
    ]
