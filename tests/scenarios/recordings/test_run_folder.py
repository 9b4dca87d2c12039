"""Each run has a folder of its own, and `latest` points to the newest."""

from pathlib import Path

import pytest

from link.errors import UserError
from scenarios.recordings.run_folder import run_folder


def test_runs_that_start_in_the_same_millisecond_have_folders_of_their_own(tmp_path: Path) -> None:
    folders = [run_folder(tmp_path, "straight_5") for _ in range(20)]
    assert len(set(folders)) == 20
    assert (tmp_path / "latest").resolve() == folders[-1].resolve()


def test_folder_that_cannot_be_made_is_told_with_what_to_change(tmp_path: Path) -> None:
    (tmp_path / "runs").write_text("a file", encoding="utf-8")
    with pytest.raises(UserError, match=r"runs: no folder can be made there \(.*\); choose another --out"):
        run_folder(tmp_path / "runs", "straight_5")
