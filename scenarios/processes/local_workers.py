"""Warm processes of this machine as workers, by loky; each loads the job once and does one task at a time.

Each is an executor of its own, so that the death of one says whose task it was, and touches no other.
"""

import os
import re
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import resource_tracker as standard_resource_tracker
from types import TracebackType
from typing import Any, Self

from loky.backend import resource_tracker
from loky.process_executor import ProcessPoolExecutor

from link.errors import UserError
from link.program.start import ONE_THREAD
from scenarios.processes.launch import end_with_parent
from scenarios.processes.pool import Result, Task, Workers

_FAILED_STARTS_MAX = 3  # in a row
_EXIT_CODES = re.compile(r"exit codes of the workers are \{(.*?)\}")


def core_count() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Worker:
    executor: ProcessPoolExecutor
    loaded: "Future[None]"

    @property
    def has_loaded(self) -> bool:
        return self.loaded.done() and self.loaded.exception() is None


class LocalWorkers(Workers[Task, Result]):
    """Processes that are started when there is a task for them.

    Args:
        job: done for each task; can be pickled.
        count: of the processes.
    """

    def __init__(self, job: Callable[[Task], Result], count: int) -> None:
        self.places = count
        self._job = job
        self._idle: list[_Worker] = []
        self._busy: dict[Future[Result], _Worker] = {}
        self._failed_starts = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for worker in (*self._idle, *self._busy.values()):
            worker.executor.shutdown(kill_workers=True)
        self._idle.clear()
        self._busy.clear()

    def submit(self, task: Task) -> "Future[Result]":
        """Have a task done by an idle process, or by a new one."""
        while self._idle:
            worker = self._idle.pop()
            try:
                return self._give(worker, task)
            except BrokenProcessPool:  # it has died since its last task
                worker.executor.shutdown(kill_workers=True)
        return self._give(_start(self._job), task)

    def release(self, future: "Future[Result]") -> str | None:
        """Take a process back; return how it died, None if it lives.

        Raises:
            UserError: several processes in a row have ended before they had loaded the job.
        """
        worker, error = self._busy.pop(future), future.exception()
        if not isinstance(error, BrokenProcessPool):
            self._failed_starts = 0
            self._idle.append(worker)
            return None
        worker.executor.shutdown(kill_workers=True)
        codes = _EXIT_CODES.search(str(error))
        death = codes[1] if codes else "no exit code"
        self._failed_starts = 0 if worker.has_loaded else self._failed_starts + 1
        if self._failed_starts >= _FAILED_STARTS_MAX:
            raise UserError(f"the worker processes end before they are ready ({death})")
        return death

    def _give(self, worker: _Worker, task: Task) -> "Future[Result]":
        future: Future[Result] = worker.executor.submit(_do, task)
        self._busy[future] = worker
        return future


def _start(job: Callable[[Any], Any]) -> _Worker:
    executor = ProcessPoolExecutor(max_workers=1, initializer=_load, initargs=(os.getpid(), job), env=ONE_THREAD)
    with _without_interrupt():
        return _Worker(executor=executor, loaded=executor.submit(_wait_for_load))


@contextmanager
def _without_interrupt() -> Iterator[None]:
    """Let processes and threads started within not see Ctrl-C, which is this thread's to handle."""
    for tracker in (resource_tracker, standard_resource_tracker):
        tracker.ensure_running()  # or starting it, with the first process, would lift the mask below
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


_loaded: list[Callable[[Any], Any]] = []
"""The job; in a worker's process."""


def _load(parent: int, job: Callable[[Any], Any]) -> None:
    end_with_parent(parent)
    _loaded[:] = [job]


def _wait_for_load() -> None:
    """Be done when the job is loaded."""


def _do(task: object) -> Any:
    return _loaded[0](task)
