"""How often each reason was the one: of approaches, as a table and as one text."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from companion.situation.phases import Phase

Approaches = Sequence[Mapping[str, Any]]
"""As `result.json` has them."""


def abort_reasons(approaches: Approaches) -> list[str]:
    """Return the names of the reasons for which approaches were broken off, in their order."""
    return [one["reason_code"] for one in approaches if one["ended"] == Phase.ABORT.value]


def anew_reasons(approaches: Approaches) -> list[str]:
    """Return the names of the reasons for which approaches went back to be aligned or chased again, in their order."""
    return [anew["reason_code"] for one in approaches for anew in one["begun_anew"]]


def counts_of(reasons: Iterable[str]) -> dict[str, int]:
    """Return how often each is there, the most frequent first."""
    return dict(sorted(Counter(reasons).items(), key=lambda one: (-one[1], one[0])))


def add_counts(several: Iterable[Mapping[str, int]]) -> dict[str, int]:
    """Return the sum of counts."""
    return counts_of(reason for counts in several for reason in Counter(counts).elements())


def counts_text(counts: Mapping[str, int]) -> str:
    """Return counts as one text, such as `SETPOINT_NOT_FOLLOWED 2, STRAYS 1`; nothing is an empty one."""
    return ", ".join(f"{reason} {count}" for reason, count in counts.items())


def reasons_in(text: str) -> list[str]:
    """Return each reason of a text of counts as often as it says."""
    parts = [part.rpartition(" ") for part in text.split(", ") if part]
    return [reason for reason, _, count in parts for _ in range(int(count))]
