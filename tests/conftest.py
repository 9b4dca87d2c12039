"""Options of the whole test run, examples that are the same in each run, Ctrl-C, and a disk that is soon full."""

import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

from link.program.clock import collect_rarely, spare_present_objects
from link.program.start import ONE_THREAD

os.environ.update(ONE_THREAD | os.environ)  # as the programs do, before any test's numerics are loaded

settings.register_profile("repeatable", derandomize=True, deadline=None)
settings.register_profile("quick", derandomize=True, deadline=None, max_examples=20)  # make check
settings.register_profile("anew", deadline=None)  # make fuzz
settings.load_profile("repeatable")


def pytest_configure() -> None:
    """Heed Ctrl-C: a shell has what it starts in the background ignore it, and so would all that the tests start."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    collect_rarely()  # until all tests are loaded


def pytest_collection_finish() -> None:
    """Spare the garbage collector what stays for the whole run: some thousand tests and all that they import."""
    spare_present_objects()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--update-golden", action="store_true", help="Rewrite tests/golden and print what changed.")


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 200 kB."""
    mount, umount = shutil.which("mount"), shutil.which("umount")
    if os.geteuid() != 0 or mount is None or umount is None:
        pytest.skip("only root may mount a small disk")
    if subprocess.run([mount, "-t", "tmpfs", "-o", "size=200k", "none", str(tmp_path)], check=False).returncode:
        pytest.skip("no disk can be mounted here")
    yield tmp_path
    subprocess.run([umount, str(tmp_path)], check=True)
