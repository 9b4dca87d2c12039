"""MAVProxy without a screen: commands go in as they are typed, and what it prints is waited for."""

import re
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_MODULES = "link,log,wp,rally,fence,ftp,param,arm,mode,misc,rc,cmdlong,calibration"
_LIMIT_S = 30.0


class MavProxy:
    """A running MAVProxy."""

    def __init__(self, process: "subprocess.Popen[str]") -> None:
        self._process = process
        self._printed = ""
        self._more = threading.Condition()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def ask(self, command: str, answer: str) -> str:
        """Type a command and return the first text from then on that matches `answer`.

        Raises:
            TimeoutError: none did.
        """
        with self._more:
            begin = len(self._printed)
        self.type(command)
        return self.heard(answer, begin)

    def type(self, command: str) -> None:
        """Type a command."""
        assert self._process.stdin is not None
        self._process.stdin.write(f"{command}\n")
        self._process.stdin.flush()

    def heard(self, answer: str, begin: int = 0) -> str:
        """Return the first text printed since `begin` that matches `answer`.

        Raises:
            TimeoutError: none did.
        """
        with self._more:
            if not self._more.wait_for(lambda: re.search(answer, self._printed[begin:]), _LIMIT_S):
                raise TimeoutError(f"{answer!r} is not in {self._printed[begin:]!r}")
            found = re.search(answer, self._printed[begin:])
        assert found is not None
        return found.group()

    def end(self) -> None:
        """Stop it."""
        self._process.kill()
        self._process.wait()
        self._reader.join()
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.close()
        self._process.stdout.close()

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            with self._more:
                self._printed += line
                self._more.notify_all()


@contextmanager
def mavproxy(master: str, folder: Path) -> Iterator[MavProxy]:
    """Run MAVProxy on `master` for as long as the block lasts, its files in `folder`."""
    program = Path(sys.executable).with_name("mavproxy.py")
    command = [sys.executable, "-u", str(program), f"--master={master}", f"--state-basedir={folder}"]
    process = subprocess.Popen(
        [*command, f"--default-modules={_MODULES}"],
        cwd=folder,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    running = MavProxy(process)
    try:
        yield running
    finally:
        running.end()
