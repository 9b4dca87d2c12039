"""A campaign's tasks on an existing Dask cluster; the only file that imports `distributed`."""

import importlib.util
import socket
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from link.errors import UserError
from scenarios.campaigns.landing_task import Flights, Flown, Task, failed

if TYPE_CHECKING:
    from distributed import Future

_SCHEMES = ("tcp", "tls")
_CONNECT_S = 10.0
_FIRST_WORKER_S = 30.0


def fly_on_dask(address: str, flights: Flights, tasks: Sequence[Task]) -> Iterator[Flown]:
    """Yield what came of all tasks in the order in which they are done.

    To be closed (`contextlib.closing`) where it may not be exhausted: that takes the rest off the cluster.

    Args:
        address: of the scheduler, such as tcp://192.168.1.5:8786.
        flights: the job; the workers need the same sources of this project as here.
        tasks: to be flown.

    Raises:
        UserError: `distributed` is not installed, the scheduler cannot be reached, it has no workers, or theirs are
            other sources.
    """
    check_scheduler(address)
    from distributed import Client, as_completed  # noqa: PLC0415 (an optional dependency)

    try:
        client = Client(address, timeout=_CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise UserError(f"no Dask scheduler answers at {address} ({error or type(error).__name__})") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=_FIRST_WORKER_S)
        except TimeoutError:
            raise UserError(f"the Dask scheduler at {address} has no workers") from None
        jobs = {cell: flights.only(cell) for cell in flights.scenarios}
        futures = {client.submit(jobs[task.cell], task, pure=False): task for task in tasks}
        try:
            for future in as_completed(list(futures), loop=client.loop):
                yield _flown(future, futures.pop(future))
        finally:
            client.cancel(list(futures))


def check_scheduler(address: str) -> None:
    """Knock at the address: Dask's own client starts threads first, and is slow to give up.

    Raises:
        UserError: `distributed` is not installed, it is no address, or nobody listens there.
    """
    if importlib.util.find_spec("distributed") is None:
        raise UserError("--scheduler needs Dask: install decklander[dask], here and on its workers")
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


def _flown(future: "Future[Flown]", task: Task) -> Flown:
    """Return the result of a finished task; one that ended its workers, or that they cannot load, is a failure."""
    match future.exception():
        case None:
            flown: Flown = future.result()
            return flown
        case UserError() as error:
            raise error
        case error:
            return Flown(row=failed(task, " ".join(f"{type(error).__name__}: {error}".split())), wall_s=0.0)
