"""What a campaign says of a population of worlds: tiers, over what they fail, why by truth, and the worst."""

from collections.abc import Mapping, Sequence
from typing import Any

from scenarios.campaigns.causes import causes, events_before, outcome
from scenarios.campaigns.cells import WORLD_COLUMN, Population
from scenarios.campaigns.contrasts import contrasts
from scenarios.campaigns.intervals import mcnemar_p
from scenarios.campaigns.landing_task import Row
from scenarios.campaigns.summary import is_given_up, is_s1_or_better, is_unsafe
from scenarios.campaigns.tier_rates import binned, grouped, tier_rates
from scenarios.config import FIRMWARES
from scenarios.scoring.score import Tier

QUANTITIES = (
    "world.drive.cruise_m_s",
    "vehicle_speed_m_s",
    "world.drive.curvature_max_per_m",
    "vehicle_curvature_per_m",
    "data_age_s",
    "wind_mean_m_s",
    "pad_side_m",
)
"""Over which the rates are shown: of the drive as a whole, at the instant of the contact, and of the conditions."""

_WORST = 10
_KINDS_MAX = 8  # values of a drawn choice that is shown
_FIRMWARE = "world.drone.firmware"  # shown by itself


def worlds_report(rows: Sequence[Row], populations: Mapping[str, Population]) -> list[dict[str, Any]]:
    """Return one report for each slice, over all of its cells, in the order of the cells.

    Args:
        rows: of the campaign.
        populations: by the names of their cells.
    """
    slices = dict.fromkeys(one.slice for one in populations.values())
    reports = []
    for name in slices:
        cells = {cell: one for cell, one in populations.items() if one.slice == name}
        flown = [row for row in rows if row["cell"] in cells]
        if flown:
            reports.append(_report(name, flown, cells))
    return reports


def _report(name: str, rows: Sequence[Row], cells: Mapping[str, Population]) -> dict[str, Any]:
    def name_of(row: Row) -> str:
        return cells[row["cell"]].world_name(row["seed"])

    return {
        "worlds": name,
        "overall": tier_rates(rows),
        "by_firmware": grouped(rows, "firmware"),
        "pairs": _pairs(rows, cells),
        "by": {column: grouped(rows, column) for column in _choices(rows)},
        "over": {column: bins for column in QUANTITIES if (bins := binned(rows, column))},
        "causes": causes(rows, name_of),
        "contrasts": {
            "unsafe": contrasts(rows, [row for row in rows if is_unsafe(row)]),
            "given_up": contrasts(rows, [row for row in rows if is_given_up(row)]),
        },
        "worst": [_told(row, name_of(row)) for row in _worst(rows)],
        "configured": any(one.companion for one in cells.values()),
    }


def _choices(rows: Sequence[Row]) -> list[str]:
    """Return the columns of what worlds draw as one of a few words."""
    names = sorted({name for row in rows for name in row if name.startswith(WORLD_COLUMN) and name != _FIRMWARE})
    kinds = {name: {row.get(name) for row in rows} - {None} for name in names}
    return [name for name, found in kinds.items() if 1 < len(found) <= _KINDS_MAX and _are_words(found)]


def _are_words(values: set[Any]) -> bool:
    return all(isinstance(value, str) for value in values)


def _pairs(rows: Sequence[Row], cells: Mapping[str, Population]) -> dict[str, Any] | None:
    """Return the comparison of worlds that were flown with both firmwares, None where none was."""
    chosen = {cell: one.firmware for cell, one in cells.items()}
    first, second = ({row["seed"]: row for row in rows if chosen[row["cell"]] == firmware} for firmware in FIRMWARES)
    both = [(row, second[seed]) for seed, row in first.items() if seed in second]
    if not both:
        return None
    counts: dict[str, Any] = {"pairs": len(both)}
    for name, reached in (("s1_or_better", is_s1_or_better), ("unsafe", is_unsafe)):
        only = [sum(reached(a) and not reached(b) for a, b in pairs) for pairs in (both, [pair[::-1] for pair in both])]
        counts[name] = {f"only_{one}": count for one, count in zip(FIRMWARES, only, strict=True)} | {
            "p": mcnemar_p(*only)
        }
    return counts


_ORDER = [tier.value for tier in Tier]


def _worst(rows: Sequence[Row]) -> list[Row]:
    """Return the landings with the least margin; of rows without one, those of the worst tier."""
    known = [row for row in rows if row.get("tier") is not None]

    def key(row: Row) -> tuple[float, int, str, int]:
        margin = row.get("margin")
        return (float("inf") if margin is None else margin, -_ORDER.index(row["tier"]), row["cell"], row["seed"])

    return sorted(known, key=key)[:_WORST]


def _told(row: Row, name: str) -> dict[str, Any]:
    """Return what is said of one of the worst landings; one that landed has no outcome but its tier."""
    return {
        "world": name,
        "command": f"scenarios run {name} --lockstep",
        "firmware": row["firmware"],
        "tier": row["tier"],
        "margin": row.get("margin"),
        "outcome": row["reason"] if is_s1_or_better(row) else outcome(row),
        "before": events_before(row),
    }
