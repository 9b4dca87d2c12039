"""Landings that a search found to be unsafe, reduced: expected to be so until they are mended.

A case that is not unsafe any more fails its test, since the mark is strict: then its name is taken out of `UNSAFE`, and
it stays as a regression.
"""

import re
from pathlib import Path

import pytest

from scenarios.catalogue.catalogue import load_scenario
from scenarios.falsify.trial import Trial, fly_trial

CASES = sorted((Path(__file__).parent / "cases").glob("*.toml"))
UNSAFE: frozenset[str] = frozenset()
"""Today's; by the names of their files."""

_SEED = re.compile(r"^# Fly it: .* --seed (\d+)$", re.MULTILINE)


def case_of(path: Path) -> object:
    mark = pytest.mark.xfail(path.stem in UNSAFE, reason="unsafe until mended", raises=AssertionError, strict=True)
    return pytest.param(path, marks=mark, id=path.stem)


@pytest.mark.slow
@pytest.mark.parametrize("path", [case_of(path) for path in CASES])
def test_case_is_not_unsafe(path: Path) -> None:
    seed = _SEED.search(path.read_text(encoding="utf-8"))
    if seed is None:
        raise ValueError(f"{path.name} does not say its seed")
    scenario = load_scenario(str(path))
    outcome = fly_trial(Trial(index=0, seed=int(seed[1]), scenario=scenario.model_dump_json()))
    if outcome.error is not None:
        raise RuntimeError(outcome.error)
    assert not outcome.is_unsafe, f"margin {outcome.margin}: {outcome.reason}"


def test_every_case_that_is_marked_exists() -> None:
    assert {path.stem for path in CASES} >= UNSAFE
