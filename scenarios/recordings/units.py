"""The unit of a value by the ending of its name, as files and pages tell it."""

from collections.abc import Iterable

UNITS = {
    "_per_m": "1/m",
    "_m_s2": "m/s^2",
    "_m_s": "m/s",
    "_rad": "rad",
    "_hz": "Hz",
    "_ms": "ms",
    "_ns": "ns",
    "_m": "m",
    "_s": "s",
}
"""By the ending of a name, longer endings before those that they end in."""


def ending_of(name: str) -> str:
    """Return the ending of a name that tells its unit, empty if it has none."""
    return next((ending for ending in UNITS if name.endswith(ending)), "")


def units_of(names: Iterable[str]) -> dict[str, str]:
    """Return the unit of each name that has one."""
    return {name: UNITS[ending] for name in names if (ending := ending_of(name))}
