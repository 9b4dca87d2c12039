"""Summaries and comparisons as sheets of text, which a terminal and the page show alike."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TextIO

from scenarios.campaigns.intervals import banded
from scenarios.campaigns.sheets import Sheet, open_console, print_sheets
from scenarios.catalogue.firmware_option import firmware_text, without_firmware
from scenarios.recordings.reason_counts import add_counts, counts_text
from scenarios.scoring.score import Tier

_DEG = 180.0 / math.pi
_UNITS = {
    "horizontal_error_m": ("error", "m", 1.0, 3),
    "relative_speed_m_s": ("speed", "m/s", 1.0, 2),
    "sink_rate_m_s": ("sink", "m/s", 1.0, 2),
    "tilt_over_trim_rad": ("tilt", "degrees", _DEG, 1),
    "time_to_contact_s": ("time", "s", 1.0, 1),
    "tilt_rad": ("raw tilt", "degrees", _DEG, 1),
    "position_rmse_m": ("estimate", "m", 1.0, 3),
    "velocity_rmse_m_s": ("estimate", "m/s", 1.0, 3),
    "pass_to_contact_s": ("from passing", "s", 1.0, 1),
}
"""Of each measure: heading, unit shown, factor to it, digits."""

Cell = Mapping[str, Any]
Column = tuple[str, Callable[[Cell], str]]


def print_summary(summary: Mapping[str, Any], out: TextIO) -> None:
    """Print a campaign's summary."""
    print_sheets(summary_sheets(summary), out)


def summary_sheets(summary: Mapping[str, Any]) -> list[Sheet]:
    """Return a campaign's summary: what was reached, why not more, the shares, the contacts, the consistency."""
    cells: Sequence[Cell] = summary["cells"]
    reached: list[Column] = [("seeds", lambda cell: str(cell["seeds"])), *(_tier_column(tier) for tier in Tier)]
    reached += [(name, _count_of(name)) for name in ("aborts", "retries")]
    if any(cell["errors"] for cell in cells):
        reached.append(("errors", _count_of("errors")))
    shares = [(f"{heading} [%]", _share_of(name)) for name, heading in _SHARES.items()]
    contact: list[Column] = [("contacts", _count_of("contacts"))]
    contact += [(f"{_UNITS[name][0]} [{_UNITS[name][1]}]", _measure_of(name)) for name in _UNITS]
    consistency: list[Column] = [("NEES", _band_of("nees")), ("NIS per dof", _band_of("nis_per_dof"))]
    sheets = [
        _sheet("Landings", reached, cells),
        *_reasons_sheet(cells),
        _sheet("Shares (95 % intervals)", shares, cells),
        _sheet(_CONTACT_TITLE, contact, cells),
        _sheet("The estimate's consistency (95 % band); what lies out of it is above or below", consistency, cells),
    ]
    if all("planner_ms" in cell for cell in cells):
        sheets.append(
            _sheet("Computing (medians over landings; the planner's max is the worst of all)", _COMPUTING, cells)
        )
    return sheets


def print_comparison(comparison: Mapping[str, Any], out: TextIO) -> None:
    """Print a comparison of two campaigns A and B."""
    cells: Sequence[Cell] = comparison["cells"]
    shares: list[Column] = [("pairs", lambda cell: str(cell["pairs"]))]
    shares += [(_SHARES[name], _mcnemar_of(name)) for name in _SHARES]
    measures: list[Column] = [(f"{_UNITS[name][0]} [{_UNITS[name][1]}]", _difference_of(name)) for name in _UNITS]
    sheets = (
        _sheet("A, B, and McNemar's exact p (pairs that only A, only B reached)", shares, cells),
        _sheet("Median of B - A over pairs with contact (95 % bootstrap interval)", measures, cells),
    )
    print_sheets(sheets, out)
    console = open_console(out)
    for difference in comparison["differences"]:
        console.print(f"{difference['key']}: {difference['a']} | {difference['b']}", markup=False, soft_wrap=True)
    unpaired = comparison["unpaired"]
    if unpaired["a"] or unpaired["b"]:
        console.print(f"without a pair: {unpaired['a']} of A, {unpaired['b']} of B")


def _time_of(table: str, name: str) -> Callable[[Cell], str]:
    return lambda cell: "-" if cell[table][name] is None else f"{cell[table][name]:.2f}"


_COMPUTING: tuple[Column, ...] = (
    *((f"planner {name} [ms]", _time_of("planner_ms", name)) for name in ("median", "p99", "max")),
    ("wall [s]", _time_of("computing", "wall_s")),
    ("CPU [s]", _time_of("computing", "cpu_s")),
)

_HEAD = ("cell", "firmware")
_CONTACT_TITLE = "At contact (median, 95th percentile; tilt over trim), and the estimate's error in the descent"
_WHY = "Why approaches were broken off or began again, and why nothing landed"
_REASONS = {
    "aborts_by_reason": "broken off by",
    "begun_anew_by_reason": "began again for",
    "not_landed_by_reason": "not landed for",
}

_SHARES = {"s1_or_better": "S1 or better", "s2_quality": "S2 quality", "unsafe": "unsafe"}


def _sheet(title: str, columns: Sequence[Column], cells: Sequence[Cell]) -> Sheet:
    """Return a row a cell."""
    rows = tuple(
        (without_firmware(cell["cell"]), cell["firmware"], *(text(cell) for _, text in columns)) for cell in cells
    )
    return Sheet(title=title, head=(*_HEAD, *(heading for heading, _ in columns)), rows=rows, texts=len(_HEAD))


def _reasons_sheet(cells: Sequence[Cell]) -> list[Sheet]:
    """Return why approaches and landings failed, cell by cell and together; nothing where none did."""
    total = {name: add_counts(cell[name] for cell in cells) for name in _REASONS}
    if not any(total.values()):
        return []
    told = [cell for cell in cells if any(cell[name] for name in _REASONS)]
    if len(cells) > 1:
        firmware = firmware_text([cell["firmware"] for cell in cells])
        approaches = sum(cell["approaches"] for cell in cells)
        told.append({"cell": "all", "firmware": firmware, "approaches": approaches} | total)
    head = (*_HEAD, "approaches", *_REASONS.values())
    rows = tuple(
        (
            without_firmware(cell["cell"]),
            cell["firmware"],
            str(cell["approaches"]),
            *(counts_text(cell[name]) or "-" for name in _REASONS),
        )
        for cell in told
    )
    return [Sheet(title=_WHY, head=head, rows=rows, texts=len(head))]


def _tier_column(tier: Tier) -> Column:
    return tier.value, lambda cell: str(cell["tiers"][tier.value])


def _count_of(name: str) -> Callable[[Cell], str]:
    return lambda cell: str(cell[name])


def _share_of(name: str) -> Callable[[Cell], str]:
    def text(cell: Cell) -> str:
        share = cell[name]
        return f"{100.0 * share['share']:.1f} ({100.0 * share['low']:.1f} to {100.0 * share['high']:.1f})"

    return text


def _measure_of(name: str) -> Callable[[Cell], str]:
    def text(cell: Cell) -> str:
        return f"{_number(name, cell[name]['median'])}  {_number(name, cell[name]['p95'])}"

    return text


def _band_of(name: str) -> Callable[[Cell], str]:
    def text(cell: Cell) -> str:
        found = cell[name]
        return "-" if found["mean"] is None else banded(found["mean"], found["low"], found["high"])

    return text


def _mcnemar_of(name: str) -> Callable[[Cell], str]:
    def text(cell: Cell) -> str:
        found = cell[name]
        return f"{found['a']:.1%}  {found['b']:.1%}  p={found['p']:.2g} ({found['only_a']}, {found['only_b']})"

    return text


def _difference_of(name: str) -> Callable[[Cell], str]:
    def text(cell: Cell) -> str:
        found = cell[name]
        low, high = _number(name, found["low"]), _number(name, found["high"])
        return f"{_number(name, found['difference'])} ({low} to {high})"

    return text


def _number(name: str, value: float | None) -> str:
    _, _, factor, digits = _UNITS[name]
    return "-" if value is None else f"{value * factor:.{digits}f}"
