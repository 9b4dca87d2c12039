"""A pool of warm local processes that the death of any of them does not stop: its task is done again by another.

Processes are spawned, so nothing is inherited but the job; each takes one task at a time over its own pipe, which
costs a tenth of a millisecond, so the parent always knows what a dead process was doing.
"""

import os
import signal
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import get_context, resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess
from types import TracebackType
from typing import Any, Generic, TypeVar, assert_never

from link.errors import UserError
from scenarios.processes.launch import end_with_parent

_ATTEMPTS_MAX = 3  # a task that ended so many processes is given up
_FAILED_STARTS_MAX = 3  # in a row
_END_S = 5.0  # for an idle process to end by itself
_ONE_THREAD = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")  # the processes share the cores already

Task = TypeVar("Task")
Result = TypeVar("Result")


@dataclass(frozen=True, slots=True)
class _Ready:
    """A process has loaded the job."""


@dataclass(frozen=True, slots=True)
class _Done:
    result: Any


@dataclass(frozen=True, slots=True)
class _Refused:
    error: UserError


_Message = _Ready | _Done | _Refused


def core_count() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0))


def run_tasks(
    job: Callable[[Task], Result],
    tasks: Iterable[Task],
    *,
    workers: int,
    lost: Callable[[Task, str], Result],
) -> Generator[Result, None, None]:
    """Yield the results of all tasks in the order in which they are ready.

    To be closed (`contextlib.closing`) where it may not be exhausted: that ends the processes.

    Args:
        job: done for each task in some process; can be pickled.
        tasks: hashable, and can be pickled.
        workers: number of processes.
        lost: what stands for the result of a task that ended its process time and again, from the task and why.

    Raises:
        UserError: raised by the job, or processes end before they are ready.
    """
    waiting = deque(tasks)
    with _Pool(job, min(workers, len(waiting))) as pool:
        yield from pool.run(waiting, lost)


@dataclass(slots=True, eq=False)
class _Worker(Generic[Task]):
    process: SpawnProcess
    pipe: "Connection[Any, Any]"
    task: Task | None = None
    is_ready: bool = False

    @property
    def is_idle(self) -> bool:
        return self.is_ready and self.task is None


class _Pool(Generic[Task, Result]):
    """Processes that each do one task at a time.

    Args:
        job: what is done with a task.
        size: number of processes.
    """

    def __init__(self, job: Callable[[Task], Result], size: int) -> None:
        self._job = job
        self._size = size
        self._workers: list[_Worker[Task]] = []
        self._losses: Counter[Task] = Counter()
        self._failed_starts = 0

    def __enter__(self) -> "_Pool[Task, Result]":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for worker in self._workers:
            worker.pipe.close()
            if not worker.is_idle:
                worker.process.kill()
        for worker in self._workers:
            _exit_code(worker.process)
        self._workers.clear()

    def run(self, waiting: deque[Task], lost: Callable[[Task, str], Result]) -> Iterator[Result]:
        """Yield the results of the `waiting` tasks; a task whose process dies goes back to their head."""
        while waiting or any(worker.task is not None for worker in self._workers):
            self._employ(waiting)
            for worker in self._heard():
                try:
                    message: _Message = worker.pipe.recv()
                except (EOFError, OSError):
                    yield from self._bury(worker, waiting, lost)
                else:
                    yield from self._take(worker, message)

    def _employ(self, waiting: deque[Task]) -> None:
        """Give every idle process a task, and start processes where some are missing."""
        for worker in self._workers:
            if waiting and worker.is_idle:
                worker.task = waiting.popleft()
                with suppress(OSError):  # it has just died: its pipe tells
                    worker.pipe.send(worker.task)
        starting = sum(not worker.is_ready for worker in self._workers)
        for _ in range(min(self._size - len(self._workers), len(waiting) - starting)):
            self._workers.append(_start(self._job))

    def _heard(self) -> list[_Worker[Task]]:
        pipes = {worker.pipe: worker for worker in self._workers}
        return [pipes[pipe] for pipe in wait(list(pipes)) if isinstance(pipe, Connection)]

    def _take(self, worker: _Worker[Task], message: _Message) -> Iterator[Result]:
        match message:
            case _Ready():
                worker.is_ready = True
                self._failed_starts = 0
            case _Done():
                worker.task = None
                yield message.result
            case _Refused():
                raise message.error
            case _:
                assert_never(message)

    def _bury(
        self, worker: _Worker[Task], waiting: deque[Task], lost: Callable[[Task, str], Result]
    ) -> Iterator[Result]:
        """Forget a process that died and have its task done again."""
        self._workers.remove(worker)
        worker.pipe.close()
        code = _exit_code(worker.process)
        if not worker.is_ready:
            self._failed_starts += 1
            if self._failed_starts >= _FAILED_STARTS_MAX:
                raise UserError(f"the worker processes end before they are ready ({_ending(code)})")
        if worker.task is None:
            return
        self._losses[worker.task] += 1
        if self._losses[worker.task] < _ATTEMPTS_MAX:
            waiting.appendleft(worker.task)
        else:
            yield lost(worker.task, f"its process died {_ATTEMPTS_MAX} times ({_ending(code)})")


def _start(job: Callable[[Task], Result]) -> _Worker[Task]:
    context = get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_work, args=(theirs, job, os.getpid()), daemon=True)
    with _for_children():
        process.start()
    theirs.close()  # so that the process's end is the pipe's end
    return _Worker(process=process, pipe=ours)


@contextmanager
def _for_children() -> Iterator[None]:
    """Let processes started within not see Ctrl-C, which is the parent's to handle, and calculate on one thread."""
    resource_tracker.ensure_running()  # or starting it, with the first process, would lift the mask below
    before = {name: os.environ.get(name) for name in _ONE_THREAD}
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    os.environ.update(dict.fromkeys(_ONE_THREAD, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _work(pipe: "Connection[Any, Any]", job: Callable[[Any], Any], parent: int) -> None:
    """Do tasks until the parent's end of `pipe` is closed; in the process."""
    end_with_parent(parent)
    with suppress(EOFError, BrokenPipeError, ConnectionResetError):
        pipe.send(_Ready())
        while True:
            task = pipe.recv()
            try:
                message: _Message = _Done(job(task))
            except UserError as error:
                message = _Refused(error)
            pipe.send(message)


def _exit_code(process: SpawnProcess) -> int:
    """Wait for the end of a process and return its exit code."""
    process.join(_END_S)
    if process.exitcode is None:
        process.kill()
        process.join()
    code = process.exitcode
    process.close()
    return 0 if code is None else code


def _ending(code: int) -> str:
    return signal.Signals(-code).name if code < 0 else f"exit code {code}"
