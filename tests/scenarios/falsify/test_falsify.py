import json
from collections.abc import Mapping
from pathlib import Path

import pytest

from link.errors import UserError
from scenarios.catalogue.catalogue import load_scenario
from scenarios.config import Scenario
from scenarios.falsify.falsify import CASE, FOUND, LANDINGS, Request, create_folder, falsify
from scenarios.falsify.search import Space
from scenarios.falsify.trial import Outcome

PLAIN = load_scenario("straight_5").with_run(time_limit_s=0.5)
"""Called off before it takes off, which is unsafe."""


def draw(_seed: int, chosen: Mapping[str, float]) -> Scenario:
    wind = PLAIN.wind.model_copy(update={"mean_m_s": 4.0 * chosen["wind"], "gust_m_s": chosen["gust"]})
    return PLAIN.model_copy(update={"wind": wind})


SPACE = Space(names=("gust", "wind"), draw=draw)


def request(workers: int) -> Request:
    return Request(slice="world", seed=1, landings=6, reduction=3, workers=workers)


@pytest.mark.slow
def test_everything_that_is_kept_is_the_same_on_any_number_of_processes(tmp_path: Path) -> None:
    kept = []
    for workers in (1, 2):
        folder = create_folder(tmp_path / str(workers))
        result = falsify(request(workers), SPACE, folder, lambda _part, _outcome: None)
        assert result.errors == 0
        kept.append([(folder / name).read_bytes() for name in (LANDINGS, FOUND, CASE)])
    assert kept[0] == kept[1]
    lines = [json.loads(line) for line in kept[0][0].splitlines()]
    assert [line["landing"] for line in lines] == list(range(1, result.landings + 1))
    assert load_scenario(str(folder / CASE)).wind.gust_m_s == 0.0
    assert result.found is not None
    assert lines[result.found.landing - 1]["tier"] == "unsafe"


def test_folder_that_holds_something_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "other").touch()
    with pytest.raises(UserError, match="not empty; choose another --out"):
        create_folder(tmp_path)


def test_what_was_found_is_kept_when_the_reduction_is_interrupted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    outcome = Outcome(margin=-0.5, tier="unsafe", reason="contact with the ground")
    batches = 0

    def fly(_flights: object, _asked: object, _is_last: object) -> list[Outcome]:
        nonlocal batches
        batches += 1
        if batches > 1:
            raise KeyboardInterrupt
        return [outcome]

    monkeypatch.setattr("scenarios.falsify.flights.Flights.__call__", fly)
    with pytest.raises(KeyboardInterrupt):
        falsify(request(1), SPACE, tmp_path, lambda _part, _outcome: None)
    assert "contact with the ground" in (tmp_path / FOUND).read_text(encoding="utf-8")
    assert load_scenario(str(tmp_path / FOUND)).wind.mean_m_s > 0.0
    assert len((tmp_path / LANDINGS).read_text(encoding="utf-8").splitlines()) == 1
