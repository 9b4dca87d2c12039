"""A campaign's folder on a full disk, and with lines that nobody has flown: one line says what to do."""

import errno
import json
import os
from pathlib import Path
from typing import Any

import pytest

from link.errors import UserError
from scenarios.campaigns.folder import create_folder, open_journal, read_landings, read_timing
from scenarios.campaigns.landing_task import Flown
from scenarios.campaigns.landings_file import write_rows
from scenarios.campaigns.plan import make_plan

ROW: dict[str, Any] = {"cell": "straight_5", "firmware": "px4", "seed": 1, "error": None, "tier": "S3", "margin": 0.5}


@pytest.fixture
def campaign(tmp_path: Path) -> Path:
    """A campaign's folder, with nothing flown."""
    return create_folder(tmp_path / "out", make_plan(["straight_5"], first_seed=1, seeds=2, config=None))


def write_lines(folder: Path, *changes: object) -> None:
    """Write a line for each of `changes`: what is no table as it is, else over a landing's."""
    lines = [{"wall_s": 1.0, "times": {}} | ROW | one if isinstance(one, dict) else one for one in changes]
    (folder / "landings.jsonl").write_text("".join(f"{json.dumps(line)}\n" for line in lines), encoding="utf-8")


@pytest.mark.parametrize(
    "wrong",
    [[1], {"cell": ["a"]}, {"seed": "x"}, {"seed": True}, {"error": 1}, {"wall_s": None}, {"times": {"cpu_s": "x"}}],
)
def test_line_that_is_no_landing_is_told_by_its_number(campaign: Path, wrong: object) -> None:
    write_lines(campaign, {}, wrong)
    for read in (read_landings, read_timing):
        with pytest.raises(UserError, match=r"landings\.jsonl: line 2 is no landing; delete it"):
            read(campaign)
    with pytest.raises(UserError, match="line 2 is no landing"), open_journal(campaign):
        pass


def test_line_in_bytes_that_are_no_text_is_told_in_a_line(campaign: Path) -> None:
    (campaign / "landings.jsonl").write_bytes(b'{"cell": "\xff' + b"x" * 5000 + b'"}\n')
    with pytest.raises(UserError, match="line 1 is no landing") as told:
        read_landings(campaign)
    assert len(str(told.value)) < 200 + len(str(campaign))


def test_landing_of_no_cell_of_the_campaign_is_told(campaign: Path) -> None:
    write_lines(campaign, {"cell": "circle_5"})
    with pytest.raises(UserError, match=r"'circle_5', which is not in campaign\.json"):
        read_landings(campaign)


def test_landings_whose_values_are_of_several_kinds_are_told(campaign: Path) -> None:
    write_lines(campaign, {}, {"seed": 2, "margin": "large"})
    with pytest.raises(UserError, match=r"landings\.jsonl: landings that do not fit each other"):
        read_landings(campaign)


def test_line_that_the_disk_takes_in_pieces_is_whole(campaign: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write = os.write
    monkeypatch.setattr(os, "write", lambda descriptor, data: write(descriptor, data[:7]))
    with open_journal(campaign) as journal:
        journal.add(Flown(row=ROW, wall_s=1.0))
    assert read_landings(campaign) == [ROW]


def test_full_disk_is_told_with_how_to_go_on(campaign: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "write", full)
    with (
        open_journal(campaign) as journal,
        pytest.raises(UserError, match=r"No space left .* make room, and go on with: scenarios campaign --resume"),
    ):
        journal.add(Flown(row=ROW, wall_s=1.0))


def test_results_that_a_full_disk_does_not_take_leave_no_half_of_a_file(small_disk: Path) -> None:
    (small_disk / "full").write_bytes(bytes(196_000))
    rows = [ROW | {"text": f"{number:050d}", "seed": number} for number in range(9999)]
    with pytest.raises(UserError, match=r"landings\.parquet: cannot be written .* make room"):
        write_rows(small_disk / "landings.parquet", rows, {})
    assert [path.name for path in small_disk.iterdir()] == ["full"]
