"""Flights that must stay what they were: their phases and reasons in order, their outcome within a tolerance.

Tuning changes numbers; it should not change what happens. Where it is meant to, `pytest --update-golden tests/golden`
rewrites the files and prints the differences, and the change is committed with its reason.
"""

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from companion.core.reasons import Reason
from scenarios.catalogue.catalogue import load_scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.recordings.recording import Recording
from scenarios.recordings.result import result_table, score_run
from tests.golden.aborts import ABORTS, SEED, Abort, fly
from tests.golden.reasons import reasons

FOLDER = Path(__file__).parent
Golden = dict[str, Any]


LANDINGS: dict[str, tuple[str, int]] = {
    "landing": ("straight_5", 1),
    "wave_off": ("brake_7", 2),
    "ardupilot": ("straight_5+firmware=ardupilot", 1),
}
TOLERANCES = {"contact_s": 0.5, "horizontal_error_m": 0.1, "relative_speed_m_s": 0.15, "sink_rate_m_s": 0.15}


def _landing(name: str, seed: int) -> Golden:
    """Fly to the end and return what is kept of it."""
    scenario = load_scenario(name)
    run = Lockstep(scenario, seed)
    ended = run.run()
    result = result_table(scenario, seed, run.recording, ended)
    return {
        "scenario": name,
        "seed": seed,
        "tier": result["tier"],
        "ended": ended,
        "events": _events(run.recording),
        **{name: None if result[name] is None else round(result[name], 3) for name in TOLERANCES},
    }


def _abort(abort: Abort) -> Golden:
    """Fly until it is broken off and return what is kept of it."""
    flight = fly(abort)
    return {
        "scenario": abort.scenario,
        "seed": SEED,
        "tier": score_run(flight.scenario, SEED, flight.recording).tier.value,
        "events": _events(flight.recording),
    }


def _events(recording: Recording) -> list[str]:
    begun = [(status.phase, status.reason_code) for status in recording.statuses]
    entered = [after for before, after in pairwise(begun) if before[0] != after[0]]
    return [begun[0][0], *(f"{phase}: {reason}" for phase, reason in entered)]


def _differences(golden: Golden, flown: Golden) -> list[str]:
    found = []
    for name in sorted({*golden, *flown}):
        before, after = golden.get(name), flown.get(name)
        is_measure = name in TOLERANCES and before is not None and after is not None
        tolerated = is_measure and abs(float(before or 0.0) - float(after or 0.0)) <= TOLERANCES.get(name, 0.0)
        if before != after and not tolerated:
            found.append(f"{name}: {before} -> {after}")
    return found


def _compare(name: str, flown: Golden, request: pytest.FixtureRequest) -> None:
    """Compare with what is kept, or keep it and print the differences."""
    path = FOLDER / f"{name}.json"
    golden = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    differences = _differences(golden, flown)
    if request.config.getoption("--update-golden"):
        capture = request.config.pluginmanager.getplugin("capturemanager")
        with capture.global_and_fixture_disabled():
            print(f"\n{path.name}:", *(differences or ["as before"]), sep="\n  ")  # noqa: T201 (what it is for)
        if differences:
            path.write_text(json.dumps(flown, indent=2) + "\n", encoding="utf-8")
        return
    assert not differences


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(LANDINGS))
def test_golden_landing_is_what_it_was(name: str, request: pytest.FixtureRequest) -> None:
    _compare(name, _landing(*LANDINGS[name]), request)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(ABORTS))
def test_golden_abort_is_what_it_was(name: str, request: pytest.FixtureRequest) -> None:
    _compare(name, _abort(ABORTS[name]), request)


@pytest.mark.parametrize("name", sorted(ABORTS))
def test_golden_abort_has_its_reason_and_ends_clear_of_the_vehicle(name: str) -> None:
    golden = json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))
    assert [event for event in golden["events"] if event.startswith("abort")] == [f"abort: {ABORTS[name].reason.name}"]
    assert ABORTS[name].touches or golden["tier"] == "abort"


ALIKE = {
    Reason.OWN_ATTITUDE_OLD: Reason.OWN_POSITION_OLD,
    Reason.STRAYS: Reason.CONTACT_RISKY,
    Reason.ALIGNMENT_LOST: Reason.CONTACT_RISKY,
    Reason.OUTSIDE_CONE: Reason.CONTACT_RISKY,
    Reason.PAD_NOT_SEEN: Reason.OFFSET_UNKNOWN,
    Reason.PAD_TO_BE_SEEN: Reason.OFFSET_UNKNOWN,
    Reason.HEADING_LOST: Reason.HEADING_UNKNOWN,
    Reason.TOO_FAR_FROM_START: Reason.VEHICLE_OUTRUNS,
    Reason.LIFT_OFF_TOO_LONG: Reason.DESCENT_TOO_LONG,
    Reason.CHASE_TOO_LONG: Reason.DESCENT_TOO_LONG,
    Reason.ALIGN_TOO_LONG: Reason.DESCENT_TOO_LONG,
    Reason.TILT_TOO_SMALL: Reason.DESCENT_TOO_LONG,
    Reason.OPERATOR_HOLDS: Reason.OPERATOR_ABORTS,
    Reason.VEHICLE_TAKEN: Reason.OPERATOR_ABORTS,
    Reason.PAD_CHANGED: Reason.OPERATOR_ABORTS,
}
"""Reasons of one kind: the second of them is flown."""


def test_every_kind_of_reason_that_leads_into_an_abort_is_flown() -> None:
    kept = [json.loads(path.read_text(encoding="utf-8")) for path in FOLDER.glob("*.json")]
    flown = {
        event.removeprefix("abort: ") for golden in kept for event in golden["events"] if event.startswith("abort: ")
    }
    assert flown == {ALIKE.get(reason, reason).name for reason in reasons()}


def test_golden_files_are_those_of_flights_that_are_flown() -> None:
    assert {path.stem for path in FOLDER.glob("*.json")} == {*LANDINGS, *ABORTS}
