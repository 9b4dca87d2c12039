"""The file that keeps parameters from before a change."""

from pathlib import Path

import pytest

from companion.check.findings import keep, read_kept
from link.errors import UserError


def test_second_change_keeps_the_values_from_before_the_first(tmp_path: Path) -> None:
    path = tmp_path / "before.json"
    keep(path, {"A": 1.0, "B": 2.0})
    keep(path, {"B": 5.0, "C": 3.0})
    assert read_kept(path) == {"A": 1.0, "B": 2.0, "C": 3.0}


@pytest.mark.parametrize("text", ["", "[1]", '{"A": "x"}', '{"A": NaN}', '{"A": null}'])
def test_other_files_are_refused_with_their_name(text: str, tmp_path: Path) -> None:
    path = tmp_path / "other.json"
    path.write_text(text)
    with pytest.raises(UserError, match=r"other\.json"):
        read_kept(path)


def test_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be read"):
        read_kept(tmp_path / "none.json")
