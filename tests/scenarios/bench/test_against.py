"""Two checkouts flown in turn: what is made of the pairs, and what cannot be compared."""

from pathlib import Path

import pytest

from link.errors import UserError
from link.program.cli import run_app
from link.program.exit_codes import EXIT_USER_ERROR
from scenarios.app import app
from scenarios.bench.against import HERE, Pair, against_lines, against_table, check_pairs, fly_pairs


def a_pair(before_s: float, now_s: float, *, is_same: bool = True) -> Pair:
    return Pair(seed=1, cpu_s=(before_s, now_s), simulated_s=(10.0, 10.0), is_same=is_same)


def test_median_is_of_the_ratios_and_within_its_interval() -> None:
    pairs = [a_pair(3.0, 1.0 + 0.1 * step) for step in range(15)]
    table = against_table(Path("before"), "straight_5", pairs)
    low, high = table["interval_95"]
    assert table["times_as_fast"] == pytest.approx(3.0 / 1.7, abs=1e-4)
    # Of 15 numbers in order the 4th and the 12th hold the median with 96.5 %, the narrowest that does.
    assert (low, high) == pytest.approx((3.0 / 2.1, 3.0 / 1.3), abs=1e-4)


def test_run_that_is_twice_as_long_may_take_twice_the_time() -> None:
    pair = Pair(seed=1, cpu_s=(1.0, 2.0), simulated_s=(10.0, 20.0), is_same=False)
    assert pair.ratio == pytest.approx(1.0)


def test_lines_tell_how_many_flew_the_same() -> None:
    pairs = [a_pair(1.0, 1.0, is_same=index != 2) for index in range(6)]
    assert against_lines(against_table(Path("before"), "straight_5", pairs))[-1].endswith("5 of 6")


@pytest.mark.slow
def test_checkout_flies_the_same_as_itself(tmp_path: Path) -> None:
    short = tmp_path / "short.toml"
    short.write_text('base = "straight_5"\nrun.time_limit_s = 0.2\n', encoding="utf-8")
    told: list[str] = []
    (pair,) = fly_pairs(HERE, str(short), [7], told.append)
    assert pair.is_same
    assert min(pair.cpu_s) > 0.0
    assert told == ["pair 1 of 1"]


def test_checkout_that_cannot_fly_says_why(tmp_path: Path) -> None:
    broken = tmp_path / "scenarios" / "catalogue"
    broken.mkdir(parents=True)
    for folder in (broken, broken.parent):
        (folder / "__init__.py").touch()
    (broken / "catalogue.py").write_text("load_scenario = 1 / 0\n", encoding="utf-8")
    with pytest.raises(UserError, match="cannot fly it: ZeroDivisionError"):
        fly_pairs(tmp_path, "straight_5", [1], lambda _: None)


def test_folder_that_is_no_checkout_and_too_few_pairs_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_app("scenarios", app, ["bench", "--against", str(tmp_path)]) == EXIT_USER_ERROR
    assert "is no checkout" in capsys.readouterr().err
    with pytest.raises(UserError, match="give 6 or more"):
        check_pairs(HERE, 5)
