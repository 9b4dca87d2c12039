"""The presets that there are, as the catalogue's files have them."""

import tomllib
from importlib import resources


def list_presets(section: str) -> list[str]:
    """Return the names of the presets of `section`: sensors, wind, link, vehicle or system."""
    file = resources.files("scenarios") / "catalogue" / "presets" / f"{section}.toml"
    return sorted(tomllib.loads(file.read_text(encoding="utf-8")))
