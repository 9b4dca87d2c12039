"""How long the steps of a run in this process take: a stopwatch around functions, where their callers find them."""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import companion.runtime.node
import sim_autopilot.runtime.node
from companion.planning.mpc import Mpc
from companion.planning.mpc_report import ReportMpc
from companion.planning.pn import ProportionalNavigation
from companion.planning.qp import DaqpSolver

_STEPS: Mapping[str, Sequence[tuple[object, str]]] = {
    "autopilot_step": ((sim_autopilot.runtime.node, "autopilot_step"),),
    "companion_step": ((companion.runtime.node, "companion_step"),),
    "planner": ((Mpc, "plan"), (ReportMpc, "plan"), (ProportionalNavigation, "plan")),
    "solver": ((DaqpSolver, "call"),),
}
"""The two steps of a run, by the module that calls each, the planning in the companion's, and the solver's calls."""

_DIGITS = 4  # of milliseconds, a tenth of a microsecond


@contextmanager
def timed_steps() -> Iterator[dict[str, list[float]]]:
    """Measure the steps inside the block; give their durations in seconds, by name, as they come."""
    durations_s: dict[str, list[float]] = {name: [] for name in _STEPS}
    places = [(name, *place) for name, found in _STEPS.items() for place in found]
    plain = [getattr(owner, attribute) for _, owner, attribute in places]
    try:
        for (name, owner, attribute), function in zip(places, plain, strict=True):
            setattr(owner, attribute, _time(function, durations_s[name]))
        yield durations_s
    finally:
        for (_, owner, attribute), function in zip(places, plain, strict=True):
            setattr(owner, attribute, function)


def _time(function: Callable[..., Any], durations_s: list[float]) -> Callable[..., Any]:
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


def ratio_of(whole_s: Sequence[float], part_s: Sequence[float]) -> float | None:
    """Return how many times as long all of `whole_s` took as all of `part_s`, None where there is no part."""
    return round(sum(whole_s) / sum(part_s), _DIGITS) if part_s else None
