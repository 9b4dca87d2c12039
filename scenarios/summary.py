"""A campaign's rows by cell: tiers, shares with their intervals, and what the contacts were like."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from scenarios.intervals import Interval, wilson
from scenarios.landing_task import Row
from scenarios.outcome import LANDED
from scenarios.score import Tier

MEASURES = (
    "horizontal_error_m",
    "relative_speed_m_s",
    "sink_rate_m_s",
    "tilt_over_trim_rad",
    "time_to_contact_s",
)
"""What is summed up over all first contacts, wherever on the vehicle."""

_LANDED = frozenset(tier.value for tier in LANDED)
_DIGITS = 6


def is_s1_or_better(row: Row) -> bool:
    """Return whether the landing reached S1, S2 or S3; one without a result did not."""
    return row.get("tier") in _LANDED


def is_s2_quality(row: Row) -> bool:
    """Return whether the landing's contact was within the limits of S2, secured or not."""
    return bool(row.get("s2_quality"))


def summarize(rows: Iterable[Row]) -> dict[str, Any]:
    """Return the summary of a campaign, in the order of its cells, as plain values for JSON."""
    cells: dict[str, list[Row]] = {}
    for row in rows:
        cells.setdefault(row["cell"], []).append(row)
    return {"cells": [_summary_of(cell, cells[cell]) for cell in sorted(cells)]}


def _summary_of(cell: str, rows: Sequence[Row]) -> dict[str, Any]:
    tiers = [row.get("tier") for row in rows]
    measures = {name: _median_and_p95(row.get(name) for row in rows) for name in MEASURES}
    return {
        "cell": cell,
        "seeds": len(rows),
        "tiers": {tier.value: tiers.count(tier.value) for tier in Tier},
        **measures,
        "s1_or_better": share_json(sum(map(is_s1_or_better, rows)), len(rows)),
        "s2_quality": share_json(sum(map(is_s2_quality, rows)), len(rows)),
        "unsafe": share_json(tiers.count(Tier.UNSAFE.value), len(rows)),
        "contacts": sum(row.get("horizontal_error_m") is not None for row in rows),
        "aborts": sum(row.get("aborts") or 0 for row in rows),
        "retries": sum(row.get("retries") or 0 for row in rows),
        "errors": sum(row["error"] is not None for row in rows),
    }


def share_json(successes: int, trials: int) -> dict[str, float]:
    """Return a share with its 95 % interval as plain values."""
    return interval_json("share", wilson(successes, trials))


def interval_json(name: str, interval: Interval) -> dict[str, float]:
    """Return an estimate called `name` with its interval as plain values."""
    values = {name: interval.value, "low": interval.low, "high": interval.high}
    return {key: round(value, _DIGITS) for key, value in values.items()}


def _median_and_p95(values: Iterable[float | None]) -> dict[str, float | None]:
    known = [value for value in values if value is not None]
    if not known:
        return {"median": None, "p95": None}
    median, p95 = np.quantile(known, [0.5, 0.95])
    return {"median": round(float(median), _DIGITS), "p95": round(float(p95), _DIGITS)}
