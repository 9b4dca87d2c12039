"""The rule of the seeds, at the command line and in the file that remembers what was flown."""

from pathlib import Path

import pytest

from link.errors import UserError
from scenarios.campaigns import held_back
from scenarios.campaigns.held_back import check_worlds, write_down_held_back
from scenarios.campaigns.plan import Plan, make_plan
from scenarios.recordings.versions import CHANGED
from scenarios.worlds import seeds
from tests.scenarios.campaigns.short import scenarios

COMMIT = "89abcdef" * 5


def plan(*cells: str, first_seed: int = 500_000, commit: str | None = COMMIT) -> Plan:
    return make_plan(cells or ("world",), first_seed=first_seed, seeds=50, config=None).model_copy(
        update={"commit": commit}
    )


@pytest.fixture
def flown_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file of its own in place of the repository's."""
    file = tmp_path / "held_back.toml"
    file.write_text("", encoding="utf-8")
    monkeypatch.setattr(held_back, "read_flown", lambda: seeds.read_flown(file))
    monkeypatch.setattr(held_back, "add_flown", lambda ranges: seeds.add_flown(ranges, file))
    return file


def test_held_back_worlds_are_flown_once_and_written_down_before(flown_file: Path) -> None:
    both = plan("world+firmware=px4", "world+firmware=ardupilot", "world:yard")
    check_worlds(both, held_back=True)
    write_down_held_back(both)
    assert [(one.slice, one.first_seed, one.seeds, one.commit) for one in seeds.read_flown(flown_file)] == [
        ("world", 500_000, 50, COMMIT),
        ("world:yard", 500_000, 50, COMMIT),
    ]
    for again in (both, plan("world:yard", first_seed=500_049)):
        with pytest.raises(UserError, match="flies a held-back seed once"):
            check_worlds(again, held_back=True)
    check_worlds(plan("world:yard", first_seed=500_050), held_back=True)


@pytest.mark.parametrize(("commit", "told"), [(None, "git repository"), (COMMIT + CHANGED, "clean working tree")])
@pytest.mark.usefixtures("flown_file")
def test_held_back_worlds_need_a_commit_that_can_be_named(commit: str | None, told: str) -> None:
    with pytest.raises(UserError, match=told):
        check_worlds(plan(commit=commit), held_back=True)


def test_worlds_to_work_with_need_no_commit() -> None:
    check_worlds(plan(first_seed=1, commit=None), held_back=False)


def test_scenarios_fly_any_seed() -> None:
    check_worlds(plan("straight_5", first_seed=499_990, commit=None), held_back=False)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("world", "--first-seed", 499_999, "--seeds", 2), "mix"),
        (("world", "straight_5", "--first-seed", 499_999, "--seeds", 2), "mix"),
        (("world:urban", "--first-seed", 500_000), "give --held-back"),
        (("world", "--first-seed", 999_999, "--seeds", 2), "below 1000000"),
        (("world", "--first-seed", 1_000_000), "below 1000000"),
        (("world", "--held-back"), "leave it out"),
        (("straight_5", "--held-back"), "is about the seeds of worlds"),
        (("world:nowhere",), "no slice of the worlds"),
        (("world+sensors=rtk",), "draws everything but its firmware"),
        (("world", "world"), "given twice"),
    ],
)
def test_campaign_of_other_worlds_is_refused_in_one_line_and_leaves_no_folder(
    words: tuple[object, ...], told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert scenarios("campaign", *words, "--out", tmp_path / "out") == 2
    printed = capsys.readouterr()
    assert told in printed.err
    assert printed.err.count("\n") == 1
    assert not (tmp_path / "out").exists()
