"""What a result depends on beside scenario, seed and configuration: this project's sources and the numerics."""

import platform
import subprocess
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from link.compiled import file_digest

_PACKAGES = ("companion", "link", "scenarios", "sim_autopilot")
_DATA = ("scenarios/worlds/odd.toml",)  # decides which worlds there are; a campaign keeps its other scenarios itself
_NUMERICS = ("daqp", "filterpy", "numba", "numpy", "osqp", "pymavlink", "scipy")


_ROOT = Path(__file__).resolve().parents[2]
_GIT_S = 30.0
CHANGED = "-dirty"
"""Behind a commit from which the sources differ."""


@cache
def sources() -> str:
    """Return a text that changes with any source of this project."""
    files = [file for package in _PACKAGES for file in (_ROOT / package).rglob("*.py")]
    return f"{file_digest([*files, *(_ROOT / name for name in _DATA)]):012x}"


def commit() -> str | None:
    """Return which commit the sources are, `CHANGED` behind it where a file differs or is new; None if unknown."""
    head, status = _git("rev-parse", "HEAD"), _git("status", "--porcelain")
    return None if head is None or status is None else head + (CHANGED if status else "")


def _git(*words: str) -> str | None:
    """Return what git says about this project's folder, None where there is no git or no repository of its own."""
    if not (_ROOT / ".git").exists():
        return None
    command = ["git", "-C", str(_ROOT), *words]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=_GIT_S)
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()


def versions() -> dict[str, str]:
    """Return the versions by name, `sources` for this project's own."""
    found = {name: _version(name) for name in _NUMERICS}
    return {"sources": sources(), "python": platform.python_version(), "machine": platform.machine()} | found


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
