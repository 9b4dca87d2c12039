"""What of a run its figures show, and the quantities that several of them draw."""

import textwrap

import numpy as np
from numpy.typing import NDArray

from scenarios.reports.run_data import PhaseSpan, RunData

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
FLOWN = ("chase", "align", "descend", "touchdown", "abort")
"""The phases of a landing."""

AXIS_MIN_M = 4.0
"""An axis in space is never shorter: a vehicle's length."""

_TITLE_COLUMNS = 44
_BEFORE_S = 3.0  # of the wait before the chase that is shown


def landing_window(run: RunData) -> tuple[float, float]:
    """Return from when to when the landing is shown: from shortly before the first chase to the end.

    A truth that was broken off before that is shown from its beginning.
    """
    end_s = float(run.t_s[-1])
    flown = [span.from_s for span in run.phases if span.phase in FLOWN]
    from_s = max((min(flown) if flown else 0.0) - _BEFORE_S, 0.0)
    return (from_s if from_s < end_s else 0.0), end_s


def heights(run: RunData) -> Array:
    """Return the height of the drone's feet above the pad, (n,)."""
    gear_m = run.config.touchdown.gear_height_m
    return np.asarray(run.log.position_v_m[:, 2] - run.scenario.vehicle.roof_height_m - gear_m)


def distances(run: RunData) -> Array:
    """Return the horizontal distance from the pad's centre, (n,)."""
    return np.hypot(run.log.position_v_m[:, 0], run.log.position_v_m[:, 1])


def title(run: RunData) -> str:
    """Return what stands above a figure, in lines that fit the narrowest."""
    told = f"{run.result['scenario']}, {run.scenario.firmware}, seed {run.result['seed']}: {run.result['tier']}"
    lines = textwrap.wrap(told.replace("+", " +"), _TITLE_COLUMNS)
    return "\n".join(line.replace(" +", "+") for line in lines)


def shown_spans(run: RunData) -> list[PhaseSpan]:
    """Return the phases that are shown."""
    from_s, _ = landing_window(run)
    return [span for span in run.phases if span.to_s > from_s]


def is_shown(run: RunData) -> Flags:
    """Return which samples are shown, (n,)."""
    return np.asarray(run.t_s >= landing_window(run)[0])


def is_during(run: RunData, phase: str) -> Flags:
    """Return which samples fall into a phase, (n,)."""
    inside = np.zeros(len(run.t_s), dtype=bool)
    for span in run.phases:
        if span.phase == phase:
            inside |= (run.t_s >= span.from_s) & (run.t_s < span.to_s)
    return inside


def contact_index(run: RunData) -> int | None:
    """Return the sample of the first contact, None without one, or where the recording was broken off before it."""
    contact_s = run.result.get("contact_s")
    return None if contact_s is None or contact_s > run.t_s[-1] else int(np.searchsorted(run.t_s, contact_s))
