"""The rate of each tier with its 95 % interval: of some landings, and of them in bins of what they were flown under."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from scenarios.campaigns.landing_task import Row
from scenarios.campaigns.summary import share_json
from scenarios.scoring.score import Tier

_BINS_MAX = 5
_IN_BIN_MIN = 20  # of fewer, a rate's interval is wider than 40 %
_DIGITS = 6


def tier_rates(rows: Sequence[Row]) -> dict[str, Any]:
    """Return how many of some landings reached each tier, at least one landing; an error reached none."""
    tiers = [row.get("tier") for row in rows]
    counts = {tier.value: tiers.count(tier.value) for tier in Tier}
    return {
        "landings": len(rows),
        "errors": sum(row["error"] is not None for row in rows),
        "tiers": {tier: {"count": count, **share_json(count, len(rows))} for tier, count in counts.items()},
    }


def binned(rows: Sequence[Row], column: str) -> list[dict[str, Any]]:
    """Return the rates in bins of a column of numbers, with as many landings in each as there can be.

    Landings without a value are left out. A bin goes from `low` up to but not including `high`, the last one including
    it. Few landings make fewer bins, and so do values that many of them have.
    """
    known = [row for row in rows if row.get(column) is not None]
    if not known:
        return []
    values = np.array([float(row[column]) for row in known])
    bins = max(1, min(_BINS_MAX, len(values) // _IN_BIN_MIN))
    edges = np.unique(np.quantile(values, np.linspace(0.0, 1.0, bins + 1)))
    places = np.clip(np.searchsorted(edges, values, side="right") - 1, 0, max(0, len(edges) - 2))
    found = []
    for place in range(max(1, len(edges) - 1)):
        inside = [row for row, at in zip(known, places, strict=True) if at == place]
        bounds = {
            "low": round(float(edges[place]), _DIGITS),
            "high": round(float(edges[min(place + 1, len(edges) - 1)]), _DIGITS),
        }
        if inside:
            found.append(bounds | tier_rates(inside))
    return found


def grouped(rows: Sequence[Row], column: str) -> dict[str, dict[str, Any]]:
    """Return the rates by the value of a column of texts, in their order; landings without one are left out."""
    values = sorted({str(row[column]) for row in rows if row.get(column) is not None})
    return {value: tier_rates([row for row in rows if row.get(column) == value]) for value in values}
