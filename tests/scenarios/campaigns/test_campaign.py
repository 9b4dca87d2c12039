import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import polars as pl
import psutil  # type: ignore[import-untyped]  # it has no annotations
import pytest

from companion.situation.phases import Phase
from link.errors import UserError
from scenarios.campaigns.campaign import Where, fly_campaign
from scenarios.campaigns.folder import create_folder, open_journal, read_plan
from scenarios.campaigns.landing_task import Flown
from scenarios.campaigns.plan import Plan, make_plan
from tests.scenarios.campaigns.short import failing_cell, journal_of, scenarios, short_cell

pytestmark = pytest.mark.slow

DEADLINE_S = 60.0
SEEDS = 3


def quiet(_flown: Flown | None, _done: int, _total: int) -> None:
    """Show nothing."""


def plan_of(folder: Path, seeds: int = SEEDS) -> Plan:
    cells = [short_cell(folder, "short"), short_cell(folder, "longer", time_limit_s=1.5)]
    return make_plan(cells, first_seed=3, seeds=seeds, config=None)


def landings(folder: Path) -> bytes:
    return (folder / "landings.parquet").read_bytes()


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A campaign that one process flew without interruption."""
    folder = tmp_path_factory.mktemp("reference")
    plan = plan_of(folder)
    rows = fly_campaign(create_folder(folder / "out", plan), plan, Where(workers=1), quiet)
    assert [row["error"] for row in rows] == [None] * 2 * SEEDS
    return folder / "out"


def test_rows_hold_every_phase_and_no_wall_clock(reference: Path) -> None:
    frame = pl.read_parquet(reference / "landings.parquet")
    assert {f"phase_{phase.name.lower()}_s" for phase in Phase} < set(frame.columns)
    assert "wall_s" not in frame.columns
    assert frame["horizontal_error_m"].dtype == pl.Float64  # nobody made contact
    assert set(frame["firmware"]) == {"px4"}
    assert frame["aborts_by_reason"].dtype == frame["first_abort"].dtype == pl.String()
    assert frame["on_pad"].dtype == pl.Boolean


def test_parquet_tells_units_and_versions_beside_its_columns(reference: Path) -> None:
    for name in ("landings.parquet", "timing.parquet"):
        about = pl.read_parquet_metadata(reference / name)
        assert json.loads(about["decklander.versions"])["sources"] == read_plan(reference).versions["sources"]
        units = json.loads(about["decklander.units"])
    assert units["wall_s"] == "s"


def test_seeds_make_a_difference(reference: Path) -> None:
    assert pl.read_parquet(reference / "landings.parquet")["closest_m"].n_unique() == 2 * SEEDS


def test_plan_is_read_back_as_it_was_written(reference: Path, tmp_path: Path) -> None:
    table = json.loads((reference / "campaign.json").read_text(encoding="utf-8"))
    assert (table["cells"], table["first_seed"], table["seeds"]) == (["short", "longer"], 3, SEEDS)
    assert table["scenarios"]["short"]["system"]["companion"]["setpoints"]["rate_hz"] == 50.0
    assert read_plan(reference) == plan_of(tmp_path)


def test_folder_has_one_writer(reference: Path) -> None:
    with (
        open_journal(reference),
        pytest.raises(UserError, match="another campaign is writing here"),
        open_journal(reference),
    ):
        pass


def test_landing_that_raises_is_a_row_makes_the_exit_code_1_and_is_flown_again_when_resumed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, cells = tmp_path / "out", (failing_cell(tmp_path), short_cell(tmp_path))
    assert scenarios("campaign", *cells, "--seeds", 1, "--workers", 1, "--out", folder, "--json") == 1
    printed = capsys.readouterr()
    by_cell = {cell["cell"]: cell for cell in json.loads(printed.out)["cells"]}
    assert (by_cell["failing"]["errors"], by_cell["failing"]["seeds"], by_cell["short"]["errors"]) == (1, 1, 0)
    assert {cell["firmware"] for cell in by_cell.values()} == {"px4"}
    assert "failing, seed 1: ValidationError: 1 validation error for StartConfig" in printed.err
    errors = pl.read_parquet(folder / "landings.parquet").filter(cell="failing")["error"].to_list()
    assert all("main.py" in error and "position_enu_m" in error for error in errors)

    assert scenarios("campaign", "--resume", folder, "--workers", 1) == 1
    assert len(journal_of(folder)) == 3
    assert pl.read_parquet(folder / "landings.parquet").height == 2
    assert "failing" in capsys.readouterr().out


def test_ctrl_c_ends_the_program_and_its_processes_and_the_rest_is_flown_to_the_bytes_of_one_process(
    reference: Path, tmp_path: Path
) -> None:
    plan, folder = read_plan(reference), create_folder(tmp_path / "out", read_plan(reference))
    command = [sys.executable, "-m", "tests.scenarios.campaigns.short", "campaign", "--resume", str(folder)]
    journal = folder / "landings.jsonl"
    with process_group([*command, "--workers", "2"]) as process:
        wait_until(lambda: journal.exists() and journal.read_bytes().count(b"\n") >= 1)
        children = psutil.Process(process.pid).children(recursive=True)
        assert len(children) >= 2
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does it: to all of them
        _, err = process.communicate(timeout=DEADLINE_S)
    assert process.returncode == 130
    assert err.decode().splitlines()[1:] == [f"what is done is kept; go on with: scenarios campaign --resume {folder}"]
    wait_until(lambda: all(has_ended(child) for child in children))
    done = len(journal_of(folder))
    assert pl.read_parquet(folder / "landings.parquet").height == done < 2 * SEEDS

    journal.write_bytes(journal.read_bytes()[:-40])  # its last line is cut short, and so flown again
    flown: list[Flown | None] = []
    fly_campaign(folder, plan, Where(workers=1), lambda one, _done, _total: flown.append(one))
    assert len([one for one in flown if one is not None]) == 2 * SEEDS - done + 1
    assert landings(folder) == landings(reference)


@contextmanager
def process_group(command: list[str]) -> Iterator["subprocess.Popen[bytes]"]:
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True)
    try:
        yield process
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()


def has_ended(process: psutil.Process) -> bool:
    try:
        return bool(process.status() == psutil.STATUS_ZOMBIE)
    except psutil.NoSuchProcess:
        return True


def wait_until(condition: Callable[[], bool]) -> None:
    deadline_s = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < deadline_s
        time.sleep(0.01)
