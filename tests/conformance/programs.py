"""The stand-in as a process of its own, several times faster than real time, and clients run against it."""

import select
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from scenarios.processes.programs import free_port, free_tcp_endpoint, free_udp_port

SPEED = 4.0
"""Simulated seconds a second: the clients' setpoints, at 20 Hz of their own time, still come in time."""
_READY_S = 90.0
"""The first start of a machine compiles the kernels."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StandIn:
    """A running stand-in: the ports at which it speaks over UDP, and listens over TCP."""

    firmware: str
    udp_port: int
    tcp_port: int


@contextmanager
def stand_in(firmware: str, speed: float = SPEED) -> Iterator[StandIn]:
    """Run `sim-autopilot` for as long as the block lasts."""
    here = StandIn(firmware=firmware, udp_port=free_udp_port(), tcp_port=free_port())
    links = ("--mavlink", f"udpout:127.0.0.1:{here.udp_port}", "--mavlink", f"tcpin:127.0.0.1:{here.tcp_port}")
    zenoh = ("--listen", free_tcp_endpoint())
    command = [sys.executable, "-m", "sim_autopilot", "--firmware", firmware, "--instant", "--speed", str(speed)]
    process = subprocess.Popen([*command, *links, *zenoh], stderr=subprocess.PIPE, text=True)
    try:
        assert process.stderr is not None
        readable, _, _ = select.select([process.stderr], [], [], _READY_S)
        assert readable
        assert "ready" in process.stderr.readline()
        yield here
        assert process.poll() is None, "the stand-in has ended by itself"
    finally:
        process.kill()
        process.communicate()


def outcomes(program: str, *arguments: str, limit_s: float = 280.0) -> dict[str, str]:
    """Run a client program of this package, and return what it says of each of its cases: `ok`, or what failed."""
    command = [sys.executable, "-m", f"tests.conformance.{program}", *arguments]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, timeout=limit_s, check=False)
    cases = [line.removeprefix("CASE ") for line in done.stdout.splitlines() if line.startswith("CASE ")]
    return {name: outcome for name, _, outcome in (case.partition("=") for case in cases)}


def wait(condition: Callable[[], bool], limit_s: float = 60.0) -> None:
    """Wait until `condition()` holds.

    Raises:
        TimeoutError: it did not within `limit_s`.
    """
    end_s = time.monotonic() + limit_s
    while not condition():
        if time.monotonic() > end_s:
            raise TimeoutError("the deadline has passed")
        time.sleep(0.02)  # MAVSDK tells what it has heard when asked
