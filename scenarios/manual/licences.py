"""The page of licences, from what the installed packages of the drone's lock say of themselves."""

import re
from collections import defaultdict
from email.message import Message
from importlib.metadata import metadata
from pathlib import Path
from typing import cast

from scenarios.manual.markdown import page, table

ROOT = Path(__file__).parents[2]
LOCK = ROOT / "requirements-companion.lock"
TEXT = """What `make setup EXTRA=companion` installs on a drone, and under which licence, as each package says it.
Decklander itself is under Apache-2.0."""
_TEXT_MAX = 40  # a longer entry is the licence itself
_REQUIREMENT = re.compile(r"^([a-z0-9._-]+)==", re.MULTILINE)


def packages() -> list[str]:
    """Return the names in the drone's lock."""
    return sorted(set(_REQUIREMENT.findall(LOCK.read_text(encoding="utf-8"))))


def licence_of(package: str) -> str:
    """Return what an installed package says of its licence: as an expression, by its classifiers, or in words."""
    said = cast("Message", metadata(package))  # which it is, and its protocol has no `get`
    if expression := said.get("License-Expression"):
        return str(expression)
    classifiers = [str(one).split(" :: ")[-1] for one in said.get_all("Classifier") or [] if one.startswith("License")]
    if classifiers:
        return ", ".join(classifiers)
    words = str(said.get("License") or "")
    return words if 0 < len(words) <= _TEXT_MAX else "not said"


def licences_page() -> str:
    """Return the page, a line a licence."""
    licences: defaultdict[str, list[str]] = defaultdict(list)
    for name in packages():
        licences[licence_of(name)].append(name)
    rows = ((licence, ", ".join(names)) for licence, names in sorted(licences.items()))
    return page("Licences", TEXT, table(("licence", "packages"), rows))
