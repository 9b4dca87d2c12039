import json
from collections.abc import Callable, Iterable, Iterator
from typing import NoReturn

import pytest

from link.program.cli import run_app
from link.program.exit_codes import EXIT_INTERRUPTED
from scenarios.app import app
from scenarios.faults.retry import Retried, RetryCase, lost
from scenarios.processes import pool
from scenarios.processes.local_workers import LocalWorkers
from scenarios.rare import splitting


def broken_off_after_one(
    _: LocalWorkers[RetryCase, Retried],
    tasks: Iterable[RetryCase],
    *,
    lost: Callable[[RetryCase, str], Retried],  # noqa: ARG001 (as `run_tasks` has it)
) -> Iterator[Retried]:
    yield nothing_flown(next(iter(tasks)))
    raise KeyboardInterrupt


def nothing_flown(case: RetryCase) -> Retried:
    return lost(case, "no landing")


def test_retries_that_are_flown_are_told_when_the_others_are_broken_off(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(pool, "run_tasks", broken_off_after_one)
    assert run_app("scenarios", app, ["retries", "--seeds", "3", "--firmware", "px4", "--json"]) == EXIT_INTERRUPTED
    printed = capsys.readouterr()
    assert [row["seeds"] for row in json.loads(printed.out)["groups"]] == [1]
    assert printed.err == "broken off: 1 of 12 descents are flown\n"


def test_splitting_that_is_broken_off_says_that_nothing_is_kept(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def broken_off(*_: object) -> NoReturn:
        raise KeyboardInterrupt

    monkeypatch.setattr(splitting, "split", broken_off)
    assert run_app("scenarios", app, ["rare", "straight_5", "--workers", "1"]) == EXIT_INTERRUPTED
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("broken off: ")
