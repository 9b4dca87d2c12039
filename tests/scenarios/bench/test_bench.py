"""The bench: its stopwatch, its budgets, and what the command prints."""

import json
from pathlib import Path

import numpy as np
import pytest

import companion.runtime.node
import sim_autopilot.runtime.node
from link.program.cli import run_app
from scenarios.app import app
from scenarios.bench.bench import Budget, text_lines
from scenarios.bench.recording import FlownInputs, recording_cost
from scenarios.catalogue.catalogue import load_scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.lockstep.stopwatch import quantiles_ms, ratio_of, timed_steps
from scenarios.processes.programs import MODULES
from scenarios.recordings.replay import read_flights, replay

BUDGET = Budget(path=("a", "b"), label="a figure", unit="ms", limit=5.0)


def test_quantiles_are_those_of_numpy() -> None:
    durations_s = np.random.default_rng(3).exponential(2e-3, 1000).tolist()
    found = quantiles_ms(durations_s)
    ordered_ms = 1e3 * np.quantile(durations_s, [0.5, 0.99, 1.0], method="higher")
    assert [found["median"], found["p99"], found["max"]] == pytest.approx(ordered_ms.tolist(), abs=1e-4)


def test_nothing_timed_has_no_quantiles() -> None:
    with pytest.raises(ValueError, match="no step was timed"):
        quantiles_ms([])


@pytest.mark.slow
def test_stopwatch_times_every_step_and_is_gone_afterwards() -> None:
    callers = (vars(sim_autopilot.runtime.node), vars(companion.runtime.node))
    plain = (callers[0]["autopilot_step"], callers[1]["companion_step"])
    run = Lockstep(load_scenario("straight_5"), 1)
    with timed_steps() as durations_s:
        for _ in range(20):
            run.step()
    assert len(durations_s["autopilot_step"]) == 20
    assert 5 <= len(durations_s["companion_step"]) <= 20
    assert min(min(durations) for durations in durations_s.values() if durations) > 0.0
    assert (callers[0]["autopilot_step"], callers[1]["companion_step"]) == plain


def test_stopwatch_times_the_solver_inside_of_the_planner() -> None:
    run = Lockstep(load_scenario("straight_5"), 1)
    with timed_steps() as durations_s:
        while len(durations_s["planner"]) < 5:
            run.step()
    assert len(durations_s["solver"]) == 2 * 5  # both horizontal axes, and the vertical one
    assert sum(durations_s["solver"]) < sum(durations_s["planner"])


def test_ratio_is_that_of_the_sums_and_none_of_nothing() -> None:
    assert ratio_of([4.0, 5.0], [1.0, 1.0, 1.0]) == 3.0
    assert ratio_of([4.0], []) is None


@pytest.mark.parametrize(
    ("value", "at_least", "met"), [(4.0, False, True), (6.0, False, False), (6.0, True, True), (4.0, True, False)]
)
def test_a_budget_says_whether_it_is_met(value: float, *, at_least: bool, met: bool) -> None:
    budget = Budget(path=BUDGET.path, label="a figure", unit="ms", limit=5.0, at_least=at_least)
    assert budget.check({"a": {"b": value}})["met"] is met


def test_a_figure_that_could_not_be_measured_misses_its_budget_and_is_shown_as_a_dash() -> None:
    check = BUDGET.check({"c": 1.0})
    assert (check["value"], check["met"]) == (None, False)
    foxglove = {"messages_hz": 400.0, "latency_ms": {"p99": 30.0}}
    lockstep = {"cpu_s": 1.0, "cpu_shares": {"companion": 1.0}}
    table = {
        "scenario": "s",
        "firmware": "px4",
        "seed": 1,
        "tier": "S3",
        "budgets": [check],
        "step_ms": {},
        "first_heartbeat_s": {},
    }
    table |= {"lockstep": lockstep, "foxglove": foxglove, "recording": {"writer_cpu_share": 0.02, "dropped": 0}}
    line = next(line for line in text_lines(table) if "a figure" in line)
    assert line.split()[-6:] == ["-", "ms", "at", "most", "5", "missed"]


@pytest.mark.slow
def test_cost_of_recording_is_measured_on_a_whole_recording(tmp_path: Path) -> None:
    scenario = load_scenario("straight_5").with_run(time_limit_s=0.5)
    cost = recording_cost(scenario, FlownInputs(scenario, 1), tmp_path)
    assert cost["step_ratio"] > 0.5
    assert cost["writer_cpu_share"] > 0.0
    assert cost["dropped"] == 0
    ((_, flight),) = read_flights(tmp_path)
    assert replay(flight).differences == ()
    assert flight.inputs[0].sequence == 0


@pytest.mark.wire
def test_the_command_prints_every_figure_with_its_budget(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("scenarios.bench.measures._HELP_REPEATS", 1)
    monkeypatch.setattr("scenarios.bench.codec._REPEATS", 3)
    short = tmp_path / "short.toml"
    short.write_text('base = "straight_5"\nrun.time_limit_s = 3.0\n', encoding="utf-8")
    assert run_app("scenarios", app, ["bench", str(short), "--json"]) == 0
    table = json.loads(capfd.readouterr().out)
    assert table["real_time_factor"] > 0.0
    assert set(table["step_ms"]) == {"companion", "autopilot_step", "companion_step", "planner", "solver"}
    for step in table["step_ms"].values():
        assert 0.0 < step["median"] <= step["p99"] <= step["max"]
    assert 0.0 < table["companion"]["cpu_share"] < 2.0
    assert 50.0 < table["companion"]["own_memory_mb"] < table["companion"]["memory_mb"] < 1000.0
    assert table["full_speed_factor"] > table["real_time_factor"]
    assert 0.0 < table["foxglove"]["latency_ms"]["median"] <= table["foxglove"]["latency_ms"]["p99"]
    assert 0.0 < table["foxglove"]["cpu_share"] < 2.0
    assert table["foxglove"]["messages_hz"] > 50.0  # a step's alone
    assert set(table["help_s"]) == set(MODULES)
    assert set(table["first_heartbeat_s"]) == {"companion", "sim-autopilot"}
    assert all(isinstance(check["met"], bool) and check["value"] is not None for check in table["budgets"])
