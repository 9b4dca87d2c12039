"""Campaigns on a real Dask cluster on loopback: a scheduler and two workers, each a process of its own."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from link.errors import UserError
from scenarios.campaigns.campaign import Where, fly_campaign
from scenarios.campaigns.folder import create_folder
from scenarios.campaigns.landing_task import Flights, Flown, Task
from scenarios.campaigns.plan import Plan, make_plan
from scenarios.processes.dask_workers import DaskWorkers
from scenarios.processes.pool import run_tasks
from scenarios.processes.programs import free_port
from tests.integration.programs import Lines
from tests.scenarios.campaigns.short import failing_cell, short_cell

pytestmark = pytest.mark.slow

DEADLINE_S = 60.0
ROOT = Path(__file__).resolve().parents[2]


@contextmanager
def program(*words: str, ready: str) -> Iterator["subprocess.Popen[str]"]:
    """Run one of Dask's programs until the end of the block, from its line with `ready` in it."""
    environment = os.environ | {"PYTHONPATH": f"{ROOT}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"}
    process = subprocess.Popen(
        [sys.executable, "-m", *words], env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    )
    assert process.stderr is not None
    log = Lines(process.stderr)
    try:
        log.wait_for(ready)
        yield process
    finally:
        process.terminate()
        process.wait(DEADLINE_S)
        log.finish()


def none_on(address: str) -> Iterator[int]:
    """Do no tasks on a cluster."""
    workers: DaskWorkers[int, int] = DaskWorkers(address, lambda _: abs)
    return run_tasks(workers, [], lost=lambda task, _: task)


@contextmanager
def scheduler() -> Iterator[str]:
    port = free_port()
    words = "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard"
    with program(*words, ready="Scheduler at:"):
        yield f"tcp://127.0.0.1:{port}"


@contextmanager
def worker(address: str, folder: Path, *, threads: int = 1) -> Iterator["subprocess.Popen[str]"]:
    words = "--no-nanny", "--no-dashboard", "--host", "127.0.0.1", "--local-directory", str(folder)
    with program(
        "distributed.cli.dask_worker", address, *words, "--nthreads", str(threads), ready="Registered to:"
    ) as process:
        yield process


def quiet(_flown: Flown | None, _done: int, _total: int) -> None:
    """Show nothing."""


def plan_of(folder: Path) -> Plan:
    cells = [short_cell(folder, "short"), short_cell(folder, "longer", time_limit_s=0.6), failing_cell(folder)]
    return make_plan(cells, first_seed=3, seeds=2, config=None)


@pytest.fixture(scope="module")
def local(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The landings of the plan as one local process flies them."""
    folder = tmp_path_factory.mktemp("local")
    plan = plan_of(folder)
    rows = fly_campaign(create_folder(folder / "out", plan), plan, Where(workers=1), quiet)
    assert sum(row["error"] is None for row in rows) == 4
    return (folder / "out" / "landings.parquet").read_bytes()


def test_dask_gives_the_bytes_of_one_local_process_though_a_worker_is_killed_and_refuses_none_and_other_sources(
    local: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = plan_of(tmp_path)
    remote = create_folder(tmp_path / "remote", plan)
    with ExitStack() as programs:
        address = programs.enter_context(scheduler())
        with monkeypatch.context() as hurried:
            hurried.setattr("scenarios.processes.dask_workers._FIRST_WORKER_S", 0.5)
            with pytest.raises(UserError, match="has no workers"):
                list(none_on(address))
        victim = programs.enter_context(worker(address, tmp_path))
        programs.enter_context(worker(address, tmp_path, threads=2))

        def kill(_flown: Flown | None, done: int, _total: int) -> None:
            if done == 1:
                victim.kill()

        fly_campaign(remote, plan, Where(scheduler=address), kill)
        assert victim.wait(DEADLINE_S) == -signal.SIGKILL
        assert (remote / "landings.parquet").read_bytes() == local

        flights = Flights(cells=plan.flown, sources="0123456789ab")
        workers: DaskWorkers[Task, Flown] = DaskWorkers(address, lambda _: flights)
        with pytest.raises(UserError, match="other sources"):
            list(run_tasks(workers, plan.tasks(), lost=lambda task, why: pytest.fail(f"{task}: {why}")))


def test_scheduler_that_is_not_there_is_a_mistake_of_the_user(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenarios.processes.dask_workers._CONNECT_S", 0.5)
    plan = plan_of(tmp_path)
    folder = create_folder(tmp_path / "out", plan)
    address = f"tcp://127.0.0.1:{free_port()}"
    with pytest.raises(UserError, match=f"no Dask scheduler answers at {address}"):
        fly_campaign(folder, plan, Where(scheduler=address), quiet)


def test_missing_dask_is_a_mistake_of_the_user(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(UserError, match=r"needs distributed: install the extra 'dask'"):
        list(none_on("tcp://127.0.0.1:8786"))
