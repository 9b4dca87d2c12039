import json
from collections.abc import Callable, Iterable, Iterator

import pytest

from link.program.cli import run_app
from link.program.exit_codes import EXIT_INTERRUPTED
from scenarios.app import app
from scenarios.processes import pool
from scenarios.processes.local_workers import LocalWorkers
from scenarios.sortie.task import FlownSortie, SortieTask, lost_sortie


def broken_off_after_two(
    _: LocalWorkers[SortieTask, FlownSortie],
    tasks: Iterable[SortieTask],
    *,
    lost: Callable[[SortieTask, str], FlownSortie],  # noqa: ARG001 (as `run_tasks` has it)
) -> Iterator[FlownSortie]:
    second, first = list(tasks)[1::-1]
    yield lost_sortie(second, "no sortie")
    yield lost_sortie(first, "no sortie")
    raise KeyboardInterrupt


def test_sorties_that_are_flown_are_told_when_the_others_are_broken_off(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(pool, "run_tasks", broken_off_after_two)
    assert run_app("scenarios", app, ["sortie", "straight_10", "--seeds", "5", "--json"]) == EXIT_INTERRUPTED
    printed = capsys.readouterr()
    table = json.loads(printed.out)
    assert [row["seed"] for row in table["sorties"]] == [1, 2]
    assert printed.err == "broken off: 2 of 5 sorties are flown\n"
    assert table["total"]["without a contact after lift-off"] == 0  # neither was flown
