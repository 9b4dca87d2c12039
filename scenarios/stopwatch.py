"""How long the steps of a run in this process take: a stopwatch around functions, where their callers find them."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from types import ModuleType
from typing import Any

import companion.node
import sim_autopilot.node

_STEPS: Mapping[str, ModuleType] = {"autopilot_step": sim_autopilot.node, "companion_step": companion.node}
"""The two steps of a run, by the module that calls each."""

_DIGITS = 4  # of milliseconds, a tenth of a microsecond


@contextmanager
def timed_steps() -> Iterator[dict[str, list[float]]]:
    """Measure the steps inside the block; give their durations in seconds, by name, as they come."""
    durations_s: dict[str, list[float]] = {name: [] for name in _STEPS}
    plain = {name: getattr(module, name) for name, module in _STEPS.items()}
    try:
        for name, module in _STEPS.items():
            setattr(module, name, _timed(plain[name], durations_s[name]))
        yield durations_s
    finally:
        for name, module in _STEPS.items():
            setattr(module, name, plain[name])


def _timed(function: Callable[..., Any], durations_s: list[float]) -> Callable[..., Any]:
    def timed(*arguments: Any) -> Any:
        began_s = time.perf_counter()
        result = function(*arguments)
        durations_s.append(time.perf_counter() - began_s)
        return result

    return timed


def quantiles_ms(durations_s: Sequence[float]) -> dict[str, float]:
    """Return median, p99 and max of durations, in milliseconds.

    Raises:
        ValueError: there are no durations.
    """
    if not durations_s:
        raise ValueError("no step was timed")
    ordered = sorted(durations_s)
    ranks = {"median": len(ordered) // 2, "p99": int(0.99 * len(ordered)), "max": len(ordered) - 1}
    return {name: round(1e3 * ordered[rank], _DIGITS) for name, rank in ranks.items()}
