"""What results depend on, of a tree made by hand."""

import subprocess
from pathlib import Path

import pytest

from scenarios.recordings import versions
from scenarios.recordings.versions import CHANGED, commit, sources


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A project with one source, the domain, and the record of what was flown."""
    worlds = tmp_path / "scenarios" / "worlds"
    worlds.mkdir(parents=True)
    for name in ("road.py", "odd.toml", "held_back.toml"):
        worlds.joinpath(name).write_text("# one\n", encoding="utf-8")
    monkeypatch.setattr(versions, "_ROOT", tmp_path)
    return tmp_path


def git(folder: Path, *words: str) -> str:
    command = ["git", "-C", folder, "-c", "user.name=A", "-c", "user.email=a@example.org", *words]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return done.stdout.strip()


@pytest.mark.parametrize(("name", "changes"), [("road.py", True), ("odd.toml", True), ("held_back.toml", False)])
def test_sources_change_with_what_draws_worlds_and_not_with_what_was_flown(
    name: str, tree: Path, *, changes: bool
) -> None:
    before = sources.__wrapped__()
    tree.joinpath("scenarios", "worlds", name).write_text("# two\n", encoding="utf-8")
    assert (sources.__wrapped__() != before) is changes


def test_commit_is_named_with_a_mark_where_a_file_differs_or_is_new(tree: Path) -> None:
    assert commit() is None
    git(tree, "init", "-q")
    git(tree, "add", "-A")
    git(tree, "commit", "-q", "-m", "one")
    head = git(tree, "rev-parse", "HEAD")
    assert commit() == head
    tree.joinpath("new.txt").write_text("", encoding="utf-8")
    assert commit() == head + CHANGED
