"""`scenarios run` from outside: its programs, its files, how it ends, and that nothing stays behind."""

import json
import signal
import urllib.request
from pathlib import Path
from typing import Any

import psutil  # type: ignore[import-untyped]  # it has no annotations
import pytest

from tests.integration.observer import PASSES_SOON
from tests.integration.programs import Program, Programs, all_end, until

pytestmark = pytest.mark.wire

NAMES = ("ground-vehicle", "sim-autopilot", "companion")


def start_run(programs: Programs, out: Path, *arguments: str, scenario: str = "straight_5") -> Program:
    return programs.start("scenarios", "run", scenario, "--out", str(out), *arguments)


def started_children(run: Program) -> list[psutil.Process]:
    """Return the three programs of a run as soon as there are three."""

    def are_there() -> bool:
        assert run.runs, run.err.all
        return len(run.children()) == len(NAMES)

    until(are_there, "three programs")
    return run.children()


def read(folder: Path, name: str) -> dict[str, Any]:
    table: dict[str, Any] = json.loads((folder / name).read_text(encoding="utf-8"))
    return table


@pytest.mark.alone  # two drones, each with its companion, are all that two cores can carry
def test_two_runs_at_once_leave_their_folders_of_a_landing_and_of_what_came_until_the_time_limit(
    tmp_path: Path,
) -> None:
    short = tmp_path / "short.toml"
    short.write_text('base = "straight_5"\n[run]\ntime_limit_s = 9.0\n', encoding="utf-8")
    with Programs() as programs:
        runs = [
            start_run(programs, tmp_path, "--seed", str(seed), "--json", scenario=scenario)
            for seed, scenario in ((1, PASSES_SOON), (2, str(short)))
        ]
        codes = [run.wait() for run in runs]
        printed = [json.loads("\n".join(run.out.all)) for run in runs]
    assert codes == [0, 1], [table["reason"] for table in printed]
    assert [table["seed"] for table in printed] == [1, 2]
    assert printed[1]["ended"] == "time limit"
    folders = [Path(table["folder"]) for table in printed]
    assert (tmp_path / "latest").resolve() in {folder.resolve() for folder in folders}
    for folder, table in zip(folders, printed, strict=True):
        result, timing = read(folder, "result.json"), read(folder, "timing.json")
        assert result.items() <= table.items()
        assert timing == table["timing"]
        assert 0.0 < timing["real_time_factor"] < 1.05
        step_ms = timing["step_ms"]["companion"]
        assert 0.0 < step_ms["median"] <= step_ms["p99"] <= step_ms["max"]
        assert {path.name for path in folder.iterdir()} == {
            "companion_000.mcap",
            "truth_000.mcap",
            *("result.json", "timing.json", "scenario.toml", "flight.tlog"),
            *("companion.toml", "sim-autopilot.toml", *(f"{name}.log" for name in NAMES)),
        }
        assert (folder / "flight.tlog").stat().st_size > 30_000


def test_a_killed_run_leaves_no_program(tmp_path: Path) -> None:
    with Programs() as programs:
        run = start_run(programs, tmp_path, "--speed", "3")
        children = started_children(run)
        run.send(signal.SIGKILL)
        assert all_end(children)


def test_a_program_that_dies_ends_the_run_with_one_line_that_names_it(tmp_path: Path) -> None:
    name = "companion"
    with Programs() as programs:
        run = start_run(programs, tmp_path, "--speed", "3")
        run.out.wait_for("takeoff")
        children = started_children(run)
        victim = next(child for child in children if f"{name}.log" in Path(f"/proc/{child.pid}/fd/1").readlink().name)
        victim.kill()
        assert run.wait() == 2
        assert len(run.told) == 1, run.err.all
        assert run.told[0].startswith(f"scenarios: {name} was ended by SIGKILL: ")
        assert str((tmp_path / "latest").resolve().name) in run.told[0]
        assert all_end(children)


def test_page_of_a_run_is_served_until_it_is_interrupted_and_all_programs_have_ended(tmp_path: Path) -> None:
    with Programs() as programs:
        run = start_run(programs, tmp_path, "--view")
        address = run.out.wait_for("view: ").removeprefix("view: ").split()[0]

        def is_served() -> bool:
            assert run.runs, run.err.all
            try:
                with urllib.request.urlopen(address, timeout=1.0) as page:  # noqa: S310 (http on loopback)
                    return b"<html" in page.read()
            except OSError:
                return False

        until(is_served, "the page")
        children = run.children()
        assert len(children) == len(NAMES) + 1
        run.send(signal.SIGINT)
        assert run.wait() == 130, run.err.all
        assert run.told == []
        assert all_end(children)
