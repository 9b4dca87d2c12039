import json
import multiprocessing
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
SEEDS = 4


def quiet(_flown: Flown | None, _done: int, _total: int) -> None:
    """Show nothing."""


def plan_of(folder: Path, seeds: int = SEEDS) -> Plan:
    cells = [short_cell(folder, "short"), short_cell(folder, "longer", time_limit_s=2.5)]
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


def test_seeds_make_a_difference(reference: Path) -> None:
    assert pl.read_parquet(reference / "landings.parquet")["closest_m"].n_unique() == 2 * SEEDS


def test_plan_is_read_back_as_it_was_written(reference: Path, tmp_path: Path) -> None:
    table = json.loads((reference / "campaign.json").read_text(encoding="utf-8"))
    assert (table["cells"], table["first_seed"], table["seeds"]) == (["short", "longer"], 3, SEEDS)
    assert table["scenarios"]["short"]["system"]["companion"]["step_rate_hz"] == 50.0
    assert read_plan(reference) == plan_of(tmp_path)


def test_interrupted_campaign_of_two_processes_goes_on_with_the_rest_to_the_bytes_of_one(
    reference: Path, tmp_path: Path
) -> None:
    plan, folder = read_plan(reference), tmp_path / "out"
    create_folder(folder, plan)

    def interrupt(_flown: Flown | None, done: int, _total: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fly_campaign(folder, plan, Where(workers=2), interrupt)
    assert not multiprocessing.active_children()
    assert len(journal_of(folder)) == pl.read_parquet(folder / "landings.parquet").height == 3

    flown: list[Flown | None] = []
    fly_campaign(folder, plan, Where(workers=1), lambda one, _done, _total: flown.append(one))
    assert len([one for one in flown if one is not None]) == 2 * SEEDS - 3
    assert landings(folder) == landings(reference)


def test_line_that_was_cut_short_is_flown_again(reference: Path, tmp_path: Path) -> None:
    plan, folder = read_plan(reference), create_folder(tmp_path / "out", read_plan(reference))
    whole = (reference / "landings.jsonl").read_bytes()
    (folder / "landings.jsonl").write_bytes(whole[:-40])
    fly_campaign(folder, plan, Where(workers=1), quiet)
    assert landings(folder) == landings(reference)
    assert len(journal_of(folder)) == 2 * SEEDS


def test_folder_has_one_writer(reference: Path) -> None:
    with (
        open_journal(reference),
        pytest.raises(UserError, match="another campaign is writing here"),
        open_journal(reference),
    ):
        pass


def test_landing_that_raises_is_a_row_and_makes_the_exit_code_1(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cells = failing_cell(tmp_path), short_cell(tmp_path)
    code = scenarios("campaign", *cells, "--seeds", 2, "--workers", 1, "--out", tmp_path / "out", "--json")
    printed = capsys.readouterr()
    assert code == 1
    by_cell = {cell["cell"]: cell for cell in json.loads(printed.out)["cells"]}
    assert (by_cell["failing"]["errors"], by_cell["failing"]["seeds"], by_cell["short"]["errors"]) == (2, 2, 0)
    assert {cell["firmware"] for cell in by_cell.values()} == {"px4"}
    assert "failing, seed 2: ValueError: GPS_RAW_INT cannot be packed" in printed.err
    errors = pl.read_parquet(tmp_path / "out" / "landings.parquet").filter(cell="failing")["error"].to_list()
    assert all("codec.py" in error for error in errors)


def test_resuming_flies_what_failed_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "out"
    assert scenarios("campaign", failing_cell(tmp_path), "--seeds", 1, "--workers", 1, "--out", folder) == 1
    assert scenarios("campaign", "--resume", folder, "--workers", 1) == 1
    assert len(journal_of(folder)) == 2
    assert pl.read_parquet(folder / "landings.parquet").height == 1
    assert "failing" in capsys.readouterr().out


def test_ctrl_c_ends_the_program_and_its_processes(reference: Path, tmp_path: Path) -> None:
    folder = create_folder(tmp_path / "out", read_plan(reference))
    command = [sys.executable, "-m", "tests.scenarios.campaigns.short", "campaign", "--resume", str(folder)]
    with process_group([*command, "--workers", "2"]) as process:
        journal = folder / "landings.jsonl"
        wait_until(lambda: journal.exists() and journal.read_bytes().count(b"\n") >= 1)
        children = psutil.Process(process.pid).children(recursive=True)
        assert len(children) >= 2
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does it: to all of them
        _, err = process.communicate(timeout=DEADLINE_S)
    assert process.returncode == 130
    assert err.decode().splitlines()[1:] == [f"what is done is kept; go on with: scenarios campaign --resume {folder}"]
    wait_until(lambda: all(has_ended(child) for child in children))
    assert 0 < len(journal_of(folder)) < 2 * SEEDS


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
