"""An existing Dask cluster as workers; the only file that imports `distributed`."""

import socket
import sys
from collections.abc import Callable
from concurrent.futures import Future
from types import TracebackType
from typing import Any, Self
from urllib.parse import urlsplit

from link.errors import UserError
from link.program.extras import require
from scenarios.processes.pool import Result, Task, Workers

_SCHEMES = ("tcp", "tls")
_CONNECT_S = 10.0
_FIRST_WORKER_S = 30.0


class DaskWorkers(Workers[Task, Result]):
    """A cluster's workers, which need the same sources of this project as here.

    Args:
        address: of the scheduler, such as tcp://192.168.1.5:8786.
        job_of: what is done for a task; can be pickled, and is kept by the cluster, so it is the same for many.
    """

    def __init__(self, address: str, job_of: Callable[[Task], Callable[[Task], Result]]) -> None:
        self.places = sys.maxsize  # the scheduler keeps the queue, and tries again where a worker has gone
        self._address = address
        self._job_of = job_of
        self._client: Any = None
        self._executor: Any = None

    def __enter__(self) -> Self:
        """Connect.

        Raises:
            UserError: `distributed` is not installed, the scheduler cannot be reached, or it has no workers.
        """
        check_scheduler(self._address)
        from distributed import Client  # noqa: PLC0415 (an optional dependency)

        try:
            self._client = Client(self._address, timeout=_CONNECT_S, set_as_default=False)
        except (OSError, ValueError) as error:
            why = error or type(error).__name__
            raise UserError(f"no Dask scheduler answers at {self._address} ({why})") from None
        try:
            self._client.wait_for_workers(1, timeout=_FIRST_WORKER_S)
        except TimeoutError:
            self._client.close()
            raise UserError(f"the Dask scheduler at {self._address} has no workers") from None
        self._executor = self._client.get_executor(pure=False)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._executor.shutdown(wait=False)
        self._client.close()

    def submit(self, task: Task) -> "Future[Result]":
        """Put a task into the scheduler's queue."""
        future: Future[Result] = self._executor.submit(self._job_of(task), task)
        return future

    def release(self, future: "Future[Result]") -> None:
        """Do nothing: a task that ended its workers is one that failed, as the scheduler tells it."""


def check_scheduler(address: str) -> None:
    """Knock at the address: Dask's own client starts threads first, and is slow to give up.

    Raises:
        UserError: `distributed` is not installed, it is no address, or nobody listens there.
    """
    require("dask", "--scheduler")
    try:
        parts = urlsplit(address)
        host, port = parts.hostname, parts.port
    except ValueError:
        host = port = None
    if host is None or port is None or parts.scheme not in _SCHEMES:
        raise UserError(f"no Dask scheduler answers at {address}, which is no address: write it as tcp://HOST:8786")
    try:
        socket.create_connection((host, port), timeout=_CONNECT_S).close()
    except OSError as error:
        raise UserError(f"no Dask scheduler answers at {address} ({error or type(error).__name__})") from None
