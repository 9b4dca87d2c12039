"""Two campaigns on the same cells and seeds: whether one lands better than the other, and by how much."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from link.errors import UserError
from scenarios.campaigns.folder import read_landings, read_plan
from scenarios.campaigns.intervals import mcnemar_p, median_difference
from scenarios.campaigns.landing_task import Row
from scenarios.campaigns.summary import MEASURES, interval_json, is_s1_or_better, is_s2_quality, is_unsafe
from scenarios.catalogue.firmware_option import firmware_text

_DIGITS = 6
_SHARES = {"s1_or_better": is_s1_or_better, "s2_quality": is_s2_quality, "unsafe": is_unsafe}

Pair = tuple[Row, Row]


def compare_campaigns(first: Path, second: Path, apart_from: str | None = None) -> dict[str, Any]:
    """Return the comparison of the campaigns in two folders, as plain values for JSON.

    Args:
        first: folder of A.
        second: folder of B.
        apart_from: an option of the cells in which A and B may differ, such as `system`.

    Raises:
        UserError: a folder holds no campaign, they have no landing in common, no cell has `apart_from`, or two cells
            of one of them differ in nothing else.
    """
    rows = read_landings(first), read_landings(second)
    differences = list(
        differences_of(read_plan(first).model_dump(mode="json"), read_plan(second).model_dump(mode="json"))
    )
    return {**compare_rows(*rows, apart_from), "differences": differences}


def compare_rows(first: Sequence[Row], second: Sequence[Row], apart_from: str | None = None) -> dict[str, Any]:
    """Return the comparison of rows, paired by cell and seed; what has no pair is counted and left out.

    Where there are several cells, `together` compares all their pairs.

    Raises:
        UserError: there is no pair, no cell has `apart_from`, or two of one campaign differ in nothing else.
    """
    _check_option(apart_from, [row["cell"] for row in (*first, *second)])
    names, other_names = _names(first, apart_from), _names(second, apart_from)
    others = {(other_names[row["cell"]], row["seed"]): row for row in second}
    pairs: dict[str, list[Pair]] = {}
    for row in first:
        cell = names[row["cell"]]
        other = others.get((cell, row["seed"]))
        if other is not None:
            pairs.setdefault(cell, []).append((row, other))
    if not pairs:
        raise UserError("the campaigns have no cell and seed in common")
    count = sum(map(len, pairs.values()))
    unpaired = {"a": len(first) - count, "b": len(second) - count}
    cells = [_comparison(cell, pairs[cell]) for cell in sorted(pairs)]
    if len(pairs) > 1:
        cells.append(_comparison("together", [pair for cell in sorted(pairs) for pair in pairs[cell]]))
    return {"cells": cells, "unpaired": unpaired}


def _check_option(option: str | None, cells: Sequence[str]) -> None:
    if option is None or any(_without(cell, option) != cell for cell in cells):
        return
    named = sorted({part.partition("=")[0] for cell in cells for part in cell.split("+")[1:]})
    what = f"give one of {', '.join(named)}, or leave it out" if named else "leave it out"
    raise UserError(f"--apart-from {option}: no cell of these campaigns has it behind its name; {what}")


def _names(rows: Sequence[Row], apart_from: str | None) -> dict[str, str]:
    """Return under which name each cell of a campaign is compared.

    Raises:
        UserError: two have the same name, and which of them is meant is not known.
    """
    cells = sorted({row["cell"] for row in rows})
    names = {cell: _without(cell, apart_from) for cell in cells}
    for first, second in combinations(cells, 2):
        if names[first] == names[second]:
            raise UserError(
                f"--apart-from {apart_from}: {first} and {second} of one campaign differ in nothing else; "
                "compare campaigns in which each cell stands once"
            )
    return names


def _without(cell: str, option: str | None) -> str:
    """Return a cell's name without one of its options."""
    return "+".join(part for part in cell.split("+") if option is None or not part.startswith(f"{option}="))


def differences_of(first: object, second: object, key: str = "") -> Iterator[dict[str, Any]]:
    """Yield each key whose value differs between two tables, with both; None where there is none."""
    if isinstance(first, Mapping) and isinstance(second, Mapping):
        for name in sorted({*first, *second}):
            yield from differences_of(first.get(name), second.get(name), f"{key}.{name}" if key else str(name))
    elif first != second:
        yield {"key": key, "a": first, "b": second}


def _comparison(cell: str, pairs: Sequence[Pair]) -> dict[str, Any]:
    shares = {
        name: _share_comparison([(reached(a), reached(b)) for a, b in pairs]) for name, reached in _SHARES.items()
    }
    return {
        "cell": cell,
        "firmware": _firmware(pairs),
        "pairs": len(pairs),
        **shares,
        **{name: _measure_comparison(name, pairs) for name in MEASURES},
    }


def _firmware(pairs: Sequence[Pair]) -> str:
    """Return the firmware of the pairs, that of A and that of B where they differ."""
    first, second = (firmware_text([pair[side]["firmware"] for pair in pairs]) for side in (0, 1))
    return first if first == second else f"{first} | {second}"


def _share_comparison(pairs: Sequence[tuple[bool, bool]]) -> dict[str, float | int]:
    only_a = sum(a and not b for a, b in pairs)
    only_b = sum(b and not a for a, b in pairs)
    return {
        "a": round(sum(a for a, _ in pairs) / len(pairs), _DIGITS),
        "b": round(sum(b for _, b in pairs) / len(pairs), _DIGITS),
        "only_a": only_a,
        "only_b": only_b,
        "p": mcnemar_p(only_a, only_b),
    }


def _measure_comparison(name: str, pairs: Sequence[Pair]) -> dict[str, float | int | None]:
    """Return medians and the median of B minus A, over the pairs in which both made contact."""
    both = [(a[name], b[name]) for a, b in pairs if a.get(name) is not None and b.get(name) is not None]
    if not both:
        return {"pairs": 0, **dict.fromkeys(("a", "b", "difference", "low", "high"))}
    first, second = [a for a, _ in both], [b for _, b in both]
    medians = {key: round(float(np.median(values)), _DIGITS) for key, values in (("a", first), ("b", second))}
    return {"pairs": len(both), **medians, **interval_json("difference", median_difference(first, second))}
