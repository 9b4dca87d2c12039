"""Two lists of messages compared, field by field."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from link.payloads.decklander_msgs import RosMessage, fields_of


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldDifference:
    """A field that is not the same in all messages of a topic.

    Attributes:
        field: topic and path, such as `setpoint.position_m[0]`.
        largest: difference of two numbers, infinite where one is missing or a text differs.
        count: of the messages in which it differs.
        first: index of the first of these.
    """

    field: str
    largest: float
    count: int
    first: int


class Comparison:
    """Collects the differences between two lists of messages, topic by topic."""

    def __init__(self) -> None:
        self.fields = 0
        self._found: dict[str, FieldDifference] = {}

    def compare(self, name: str, recorded: list[RosMessage], flown: list[RosMessage]) -> None:
        """Compare the messages of a topic in their order; a message too many is a difference, too."""
        for index, (one, other) in enumerate(zip(recorded, flown, strict=False)):
            before = fields_of(one.payload, one.type_name)
            self.fields += len(before)
            if one.payload != other.payload:
                self._compare_fields(name, index, before, fields_of(other.payload, other.type_name))
        if len(recorded) != len(flown):
            self._add(f"{name} (messages)", abs(len(recorded) - len(flown)), min(len(recorded), len(flown)))

    def differences(self) -> tuple[FieldDifference, ...]:
        """Return what was found, largest first."""
        return tuple(sorted(self._found.values(), key=lambda one: (-one.largest, one.field)))

    def _compare_fields(self, name: str, index: int, one: dict[str, Any], other: dict[str, Any]) -> None:
        for path in {**one, **other}:
            size = _difference(one.get(path), other.get(path))
            if size:
                self._add(f"{name}.{path}", size, index)

    def _add(self, field: str, size: float, index: int) -> None:
        known = self._found.get(field, FieldDifference(field=field, largest=0.0, count=0, first=index))
        self._found[field] = FieldDifference(
            field=field, largest=max(known.largest, size), count=known.count + 1, first=known.first
        )


def _difference(one: Any, other: Any) -> float:
    """Return by how much two values of a field differ."""
    if isinstance(one, str | list) or isinstance(other, str | list) or one is None or other is None:
        return 0.0 if one == other else math.inf
    left, right = np.asarray(one, dtype=np.float64), np.asarray(other, dtype=np.float64)
    if left.shape != right.shape:
        return math.inf
    if left.size == 0 or np.array_equal(one, other):
        return 0.0
    return float(np.max(np.abs(left - right))) or math.ulp(0.0)
