"""Starting this project's programs as processes, listening to them, and leaving none of them behind."""

import os
import queue
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from types import TracebackType
from typing import IO, Self

import psutil  # type: ignore[import-untyped]  # it has no annotations

from link.program.interrupts import COMPILING
from scenarios.processes.programs import MODULES

DEADLINE_S = 90.0
"""Wall time for anything to happen; a loaded machine with two cores needs a tenth of it."""


class Lines:
    """The lines of a pipe as a thread reads them."""

    def __init__(self, pipe: IO[str]) -> None:
        self.all: list[str] = []
        self._new: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._reader = threading.Thread(target=self._read, args=(pipe,))
        self._reader.start()

    def wait_for(self, pattern: str) -> str:
        """Return the next line with `pattern` in it."""
        end_s = time.monotonic() + DEADLINE_S
        while True:
            try:
                line = self._new.get(timeout=max(end_s - time.monotonic(), 0.0))
            except queue.Empty:
                line = None
            assert line is not None, f"no line with {pattern!r} in {self.all}"
            if re.search(pattern, line):
                return line

    def finish(self) -> None:
        """Wait for the end of the pipe."""
        self._reader.join()

    def finished(self, timeout_s: float) -> bool:
        """Return whether the pipe ends within `timeout_s`."""
        self._reader.join(timeout_s)
        return not self._reader.is_alive()

    def _read(self, pipe: IO[str]) -> None:
        with pipe:
            for line in pipe:
                self.all.append(line.rstrip("\n"))
                self._new.put(line)
        self._new.put(None)


class Program:
    """One of the four programs, or a module by its name; both its outputs are read."""

    def __init__(self, name: str, arguments: Sequence[str], folder: Path | None) -> None:
        # by the launcher, so that nothing is left behind even when the tests themselves are killed
        command = [
            sys.executable,
            "-m",
            "scenarios.processes.launch",
            str(os.getpid()),
            MODULES.get(name, name),
            *arguments,
        ]
        self._process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=folder
        )
        assert self._process.stdout is not None
        assert self._process.stderr is not None
        self.out = Lines(self._process.stdout)
        self.err = Lines(self._process.stderr)

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def runs(self) -> bool:
        return self._process.poll() is None

    @property
    def told(self) -> list[str]:
        """The lines on stderr, but for the one that a slow computer's user is to be patient."""
        return [line for line in self.err.all if not line.endswith(COMPILING)]

    def send(self, number: signal.Signals) -> None:
        self._process.send_signal(number)

    def wait(self) -> int:
        """Return the exit code once it has ended and all of its lines are there."""
        code = self._process.wait(timeout=DEADLINE_S)
        self.out.finish()
        self.err.finish()
        return code

    def kill(self) -> None:
        """End it at once; nothing happens when it has ended."""
        children = self.children()
        self._process.kill()
        for child in children:
            _kill(child)
        self.wait()

    def children(self) -> list[psutil.Process]:
        """Return the processes that it has started."""
        try:
            found: list[psutil.Process] = psutil.Process(self.pid).children(recursive=True)
        except psutil.NoSuchProcess:
            return []
        return found


class Programs:
    """Starts programs; each is killed, by its own id, at the end of the `with` block.

    Args:
        folder: that they run in, None for the present one.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self._folder = folder
        self._programs: list[Program] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for program in self._programs:
            program.kill()

    def start(self, name: str, *arguments: str) -> Program:
        program = Program(name, arguments, self._folder)
        self._programs.append(program)
        return program


def _kill(process: psutil.Process) -> None:
    try:
        process.kill()
    except psutil.NoSuchProcess:
        return


def all_end(processes: Sequence[psutil.Process]) -> bool:
    """Return whether all of them end within the deadline."""
    _, alive = psutil.wait_procs(processes, timeout=DEADLINE_S)
    return not alive


def until(condition: Callable[[], bool], what: str) -> None:
    """Wait until `condition`, which itself waits a little, holds."""
    end_s = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < end_s, f"the deadline has passed: {what}"
