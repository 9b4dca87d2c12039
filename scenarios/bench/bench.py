"""The bench: one landing over the wire at real time and one in lockstep, timed, each figure against its budget."""

import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from link.program.extras import require
from link.program.toml_config import merge
from scenarios.bench.codec import codec_ratios
from scenarios.bench.foxglove import foxglove_cost
from scenarios.bench.measures import first_heartbeats_s, full_speed_factor, help_times_s
from scenarios.bench.recording import FlownInputs, recording_cost
from scenarios.bench.shares import sampled_parts, shares_of
from scenarios.config import Scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.lockstep.stopwatch import quantiles_ms, ratio_of, timed_steps
from scenarios.lockstep.warm_up import warm_process
from scenarios.recordings.run_folder import RunOptions
from scenarios.wire.run import run_over_wire

Table = dict[str, Any]
Announce = Callable[[str], None]
"""Called with what is measured next."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Budget:
    """A limit on a figure.

    Attributes:
        path: of the figure in the bench's table.
        label: for people.
        unit: of figure and limit.
        limit: what it may be.
        at_least: whether more is better.
    """

    path: tuple[str, ...]
    label: str
    unit: str
    limit: float
    at_least: bool = False

    def check(self, table: Table) -> Table:
        """Return the figure beside its limit, and whether it is met; one that could not be measured is not."""
        value: Any = table
        for key in self.path:
            value = None if value is None else value.get(key)
        met = value is not None and (value >= self.limit if self.at_least else value <= self.limit)
        figure = {"figure": ".".join(self.path), "label": self.label, "unit": self.unit}
        return figure | {"value": value, "limit": self.limit, "at_least": self.at_least, "met": met}


_PROGRAMS = ("companion", "sim-autopilot", "ground-vehicle", "scenarios")

BUDGETS = (
    Budget(
        path=("step_ms", "companion", "p99"), label="companion, state in to setpoint out, p99", unit="ms", limit=5.0
    ),
    Budget(path=("step_ms", "planner", "median"), label="planner, median of a step", unit="ms", limit=0.3),
    Budget(path=("step_ms", "planner", "p99"), label="planner, p99 of a step", unit="ms", limit=3.0),
    Budget(path=("lockstep", "planner_to_solver"), label="planner, bare solver is 1", unit="x", limit=2.0),
    Budget(path=("companion", "cpu_share"), label="companion, share of a core", unit="", limit=0.3),
    Budget(path=("companion", "memory_mb"), label="companion, resident memory", unit="MB", limit=250.0),
    Budget(path=("companion", "own_memory_mb"), label="companion, memory of its own", unit="MB", limit=150.0),
    Budget(path=("first_heartbeat_s", "companion"), label="companion, start to ready", unit="s", limit=1.5),
    Budget(path=("real_time_factor",), label="simulator, factor at 1x", unit="x", limit=0.99, at_least=True),
    Budget(path=("full_speed_factor",), label="simulator, all it can", unit="x", limit=5.0, at_least=True),
    Budget(path=("lockstep", "real_time_factor"), label="lockstep, whole stack", unit="x", limit=20.0, at_least=True),
    Budget(path=("recording", "step_ratio"), label="step with recording, without is 1", unit="x", limit=1.03),
    # A picture of a view at 20 Hz; and what leaves a core of a small computer to the flight.
    Budget(
        path=("foxglove", "latency_ms", "median"), label="--foxglove, step to client, median", unit="ms", limit=50.0
    ),
    Budget(path=("foxglove", "cpu_share"), label="--foxglove, share of a core", unit="", limit=0.2),
    Budget(path=("codec", "encode_ratio"), label="MAVLink encoding, pymavlink's is 1", unit="x", limit=1.5),
    Budget(path=("codec", "parse_ratio"), label="MAVLink parsing, pymavlink's is 1", unit="x", limit=1.5),
    *(Budget(path=("help_s", name), label=f"{name} --help", unit="s", limit=1.0) for name in _PROGRAMS),
)
"""What the project asks of itself, on two shared cores."""


def bench(scenario: Scenario, seed: int, announce: Announce) -> Table:
    """Measure and return the table that `scenarios bench --json` prints.

    Args:
        scenario: the landing to be flown.
        seed: of everything random.
        announce: told before each measurement.

    Raises:
        UserError: an extra that is measured is not installed.
    """
    for extra in ("foxglove", "view"):  # the server, and what its client speaks
        require(extra, "scenarios bench")
    with tempfile.TemporaryDirectory(prefix="decklander-bench-") as name:
        folder = Path(name)
        announce("one landing over the wire in real time")
        wire = run_over_wire(scenario, RunOptions(seed=seed, speed=1.0, folder=folder), lambda *_: None)
        announce("the simulator as fast as it can")
        full_speed = full_speed_factor(folder)
        announce("first heartbeats")
        heartbeats_s = first_heartbeats_s(folder)
        announce("recording")
        flown = FlownInputs(scenario, seed)
        recording = recording_cost(scenario, flown, folder / "recording")
    announce("Foxglove, in real time")
    foxglove = foxglove_cost(scenario, flown)
    announce("one landing in lockstep")
    lockstep = _lockstep(scenario, seed)
    announce("help")
    table = {
        "scenario": scenario.name,
        "firmware": scenario.firmware,
        "seed": seed,
        "tier": wire.result["tier"],
        **merge(wire.timing, {"step_ms": lockstep.pop("step_ms")}),
        "full_speed_factor": round(full_speed, 3),
        "lockstep": lockstep,
        "recording": recording,
        "foxglove": foxglove,
        "first_heartbeat_s": heartbeats_s,
        "codec": codec_ratios(),
        "help_s": help_times_s(),
    }
    return table | {"budgets": [budget.check(table) for budget in BUDGETS]}


def _lockstep(scenario: Scenario, seed: int) -> Table:
    """Time a landing in this process."""
    warm_process()
    run = Lockstep(scenario, seed)
    with timed_steps() as durations_s, sampled_parts() as samples:
        began_s, began_cpu_s = time.perf_counter(), time.process_time()
        run.run()
        wall_s, cpu_s = time.perf_counter() - began_s, time.process_time() - began_cpu_s
    return {
        "real_time_factor": round(run.recording.elapsed_s / wall_s, 2),
        "cpu_s": round(cpu_s, 3),
        "cpu_shares": shares_of(samples),
        "planner_to_solver": ratio_of(durations_s["planner"], durations_s["solver"]),
        "step_ms": {name: quantiles_ms(durations) for name, durations in durations_s.items() if durations},
    }


def text_lines(table: Table) -> list[str]:
    """Return the table as lines for people."""
    lines = [f"{table['scenario']}, {table['firmware']}, seed {table['seed']}: tier {table['tier']}", ""]
    lines += [_budget_line(check) for check in table["budgets"]]
    lines += ["", f"{'step times, ms':44}{'median':>9}{'p99':>9}{'max':>9}"]
    for name, step in table["step_ms"].items():
        label = "companion, state in to setpoint out" if name == "companion" else f"{name} (lockstep)"
        lines.append(f"  {label:42}" + "".join(f"{step[key]:9.3f}" for key in ("median", "p99", "max")))
    lines += ["", f"lockstep, share of {table['lockstep']['cpu_s']:.2f} s of processor time"]
    lines += [f"  {part:42}{share:9.1%}" for part, share in table["lockstep"]["cpu_shares"].items()]
    share, dropped = table["recording"]["writer_cpu_share"], table["recording"]["dropped"]
    lines += ["", f"recording, its writer's share of a core in flight {share:.1%}, records dropped {dropped}"]
    foxglove = table["foxglove"]
    rate_hz, p99_ms = foxglove["messages_hz"], foxglove["latency_ms"]["p99"]
    lines += ["", f"--foxglove, {rate_hz:.0f} messages a second, p99 of their latency {p99_ms:.1f} ms"]
    lines += ["", "start to first heartbeat, s"]
    lines += [f"  {name:42}{value:9.2f}" for name, value in table["first_heartbeat_s"].items()]
    return lines


def _budget_line(check: Table) -> str:
    bound = "at least" if check["at_least"] else "at most"
    verdict = "met" if check["met"] else "missed"
    value = "-" if check["value"] is None else f"{check['value']:.3f}"
    return f"  {check['label']:42}{value:>9} {check['unit']:3} {bound:8} {check['limit']:6g}  {verdict}"
