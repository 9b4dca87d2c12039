"""A campaign's summary as one table in Markdown, as docs/benchmark.md has it."""

import math
from collections.abc import Mapping, Sequence
from typing import Any, TextIO

from scenarios.campaigns.intervals import wilson
from scenarios.catalogue.firmware_option import without_firmware
from scenarios.config import FIRMWARES
from scenarios.manual.markdown import code, table
from scenarios.recordings.reason_counts import add_counts
from scenarios.scoring.score import Tier

Cell = Mapping[str, Any]

_DEG = 180.0 / math.pi
_MEASURES = (
    ("horizontal error m", "horizontal_error_m", 1.0, 2),
    ("relative speed m/s", "relative_speed_m_s", 1.0, 2),
    ("tilt over trim degrees", "tilt_over_trim_rad", _DEG, 1),
    ("passing to contact s", "time_to_contact_s", 1.0, 1),
)
_REASONS = {
    "aborts_by_reason": "Approaches broken off, by reason",
    "begun_anew_by_reason": "Approaches that began again, by reason",
    "not_landed_by_reason": "Ends of landings that were none, by reason",
}
_TIERS = (Tier.S3, Tier.S2, Tier.S1, Tier.S0, Tier.ABORT, Tier.UNSAFE)
_HEAD = (
    "cell",
    "firmware",
    "seeds",
    *(tier.value for tier in _TIERS),
    "failed",
    "S1 or better %",
    "unsafe %",
    "S2 quality %",
    *(heading for heading, *_ in _MEASURES),
    "NEES",
)


def write_markdown(summary: Mapping[str, Any], out: TextIO) -> None:
    """Write a campaign's summary: what all cells share, then a row each, and all of each firmware together."""
    cells: Sequence[Cell] = summary["cells"]
    shared = shared_options([cell["cell"] for cell in cells])
    if shared:
        out.write(f"All with {code('+' + '+'.join(shared))}. ")
    out.write("Shares with Wilson's 95 % intervals; measures at contact as median, 95th percentile.\n\n")
    rows = [_row(cell, shared) for cell in cells]
    firmwares = sorted({cell["firmware"] for cell in cells}, key=lambda one: [*FIRMWARES, one].index(one))
    by_firmware = {one: [cell for cell in cells if cell["firmware"] == one] for one in firmwares}
    rows += [_total(one, flown) for one, flown in by_firmware.items() if len(flown) > 1]
    out.write(table(_HEAD, rows))
    for firmware, flown in by_firmware.items():
        for name, what in _REASONS.items():
            counts = add_counts(cell[name] for cell in flown)
            if counts:
                told = ", ".join(f"{code(reason)} {count}" for reason, count in counts.items())
                out.write(f"\n{what}, {firmware}: {told}.\n")


def shared_options(names: Sequence[str]) -> list[str]:
    """Return the options that all cells' names have, in the first one's order; the firmware has its own column."""
    first, *others = [without_firmware(name).split("+")[1:] for name in names] or [[]]
    return [option for option in first if all(option in other for other in others)]


def _row(cell: Cell, shared: Sequence[str]) -> list[str]:
    track, *options = without_firmware(cell["cell"]).split("+")
    name = "+".join([track, *(option for option in options if option not in shared)])
    shares = [_share(cell[share]) for share in ("s1_or_better", "unsafe", "s2_quality")]
    nees = cell["nees"]["mean"]
    return [
        code(name),
        cell["firmware"],
        str(cell["seeds"]),
        *(_count(cell["tiers"][tier.value]) for tier in _TIERS),
        _count(cell["errors"]),
        *shares,
        *(_measure(cell[measure], factor, digits) for _, measure, factor, digits in _MEASURES),
        "" if nees is None else f"{nees:.1f}",
    ]


def _total(firmware: str, cells: Sequence[Cell]) -> list[str]:
    seeds = sum(cell["seeds"] for cell in cells)
    tiers = {tier: sum(cell["tiers"][tier.value] for cell in cells) for tier in _TIERS}
    landed, unsafe = tiers[Tier.S3] + tiers[Tier.S2] + tiers[Tier.S1], tiers[Tier.UNSAFE]
    shares = [wilson(count, seeds) for count in (landed, unsafe)]
    texts = [_share({"share": share.value, "low": share.low, "high": share.high}) for share in shares]
    counts = [*(tiers[tier] for tier in _TIERS), sum(cell["errors"] for cell in cells)]
    return ["all", firmware, str(seeds), *map(_count, counts), *texts, *[""] * (len(_MEASURES) + 2)]


def _count(number: int) -> str:
    return str(number) if number else ""


def _share(share: Mapping[str, float]) -> str:
    return f"{100.0 * share['share']:.0f} ({100.0 * share['low']:.1f} to {100.0 * share['high']:.1f})"


def _measure(spread: Mapping[str, float | None], factor: float, digits: int) -> str:
    median, p95 = spread["median"], spread["p95"]
    if median is None or p95 is None:
        return ""
    return f"{factor * median:.{digits}f}, {factor * p95:.{digits}f}"
