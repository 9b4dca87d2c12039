"""Which drawn numbers differ between the worlds that failed and those that landed."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from scenarios.campaigns.cells import WORLD_COLUMN
from scenarios.campaigns.intervals import rank_contrast
from scenarios.campaigns.landing_task import Row
from scenarios.campaigns.summary import is_s1_or_better

_SHOWN = 10
_P_MAX = 0.05  # by Holm over all columns: the chance that any is named though none differs
_DIGITS = 6
_EACH_MIN = 5  # of fewer, no order of ranks says anything at that level once a hundred columns are asked


def contrasts(rows: Sequence[Row], failed: Sequence[Row]) -> list[dict[str, Any]]:
    """Return the drawn numbers by which `failed` differ from the landings that went well, the clearest first.

    `above` is how often a failed world has the larger number; p is corrected for all columns that were asked (Holm,
    Scand. J. Statist. 6 (1979) 65). What goes with something else is named as well: it is no proof of a cause.

    Args:
        rows: all landings.
        failed: some of them.
    """
    landed = [row for row in rows if is_s1_or_better(row)]
    found = [one for name in _numbers(rows) if (one := _contrast(name, failed, landed)) is not None]
    found.sort(key=lambda one: one["p"])
    worst = 0.0
    for place, one in enumerate(found):
        worst = max(worst, min(1.0, one["p"] * (len(found) - place)))
        one["p"] = worst
    return [one for one in found if one["p"] < _P_MAX][:_SHOWN]


def _numbers(rows: Sequence[Row]) -> list[str]:
    """Return the names of what worlds draw as numbers, or as yes or no."""
    names = sorted({name for row in rows for name in row if name.startswith(WORLD_COLUMN)})
    return [name for name in names if not any(isinstance(row.get(name), str) for row in rows)]


def _contrast(name: str, failed: Sequence[Row], landed: Sequence[Row]) -> dict[str, Any] | None:
    """Return how a column differs, None where too few have it or all have the same."""
    groups = [[float(row[name]) for row in some if row.get(name) is not None] for some in (failed, landed)]
    if min(map(len, groups)) < _EACH_MIN or len({value for group in groups for value in group}) < 2:
        return None
    above, p = rank_contrast(*groups)
    medians = [round(float(np.median(group)), _DIGITS) for group in groups]
    return {"column": name, "failed": medians[0], "landed": medians[1], "above": round(above, _DIGITS), "p": p}
