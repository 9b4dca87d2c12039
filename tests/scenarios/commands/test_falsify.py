from pathlib import Path

import pytest

from link.program.cli import make_app, run_app
from scenarios.commands import bench, falsify

app = make_app("The search.")
falsify.register(app)
bench.register(app)  # with one command alone its name would be an argument


def scenarios(*args: object) -> int:
    return run_app("scenarios", app, [str(arg) for arg in args])


@pytest.mark.parametrize("name", ["straight_5", "world:nowhere", "urban"])
def test_what_is_no_slice_is_refused_with_those_there_are(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert scenarios("falsify", name) == 2
    error = capsys.readouterr().err
    assert f"'{name}' is no slice of the domain" in error
    assert "world:urban" in error


@pytest.mark.parametrize("seed", [500_000, 499_990])
def test_search_keeps_off_the_seeds_that_are_held_back(seed: int, capsys: pytest.CaptureFixture[str]) -> None:
    assert scenarios("falsify", "world", "--landings", 50, "--seed", seed) == 2
    assert "held back for published figures: give --seed 499950 or less" in capsys.readouterr().err
    assert scenarios("falsify", "world", "--landings", 600_000, "--seed", seed) == 2
    assert "give --seed and --landings that make 500000 or less" in capsys.readouterr().err


def test_folder_that_is_in_use_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "kept").touch()
    assert scenarios("falsify", "world", "--out", tmp_path) == 2
    assert "not empty" in capsys.readouterr().err


def test_part_that_no_quantity_has_is_refused_with_those_there_are(capsys: pytest.CaptureFixture[str]) -> None:
    assert scenarios("falsify", "world", "--only", "driver,gust") == 2
    error = capsys.readouterr().err
    assert "no quantity begins with 'gust.'" in error
    assert "driver, drone, link" in error
