"""The table of behaviours names tests that there are."""

import re
from pathlib import Path

_TESTS = Path(__file__).parent
_DOCUMENT = _TESTS / "behaviours.md"


def test_every_behaviour_that_is_listed_has_the_test_that_it_names() -> None:
    named = set(re.findall(r"`(test_\w+)`", _DOCUMENT.read_text(encoding="utf-8")))
    there = {
        name
        for path in _TESTS.rglob("test_*.py")
        for name in re.findall(r"^def (test_\w+)", path.read_text(), re.MULTILINE)
    }
    assert len(named) > 80
    assert named <= there, sorted(named - there)
