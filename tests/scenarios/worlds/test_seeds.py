"""The rule of the seeds: to work with, held back, and held back no more."""

from pathlib import Path

import pytest

from link.errors import UserError
from scenarios.worlds.seeds import (
    FLOWN_FILE,
    HELD_BACK_FROM,
    SEEDS_END,
    FlownRange,
    add_flown,
    check_not_flown,
    check_seeds,
    check_world,
    read_flown,
    release,
)

FLOWN = FlownRange(slice="world", first_seed=600_000, seeds=200, release=release(), commit="0123456789abcdef")


@pytest.mark.parametrize(
    ("first", "last", "held_back"),
    [(0, 1, False), (1, HELD_BACK_FROM - 1, False), (HELD_BACK_FROM, SEEDS_END - 1, True)],
)
def test_seeds_of_one_kind_are_taken(first: int, last: int, *, held_back: bool) -> None:
    check_seeds(range(first, last + 1), held_back=held_back)


@pytest.mark.parametrize(
    ("first", "last", "held_back", "told"),
    [
        (HELD_BACK_FROM - 1, HELD_BACK_FROM, False, "mix"),
        (HELD_BACK_FROM - 1, HELD_BACK_FROM, True, "mix"),
        (HELD_BACK_FROM, HELD_BACK_FROM, False, "give --held-back"),
        (1, 100, True, "leave it out"),
        (SEEDS_END - 1, SEEDS_END, True, f"below {SEEDS_END}, not {SEEDS_END}"),
        (SEEDS_END, SEEDS_END + 5, False, f"below {SEEDS_END}"),
    ],
)
def test_other_seeds_are_refused_in_one_line(first: int, last: int, told: str, *, held_back: bool) -> None:
    with pytest.raises(UserError, match=told) as refusal:
        check_seeds(range(first, last + 1), held_back=held_back)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("seeds", [range(599_000, 600_001), range(600_199, 600_300), range(600_050, 600_051)])
def test_release_flies_a_held_back_seed_once(seeds: range) -> None:
    with pytest.raises(UserError, match=r"has flown seeds 600000 to 600199 of world \(commit 0123456\)"):
        check_not_flown(["world"], seeds, [FLOWN])


def test_other_seeds_slices_and_releases_are_free() -> None:
    check_not_flown(["world"], range(599_000, 600_000), [FLOWN])
    check_not_flown(["world"], range(600_200, 600_300), [FLOWN])
    check_not_flown(["world:urban"], range(600_000, 600_200), [FLOWN])
    check_not_flown(["world"], range(600_000, 600_200), [FLOWN.model_copy(update={"release": "0.0.1"})])


def test_what_is_written_down_is_read_back_behind_what_was_there(tmp_path: Path) -> None:
    file = tmp_path / "held_back.toml"
    file.write_text(FLOWN_FILE.read_text(encoding="utf-8"), encoding="utf-8")
    before = read_flown(file)
    other = FLOWN.model_copy(update={"slice": "world:urban"})
    add_flown([FLOWN], file)
    add_flown([other], file)
    assert read_flown(file) == (*before, FLOWN, other)


@pytest.mark.parametrize("first_seed", [7, SEEDS_END])
def test_file_with_a_range_that_is_not_held_back_is_refused(first_seed: int, tmp_path: Path) -> None:
    file = tmp_path / "held_back.toml"
    add_flown([FLOWN], file)
    file.write_text(file.read_text(encoding="utf-8").replace("600000", str(first_seed)), encoding="utf-8")
    with pytest.raises(UserError, match="first_seed"):
        read_flown(file)


def test_world_is_loaded_by_name_below_the_held_back_ones_or_once_it_was_flown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenarios.worlds.seeds.read_flown", lambda: (FLOWN,))
    check_world("world", 0)
    check_world("world", HELD_BACK_FROM - 1)
    check_world("world", 600_199)
    for slice_name, seed in (("world", 600_200), ("world:urban", 600_000)):
        with pytest.raises(UserError, match="is held back"):
            check_world(slice_name, seed)
    with pytest.raises(UserError, match=f"below {SEEDS_END}"):
        check_world("world", SEEDS_END)
