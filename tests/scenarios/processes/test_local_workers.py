import multiprocessing
import os
import signal
from contextlib import closing
from pathlib import Path

import pytest

from link.errors import UserError
from scenarios.processes.local_workers import LocalWorkers, core_count
from scenarios.processes.pool import run_tasks
from tests.scenarios.processes.pool_jobs import Doubling, Unloadable, interrupt_and_stay, threads_and_signals

pytestmark = pytest.mark.slow


def lost(number: int, why: str) -> int:
    assert "SIGKILL" in why
    return -number


def doubled(job: Doubling, numbers: range, workers: int = 2) -> list[int]:
    return sorted(run_tasks(LocalWorkers(job, workers), numbers, lost=lost))


@pytest.mark.parametrize("workers", [1, 3])
def test_pool_does_every_task_once(workers: int) -> None:
    assert doubled(Doubling(), range(20), workers) == list(range(0, 40, 2))


def test_pool_without_tasks_starts_nothing() -> None:
    assert doubled(Doubling(), range(0)) == []


def test_task_whose_process_is_killed_is_done_again(tmp_path: Path) -> None:
    job = Doubling(deadly=frozenset({3, 4, 11}), once=tmp_path)
    assert doubled(job, range(12)) == list(range(0, 24, 2))


def test_task_that_always_kills_its_process_is_reported_and_stops_no_other() -> None:
    results = doubled(Doubling(deadly=frozenset({5})), range(10))
    assert results == sorted([-5, *(2 * number for number in range(10) if number != 5)])


def test_processes_killed_from_outside_lose_nothing() -> None:
    results = []
    with closing(run_tasks(LocalWorkers(Doubling(), 2), range(30), lost=lost)) as stream:
        for number in stream:
            results.append(number)
            if len(results) in {1, 10}:
                for child in multiprocessing.active_children():
                    os.kill(child.pid or 0, signal.SIGKILL)
    assert sorted(results) == list(range(0, 60, 2))


def test_mistake_of_the_user_in_a_process_ends_the_pool() -> None:
    with pytest.raises(UserError, match="7 is refused"):
        doubled(Doubling(refused=7), range(10))
    assert not multiprocessing.active_children()


def test_processes_that_cannot_start_are_a_mistake_of_the_user() -> None:
    with pytest.raises(UserError, match=r"before they are ready \(EXIT\(3\)\)"):
        list(run_tasks(LocalWorkers(Unloadable(), 2), range(10), lost=lost))


def test_closing_ends_the_processes() -> None:
    stream = run_tasks(LocalWorkers(Doubling(), 2), range(1000), lost=lost)
    next(stream)
    assert multiprocessing.active_children()
    stream.close()
    assert not multiprocessing.active_children()


def test_ctrl_c_ends_a_wait_that_a_librarys_handler_lets_go_on() -> None:
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a program tested in this process has its own
    signal.siginterrupt(signal.SIGINT, False)  # as polars has it: SA_RESTART
    try:
        with pytest.raises(KeyboardInterrupt):
            list(run_tasks(LocalWorkers(interrupt_and_stay, 1), [0], lost=lost))
    finally:
        signal.signal(signal.SIGINT, before)
    assert not multiprocessing.active_children()


def test_processes_calculate_on_one_thread_and_do_not_see_ctrl_c(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "7")
    (seen,) = run_tasks(LocalWorkers(threads_and_signals, 1), [0], lost=lambda _, why: (why, False))
    assert seen == ("1", True)
    assert os.environ["OPENBLAS_NUM_THREADS"] == "7"
    assert threads_and_signals(0) == ("7", False)


def test_core_count_is_that_of_this_process() -> None:
    assert core_count() == len(os.sched_getaffinity(0)) >= 1
