"""The unit that a name ends with, in the way that people write it."""

UNITS = {
    "_m2_s5": "m²/s⁵",
    "_m2_s4": "m²/s⁴",
    "_m2_s3": "m²/s³",
    "_rad2_s": "rad²/s",
    "_m_s3": "m/s³",
    "_m_s2": "m/s²",
    "_rad_s": "rad/s",
    "_rad_m": "rad/m",
    "_1_s2": "1/s²",
    "_1_s": "1/s",
    "_m2_s": "m²/s",
    "_m_s": "m/s",
    "_m2": "m²",
    "_rad": "rad",
    "_deg": "degrees",
    "_hz": "Hz",
    "_mb": "MB",
    "_ns": "ns",
    "_m": "m",
    "_s": "s",
}
"""The longer ones first: the first that fits is right."""


def unit_of(name: str) -> str:
    """Return the unit of the value called `name`; empty where it has none."""
    return next((unit for ending, unit in UNITS.items() if name.endswith(ending)), "")
