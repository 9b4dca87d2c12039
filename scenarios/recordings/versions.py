"""What a result depends on beside scenario, seed and configuration: this project's sources and the numerics."""

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from link.compiled import source_digest

_PACKAGES = ("companion", "link", "scenarios", "sim_autopilot")
_NUMERICS = ("daqp", "filterpy", "numba", "numpy", "osqp", "pymavlink", "scipy")


@cache
def sources() -> str:
    """Return a text that changes with any source of this project."""
    root = Path(__file__).resolve().parents[2]
    folders = {file.parent for package in _PACKAGES for file in (root / package).rglob("*.py")}
    return f"{source_digest(sorted(folders)):012x}"


def versions() -> dict[str, str]:
    """Return the versions by name, `sources` for this project's own."""
    found = {name: _version(name) for name in _NUMERICS}
    return {"sources": sources(), "python": platform.python_version(), "machine": platform.machine()} | found


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return "not installed"
