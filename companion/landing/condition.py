"""A condition of a step's facts with the time that it must hold before it counts; pure."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from companion.config.companion import CompanionConfig
from companion.situation.phases import Phase
from companion.situation.situation import Approach, Situation

Held = Mapping[str, int]
"""Since when (UTC ns) each test has been true, by its name."""


@dataclass(frozen=True, slots=True)
class Test:
    """A condition with the time it must hold without a break before it counts."""

    reason: str
    phases: frozenset[Phase]
    is_true: Callable[[Situation, Approach | None, CompanionConfig], bool]
    hold_s: Callable[[CompanionConfig], float]


def holds(test: Test, held: Held, t_ns: int, config: CompanionConfig) -> bool:
    """Return whether a test has been true for its hold time."""
    since_ns = held.get(test.reason)
    return since_ns is not None and (t_ns - since_ns) * 1e-9 >= test.hold_s(config)
