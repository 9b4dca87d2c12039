"""What of many things is needed for a failure: delta debugging by taking away halves, quarters and so on.

Source: Zeller and Hildebrandt, Simplifying and Isolating Failure-Inducing Input, IEEE TSE 28(2), 2002. Only complements
are tried, since a failure of a landing needs several things at once more often than one.
"""

from collections.abc import Callable, Sequence
from typing import TypeVar

_BATCH = 4  # tried at once, on however many processes, so that their number does not show in the result

Item = TypeVar("Item")


def minimal(items: Sequence[Item], still_fails: Callable[[Sequence[list[Item]]], Sequence[bool]]) -> list[Item]:
    """Return a part of `items` that still fails, of which no single one can be left out.

    Args:
        items: which fail together.
        still_fails: says of each of some selections, in the items' order, whether it fails; only the first that does
            is looked at.
    """
    kept = list(items)
    size = len(kept)
    while size >= 1:
        fewer = _without_chunks(kept, size, still_fails)
        size = size // 2 if size > 1 else int(len(fewer) < len(kept))
        kept = fewer
    return kept


def _without_chunks(
    items: list[Item], size: int, still_fails: Callable[[Sequence[list[Item]]], Sequence[bool]]
) -> list[Item]:
    """Return `items` without the chunks of `size` that are not needed, tried from the first to the last."""
    kept, begin = items, 0
    while begin < len(kept):
        begins = list(range(begin, len(kept), size))[:_BATCH]
        selections = [kept[:first] + kept[first + size :] for first in begins]
        answers = list(still_fails(selections))
        if True in answers:
            hit = answers.index(True)
            kept, begin = selections[hit], begins[hit]
        else:
            begin = begins[-1] + size
    return kept
