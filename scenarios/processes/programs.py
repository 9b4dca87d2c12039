"""The programs of a run as processes: started together, watched, and none of them left behind."""

import fcntl
import os
import resource
import signal
import socket
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import gettempdir
from types import TracebackType
from typing import Self

from link.errors import UserError
from link.program.settings import without_settings

MODULES = {
    "companion": "companion",
    "sim-autopilot": "sim_autopilot",
    "ground-vehicle": "scenarios.ground_vehicle",
    "scenarios": "scenarios",
    "pad-detector": "companion.eyes",
}
"""The module of each program, for `python -m`."""

_LAUNCHER = "scenarios.processes.launch"
_INTERRUPT_WAIT_S = 5.0
_TAIL_LINES = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Program:
    """A program of the run.

    Attributes:
        name: of its log file, and in messages.
        module: run by this interpreter with `-m`.
        arguments: of its command line.
    """

    name: str
    module: str
    arguments: Sequence[str]


class ProcessGroup:
    """Programs that live as long as the `with` block.

    Each writes its output to `<folder>/<name>.log`. On leaving the block each gets an interrupt, as from Ctrl-C,
    and is killed if it has not ended within five seconds. Should this process be killed, the kernel ends them.
    """

    def __init__(self, programs: Sequence[Program], folder: Path) -> None:
        self._programs = programs
        self._folder = folder
        self._processes: dict[str, subprocess.Popen[bytes]] = {}

    def __enter__(self) -> Self:
        try:
            for program in self._programs:
                self._start(program)
        except BaseException:
            self._stop()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stop()

    def check(self) -> None:
        """Raise when a program has ended by itself.

        Raises:
            UserError: with the program's name, exit code and last words.
        """
        for name, process in self._processes.items():
            code = process.poll()
            if code is not None:
                raise UserError(f"{name} {_describe_end(code)}: {self._last_words(name)}; see {self._log(name)}")

    def send(self, name: str, number: signal.Signals) -> None:
        """Send a signal to a program."""
        self._processes[name].send_signal(number)

    def limit_files(self, name: str, size_bytes: int) -> None:
        """Let a program write no file any further than that, as on a full disk; its log is one of them."""
        resource.prlimit(self._processes[name].pid, resource.RLIMIT_FSIZE, (size_bytes, size_bytes))

    def restart(self, program: Program) -> None:
        """Kill the program of this name without a word, and start it as it is now."""
        process = self._processes[program.name]
        process.kill()
        process.wait()
        self._start(program)

    def _start(self, program: Program) -> None:
        with self._log(program.name).open("wb") as log:
            self._processes[program.name] = subprocess.Popen(
                [sys.executable, "-m", _LAUNCHER, str(os.getpid()), program.module, *program.arguments],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                env=without_settings(os.environ),  # all that they are to do is in their arguments and files
            )

    def _stop(self) -> None:
        for process in self._processes.values():
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
        for process in self._processes.values():
            try:
                process.wait(timeout=_INTERRUPT_WAIT_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()

    def _log(self, name: str) -> Path:
        return self._folder / f"{name}.log"

    def _last_words(self, name: str) -> str:
        lines = self._log(name).read_text(encoding="utf-8", errors="replace").splitlines()
        return " | ".join(line.strip() for line in lines[-_TAIL_LINES:] if line.strip()) or "it said nothing"


def free_port(kind: socket.SocketKind = socket.SOCK_STREAM) -> int:
    """Return a port of loopback that is free now, of TCP by default."""
    with socket.socket(socket.AF_INET, kind) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def free_udp_port() -> int:
    """Return a UDP port of loopback that is free now."""
    return free_port(socket.SOCK_DGRAM)


def free_tcp_endpoint() -> str:
    """Return a Zenoh endpoint on loopback whose port is free now."""
    return f"tcp/127.0.0.1:{free_port()}"


def free_tcp_port(wanted: int) -> int:
    """Return a TCP port of loopback that is free now: `wanted`, if it is."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        try:
            probe.bind(("127.0.0.1", wanted))
        except OSError:
            return free_port()
    return wanted


_reserved: list[int] = []
"""Descriptors of this process's locks, which end with it."""


def reserve_tcp_port(wanted: int) -> int:
    """Return `wanted` where it is free and no other process has reserved it, else any free port of loopback.

    A run tells the address of its page seconds before anything listens there: two that started together told the same.
    """
    try:
        lock = os.open(Path(gettempdir()) / f"decklander-port-{wanted}.lock", os.O_CREAT | os.O_RDWR, 0o666)
        _reserved.append(lock)
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:  # somebody else's, or of another user
        return free_port()
    return free_tcp_port(wanted)


def _describe_end(code: int) -> str:
    return f"ended with exit code {code}" if code >= 0 else f"was ended by {signal.Signals(-code).name}"
