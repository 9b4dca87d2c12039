"""A found case as a scenario file that `scenarios run` flies and `scenarios campaign` takes."""

import textwrap
from collections.abc import Sequence
from typing import Any

import tomli_w

from scenarios.config import Scenario

_SECTIONS = ("track", "sensors", "wind", "link", "vehicle", "system")
"""All stand in the file, those of nothing but defaults too: without them the catalogue's presets would be taken."""
_WIDTH = 120


def case_text(scenario: Scenario, notes: Sequence[str]) -> str:
    """Return the TOML of `scenario`: what differs from the defaults, under `notes` as comments.

    Args:
        scenario: whose name is the file's to give.
        notes: a paragraph each.
    """
    table: dict[str, Any] = scenario.model_dump(mode="json", exclude_defaults=True, exclude_none=True)
    table.pop("name")
    own = {key: value for key, value in table.items() if key not in _SECTIONS}
    sections = {key: table.get(key, {}) for key in _SECTIONS}
    sections["track"] = {"kind": scenario.track.kind} | sections["track"]
    lines = [line for note in notes for line in textwrap.wrap(note, _WIDTH - 2, break_long_words=False)]
    comment = "".join(f"# {line}\n" for line in lines)
    return f"{comment}\n{tomli_w.dumps(own | sections)}"
