"""From a recording to the run's result, as `result.json` has it: only what scenario and seed decide."""

import json
from pathlib import Path
from typing import Any

from link.errors import UserError
from scenarios.config import Scenario
from scenarios.recordings.recording import Recording
from scenarios.scoring.accuracy import accuracy_table
from scenarios.scoring.score import Score, Tier, score
from scenarios.scoring.touchdown import ScoreRules, rules_of
from scenarios.simulation.drone import mean_wind_enu_m_s

_DIGITS = 6  # a micrometre, a microsecond
LANDED = frozenset({Tier.S1, Tier.S2, Tier.S3})


def score_run(scenario: Scenario, seed: int, recording: Recording, rules: ScoreRules | None = None) -> Score:
    """Return the score of a recording, on truth, by the scenario's rules unless others are given."""
    rules = rules or rules_of(scenario, wind_mean_enu_m_s=mean_wind_enu_m_s(scenario, seed))
    return score(recording.drone, recording.vehicle, recording.rotors, rules)


def result_table(
    scenario: Scenario, seed: int, recording: Recording, ended: str, rules: ScoreRules | None = None
) -> dict[str, Any]:
    """Return the result as a table of plain values, by the scenario's rules unless others are given."""
    table = score_run(scenario, seed, recording, rules).to_json()
    table |= accuracy_table(recording.estimate_errors, recording.nis)
    start_ns = recording.drone[0].t_ns
    times = {key: table.pop(key) for key in ("start_t_ns", "contact_t_ns")}
    relative = {key.removesuffix("_t_ns") + "_s": _since_s(value, start_ns) for key, value in times.items()}
    phases = {phase: round(t_s, 3) for phase, t_s in recording.phase_times_s().items()}
    rounded = {key: round(value, _DIGITS) if isinstance(value, float) else value for key, value in table.items()}
    return {"scenario": scenario.name, "seed": seed, **rounded, **relative, "ended": ended, "phases_s": phases}


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
