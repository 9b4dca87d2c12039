"""From a recording to the run's result, as `result.json` has it: only what scenario and seed decide."""

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from link.errors import UserError
from scenarios.config import Scenario
from scenarios.recordings.approaches import Approach, approaches_of
from scenarios.recordings.recording import Recording
from scenarios.scoring.accuracy import accuracy_table
from scenarios.scoring.circumstances import closest_ns, vehicle_circumstances
from scenarios.scoring.score import Score, Tier, score, score_log
from scenarios.scoring.touchdown import ScoreRules, Touchdown, rules_of
from scenarios.scoring.truth_log import TruthLog, passing_ns, truth_log
from scenarios.simulation.drone import mean_wind_enu_m_s
from scenarios.simulation.noise import Seed

_DIGITS = 6  # a micrometre, a microsecond
LANDED = frozenset({Tier.S1, Tier.S2, Tier.S3})


def score_run(scenario: Scenario, seed: Seed, recording: Recording) -> Score:
    """Return the score of a recording, on truth, by the scenario's rules."""
    rules = rules_of(scenario, wind_mean_enu_m_s=mean_wind_enu_m_s(scenario, seed))
    return score(recording.drone, recording.vehicle, recording.rotors, rules)


def result_table(
    scenario: Scenario,
    seed: int,
    recording: Recording,
    ended: str,
    rules: ScoreRules | None = None,
    *,
    started_ns: int | None = None,
) -> dict[str, Any]:
    """Return the result as a table of plain values.

    Args:
        scenario: that was flown.
        seed: of everything random in it.
        recording: of the flight.
        ended: why it did.
        rules: the scenario's unless others are given.
        started_ns: when the landing was called for; None where the vehicle's passing of the waiting drone starts it.
    """
    rules = rules or rules_of(scenario, wind_mean_enu_m_s=mean_wind_enu_m_s(scenario, seed))
    log = truth_log(recording.drone, recording.vehicle, recording.rotors)
    approaches = approaches_of(recording.statuses, log, rules.box.roof_height_m)
    scored = score_log(log, rules, started_ns=started_ns)
    table = scored.to_json()
    table |= accuracy_table(recording.estimate_errors, recording.nis)
    waits = started_ns is None
    table["pass_to_contact_s"] = _pass_to_contact_s(log, approaches, scored.touchdown) if waits else None
    instant_ns = _decisive_ns(log, scored, rules)
    table |= vehicle_circumstances(log, instant_ns)
    start_ns = recording.drone[0].t_ns
    times = {key: table.pop(key) for key in ("start_t_ns", "contact_t_ns")} | {"instant_t_ns": instant_ns}
    relative = {key.removesuffix("_t_ns") + "_s": _since_s(value, start_ns) for key, value in times.items()}
    phases = {phase: round(t_s, 3) for phase, t_s in recording.phase_times_s().items()}
    rounded = {key: round(value, _DIGITS) if isinstance(value, float) else value for key, value in table.items()}
    status = recording.status_at_end(ended)
    return {
        "scenario": scenario.name,
        "firmware": scenario.firmware,
        "seed": seed,
        **rounded,
        **relative,
        "ended": ended,
        "ended_reason_code": None if status is None else status.reason_code,
        "ended_reason": None if status is None else status.reason,
        "phases_s": phases,
        "approaches": [approach.to_json(start_ns) for approach in approaches],
    }


def _decisive_ns(log: TruthLog, scored: Score, rules: ScoreRules) -> int:
    """Return the instant that decided the run: the first contact, or the closest that the drone came to the pad."""
    if scored.touchdown is not None:
        return scored.touchdown.contact_t_ns
    return closest_ns(log, rules.box.roof_height_m, scored.start_t_ns)


def _pass_to_contact_s(log: TruthLog, approaches: Sequence[Approach], touchdown: Touchdown | None) -> float | None:
    """Return the time from the vehicle's passing the place at which the drone waited for it to the first contact."""
    if not approaches or touchdown is None:
        return None
    chase_ns = approaches[0].from_ns
    waits = min(int(np.searchsorted(log.t_ns, chase_ns)), len(log.t_ns) - 1)
    passed_ns = passing_ns(log, log.position_enu_m[waits, :2], chase_ns)
    return None if passed_ns is None else (touchdown.contact_t_ns - passed_ns) * 1e-9


def _since_s(value: Any, start_ns: int) -> float | None:
    return None if value is None else round((value - start_ns) * 1e-9, _DIGITS)


def write_json(path: Path, table: dict[str, Any]) -> None:
    """Write `table` with a fixed order and form.

    Raises:
        UserError: the disk is full, or takes nothing else either.
    """
    write_text(path, json.dumps(table, indent=2, allow_nan=False) + "\n")


def write_text(path: Path, text: str) -> None:
    """Write a file of a run.

    Raises:
        UserError: the disk is full, or takes nothing else either.
    """
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UserError(f"{path}: cannot be written ({error.strerror}); make room or choose another --out") from None


UNITS = {
    "_per_m": "1/m",
    "_m_s2": "m/s^2",
    "_m_s": "m/s",
    "_rad": "rad",
    "_hz": "Hz",
    "_ms": "ms",
    "_ns": "ns",
    "_m": "m",
    "_s": "s",
}
"""By the ending of a name, longer endings before those that they end in."""


def ending_of(name: str) -> str:
    """Return the ending of a name that tells its unit, empty if it has none."""
    return next((ending for ending in UNITS if name.endswith(ending)), "")


def units_of(names: Iterable[str]) -> dict[str, str]:
    """Return the unit of each name that has one."""
    return {name: UNITS[ending] for name in names if (ending := ending_of(name))}
