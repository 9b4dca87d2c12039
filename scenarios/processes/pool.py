"""Many tasks done by workers, here or on a cluster, in one loop; the death of any worker does not stop it.

Who the workers are (`LocalWorkers`, `DaskWorkers`) shows neither in the results nor in what is asked of a job.
"""

from abc import ABC, abstractmethod
from collections import Counter, deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import CancelledError, Future
from itertools import chain, islice
from queue import Empty, SimpleQueue
from types import TracebackType
from typing import Generic, Self, TypeVar

from link.errors import UserError

_ATTEMPTS_MAX = 3  # a task that ended so many processes is given up
_WAIT_S = 1.0

Task = TypeVar("Task")
Result = TypeVar("Result")


class Workers(ABC, Generic[Task, Result]):
    """Who does tasks, as long as a `with` block; its end ends what is not done.

    Attributes:
        places: how many tasks they take at once.
    """

    places: int

    @abstractmethod
    def __enter__(self) -> Self:
        """Find them."""

    @abstractmethod
    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End them, whatever they do."""

    @abstractmethod
    def submit(self, task: Task) -> "Future[Result]":
        """Have a task done."""

    @abstractmethod
    def release(self, future: "Future[Result]") -> str | None:
        """Take back the place of a task that has ended, and return how its worker died, None if it lives.

        Raises:
            UserError: workers end before they are ready.
        """


def run_tasks(
    workers: Workers[Task, Result], tasks: Iterable[Task], *, lost: Callable[[Task, str], Result]
) -> Generator[Result, None, None]:
    """Yield the results of all tasks in the order in which they are ready.

    To be closed (`contextlib.closing`) where it may not be exhausted: that ends the workers.

    Args:
        workers: who does them; they are found, and ended.
        tasks: hashable, and can be pickled.
        lost: what stands for the result of a task that failed, or ended its worker time and again; from task and why.

    Raises:
        UserError: raised by the job, or there are no workers.
    """
    with workers:
        for _, result in run_batch(workers, tasks, lost=lost):
            yield result


def run_batch(
    workers: Workers[Task, Result], tasks: Iterable[Task], *, lost: Callable[[Task, str], Result]
) -> Generator[tuple[Task, Result], None, None]:
    """Yield each task with its result, as `run_tasks` does, by workers that are found and stay for other tasks.

    A task is taken from `tasks` when there is a place for it, so that who asks can end them early.
    """
    fresh, again, losses = iter(tasks), deque[Task](), Counter[Task]()
    underway: dict[Future[Result], Task] = {}
    ended: SimpleQueue[Future[Result]] = SimpleQueue()
    while True:
        for task in islice(chain(_drained(again), fresh), workers.places - len(underway)):
            future = workers.submit(task)
            underway[future] = task
            future.add_done_callback(ended.put)
        if not underway:
            return
        future = _next_ended(ended)
        task = underway.pop(future)
        death = workers.release(future)
        if death is None:
            yield task, _result(future, task, lost)
            continue
        losses[task] += 1
        if losses[task] < _ATTEMPTS_MAX:
            again.append(task)
        else:
            yield task, lost(task, f"its process died {_ATTEMPTS_MAX} times ({death})")


def _drained(tasks: "deque[Task]") -> Iterator[Task]:
    while tasks:
        yield tasks.popleft()


def _next_ended(ended: "SimpleQueue[Future[Result]]") -> "Future[Result]":
    """Wait for a future to end, and be woken by Ctrl-C.

    Polars handles SIGINT with SA_RESTART and then as before: a wait without a limit would go on, unknown to Python.
    """
    while True:
        try:
            return ended.get(timeout=_WAIT_S)
        except Empty:
            continue


def _result(future: "Future[Result]", task: Task, lost: Callable[[Task, str], Result]) -> Result:
    match CancelledError() if future.cancelled() else future.exception():
        case None:
            return future.result()
        case UserError() as error:
            raise error
        case error:
            return lost(task, " ".join(f"{type(error).__name__}: {error}".split()))
