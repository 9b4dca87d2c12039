"""A campaign's rows by cell: tiers, shares with their intervals, and what the contacts were like."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from scenarios.campaigns.intervals import Interval, mean_band, wilson
from scenarios.campaigns.landing_task import Row
from scenarios.catalogue.firmware_option import firmware_text, side_by_side
from scenarios.recordings.reason_counts import counts_of, reasons_in
from scenarios.recordings.result import LANDED
from scenarios.scoring.accuracy import NEES_DOF
from scenarios.scoring.score import Tier

MEASURES = (
    "horizontal_error_m",
    "relative_speed_m_s",
    "sink_rate_m_s",
    "tilt_over_trim_rad",
    "time_to_contact_s",
    "tilt_rad",
    "position_rmse_m",
    "velocity_rmse_m_s",
    "pass_to_contact_s",
)
"""What is summed up over all first contacts, wherever on the vehicle; the estimator's errors over all descents."""

_TIMES: dict[str, Callable[[Sequence[float]], Any]] = {"median": np.median, "p99": np.median, "max": max}
"""Of each of the planner's quantiles in a landing: what of it stands for the cell."""

_COMPUTING = ("wall_s", "cpu_s")

_LANDED = frozenset(tier.value for tier in LANDED)
_DIGITS = 6


def is_s1_or_better(row: Row) -> bool:
    """Return whether the landing reached S1, S2 or S3; one without a result did not."""
    return row.get("tier") in _LANDED


def is_s2_quality(row: Row) -> bool:
    """Return whether the landing's contact was within the limits of S2, secured or not."""
    return bool(row.get("s2_quality"))


def is_unsafe(row: Row) -> bool:
    """Return whether the run was unsafe; one without a result is not known to have been."""
    return row.get("tier") == Tier.UNSAFE.value


def is_given_up(row: Row) -> bool:
    """Return whether the landing was given up, in good order."""
    return row.get("tier") == Tier.ABORT.value


def summarize(rows: Iterable[Row], times: Iterable[Row] = ()) -> dict[str, Any]:
    """Return the summary of a campaign, in the order of its cells with both firmwares of one side by side, for JSON.

    Args:
        rows: the landings.
        times: what they took to compute, where that is known.
    """
    cells, timing = _by_cell(rows), _by_cell(times)
    ordered = sorted(cells, key=lambda cell: side_by_side(cell, _firmware(cells[cell])))
    return {
        "cells": [_summary_of(cell, cells[cell]) | _timing_of(timing.get(cell, ())) for cell in ordered],
    }


def _by_cell(rows: Iterable[Row]) -> dict[str, list[Row]]:
    cells: dict[str, list[Row]] = {}
    for row in rows:
        cells.setdefault(row["cell"], []).append(row)
    return cells


def _summary_of(cell: str, rows: Sequence[Row]) -> dict[str, Any]:
    tiers = [row.get("tier") for row in rows]
    measures = {name: _median_and_p95(row.get(name) for row in rows) for name in MEASURES}
    return {
        "cell": cell,
        "seeds": len(rows),
        "tiers": {tier.value: tiers.count(tier.value) for tier in Tier},
        **measures,
        "firmware": _firmware(rows),
        "s1_or_better": share_json(sum(map(is_s1_or_better, rows)), len(rows)),
        "s2_quality": share_json(sum(map(is_s2_quality, rows)), len(rows)),
        "unsafe": share_json(sum(map(is_unsafe, rows)), len(rows)),
        "contacts": sum(row.get("horizontal_error_m") is not None for row in rows),
        "aborts": sum(row.get("aborts") or 0 for row in rows),
        "retries": sum(row.get("retries") or 0 for row in rows),
        "errors": sum(row["error"] is not None for row in rows),
        "approaches": sum(row.get("approaches") or 0 for row in rows),
        "aborts_by_reason": _reasons(rows, "aborts_by_reason"),
        "begun_anew_by_reason": _reasons(rows, "begun_anew_by_reason"),
        "not_landed_by_reason": counts_of(
            row["ended_reason_code"] for row in rows if not is_s1_or_better(row) and row.get("ended_reason_code")
        ),
        "nees": _nees(rows),
        "nis_per_dof": _nis(rows),
    }


def _firmware(rows: Sequence[Row]) -> str:
    """Return the firmware of a cell, or both of one that is flown with both."""
    return firmware_text([row["firmware"] for row in rows])


def _reasons(rows: Iterable[Row], name: str) -> dict[str, int]:
    """Return the sum of a column's counts by reason."""
    return counts_of(reason for row in rows for reason in reasons_in(row.get(name) or ""))


def _nees(rows: Sequence[Row]) -> dict[str, float | int | None]:
    """Return the mean over runs of their mean NEES, with the 95 % band of so many independent runs.

    Within a run the errors are alike, so a run counts once, and the band is wider than need be.
    """
    means = [row["nees_mean"] for row in rows if row.get("nees_mean") is not None]
    low, high = mean_band(NEES_DOF * len(means))
    return {
        "mean": round(float(np.mean(means)), _DIGITS) if means else None,
        "low": None if low is None else round(NEES_DOF * low, _DIGITS),
        "high": None if high is None else round(NEES_DOF * high, _DIGITS),
        "dof": NEES_DOF,
        "runs": len(means),
    }


def _nis(rows: Sequence[Row]) -> dict[str, float | int | None]:
    """Return the NIS of all accepted measurements per degree of freedom, with its 95 % band."""
    known = [row for row in rows if row.get("nis_dof")]
    dof = sum(row["nis_dof"] for row in known)
    low, high = mean_band(dof)
    return {
        "mean": round(sum(row["nis_sum"] for row in known) / dof, _DIGITS) if dof else None,
        "low": None if low is None else round(low, _DIGITS),
        "high": None if high is None else round(high, _DIGITS),
        "dof": dof,
    }


def _timing_of(times: Sequence[Row]) -> dict[str, Any]:
    """Return what a cell's landings took to compute, nothing where that is not known."""
    if not times:
        return {}
    planner_ms = {name: _over(whole, times, f"planner_{name}_ms") for name, whole in _TIMES.items()}
    return {"planner_ms": planner_ms, "computing": {name: _over(np.median, times, name) for name in _COMPUTING}}


def _over(whole: Callable[[Sequence[float]], Any], rows: Sequence[Row], name: str) -> float | None:
    known = [row[name] for row in rows if row.get(name) is not None]
    return round(float(whole(known)), _DIGITS) if known else None


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
