"""Flights that must stay what they were: their phases and reasons in order, their outcome within a tolerance.

Tuning changes numbers; it should not change what happens. Where it is meant to, `pytest --update-golden tests/golden`
rewrites the files and prints the differences, and the change is committed with its reason.
"""

import json
import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from link.toml_config import merged, validated
from scenarios.catalogue import load_scenario
from scenarios.config import Scenario
from scenarios.lockstep import Lockstep
from scenarios.outcome import result_table

pytestmark = pytest.mark.slow
FOLDER = Path(__file__).parent
Changes = dict[str, Any]


def _companion(**sections: Changes) -> Changes:
    """Return changes to the companion of a flight that is broken off once and then held."""
    return {"system": {"companion": sections | {"abort": {"retries_max": 0} | sections.get("abort", {})}}}


CASES: dict[str, tuple[str, int, Changes]] = {
    "landing": ("straight_5", 1, {}),
    "wave_off": ("brake_7", 2, {}),
    "ardupilot": ("straight_5+firmware=ardupilot", 1, {}),
    "align_too_long": ("straight_5", 1, _companion(descent={"align_time_limit_s": 0.2})),
    "descent_too_long": ("straight_5", 1, _companion(descent={"time_limit_s": 1.0})),
}
TOLERANCES = {"contact_s": 0.5, "horizontal_error_m": 0.1, "relative_speed_m_s": 0.15, "sink_rate_m_s": 0.15}


def _golden_of(name: str, seed: int, changes: Changes) -> dict[str, Any]:
    """Fly and return what is kept of a flight."""
    table = merged(load_scenario(name).model_dump(mode="json"), changes)
    scenario = validated(Scenario, table, source=name)
    run = Lockstep(scenario, seed)
    ended = run.run()
    result = result_table(scenario, seed, run.recording, ended)
    begun = [(status.phase, status.reason) for status in run.recording.statuses]
    entered = [after for before, after in pairwise(begun) if before[0] != after[0]]
    events = [begun[0][0], *(f"{phase}: {_kind(reason)}" for phase, reason in entered)]
    return {
        "scenario": name,
        "seed": seed,
        "tier": result["tier"],
        "ended": ended,
        "events": events,
        **{name: None if result[name] is None else round(result[name], 3) for name in TOLERANCES},
    }


def _kind(reason: str) -> str:
    """Return what a reason says without its numbers and details."""
    return re.sub(r"-?\d+(\.\d+)?", "#", reason.split(":", maxsplit=1)[0] if reason.startswith("contact") else reason)


def _differences(golden: dict[str, Any], flown: dict[str, Any]) -> list[str]:
    found = []
    for name in sorted({*golden, *flown}):
        before, after = golden.get(name), flown.get(name)
        is_measure = name in TOLERANCES and before is not None and after is not None
        tolerated = is_measure and abs(float(before or 0.0) - float(after or 0.0)) <= TOLERANCES.get(name, 0.0)
        if before != after and not tolerated:
            found.append(f"{name}: {before} -> {after}")
    return found


@pytest.mark.parametrize("name", sorted(CASES))
def test_golden_flight_is_what_it_was(name: str, request: pytest.FixtureRequest) -> None:
    path = FOLDER / f"{name}.json"
    golden = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    flown = _golden_of(*CASES[name])
    differences = _differences(golden, flown)
    if request.config.getoption("--update-golden"):
        capture = request.config.pluginmanager.getplugin("capturemanager")
        with capture.global_and_fixture_disabled():
            print(f"\n{path.name}:", *(differences or ["as before"]), sep="\n  ")  # noqa: T201 (what it is for)
        if differences:
            path.write_text(json.dumps(flown, indent=2) + "\n", encoding="utf-8")
        return
    assert not differences
