"""Parameters are changed as the user answers, and a file keeps those from before."""

import io
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from companion.check.command import set_advised
from companion.check.findings import Finding, Level, keep, read_kept
from link.errors import UserError


def test_second_change_keeps_the_values_from_before_the_first(tmp_path: Path) -> None:
    path = tmp_path / "before.json"
    keep(path, {"A": 1.0, "B": 2.0})
    keep(path, {"B": 5.0, "C": 3.0})
    assert read_kept(path) == {"A": 1.0, "B": 2.0, "C": 3.0}


def test_values_from_before_stay_where_their_file_cannot_be_written_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "before.json"
    keep(path, {"A": 1.0})

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(UserError, match="No space left"):
        keep(path, {"B": 2.0})
    assert read_kept(path) == {"A": 1.0}
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("place", ["none/before.json", "file/before.json", "before.json/"])
def test_place_for_the_values_that_is_none_is_told(place: str, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    (tmp_path / "before.json").mkdir()
    with pytest.raises(UserError, match="before"):
        keep(tmp_path / place, {"A": 1.0})


@pytest.mark.parametrize("text", ["", "[1]", '{"A": "x"}', '{"A": NaN}', '{"A": null}'])
def test_other_files_are_refused_with_their_name(text: str, tmp_path: Path) -> None:
    path = tmp_path / "other.json"
    path.write_text(text)
    with pytest.raises(UserError, match=r"other\.json"):
        read_kept(path)


def test_file_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be read"):
        read_kept(tmp_path / "none.json")


@pytest.mark.parametrize(("answer", "is_written"), [("n", False), ("y", True)])
def test_parameters_are_written_only_after_a_yes_and_a_no_is_no_error(
    answer: str, *, is_written: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: dict[str, float] = {}

    def write(name: str, value: float) -> bool:
        written[name] = value
        return True

    reader = SimpleNamespace(facts=lambda: SimpleNamespace(parameters={"A": 1.0}))
    session = SimpleNamespace(reader=reader, read_parameter=lambda _: 1.0, set_parameter=write)
    findings = [Finding(name="A", level=Level.WARN, found="1", advice="A", set_to=2.0)]
    monkeypatch.setattr("sys.stdin", io.StringIO(f"{answer}\n"))
    set_advised(cast("Any", session), findings, tmp_path / "before.json", asks=True)
    assert written == ({"A": 2.0} if is_written else {})
    assert (tmp_path / "before.json").exists() is is_written


def test_question_that_nobody_can_answer_is_a_users_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    session = SimpleNamespace(reader=SimpleNamespace(facts=lambda: SimpleNamespace(parameters={"A": 1.0})))
    findings = [Finding(name="A", level=Level.WARN, found="1", advice="A", set_to=2.0)]
    for stdin in (io.StringIO(""), None):
        monkeypatch.setattr("sys.stdin", stdin)
        with pytest.raises(UserError, match="add --yes"):
            set_advised(cast("Any", session), findings, tmp_path / "before.json", asks=True)
    assert not (tmp_path / "before.json").exists()
