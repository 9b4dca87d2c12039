"""How many landings a command may be asked for."""

import pytest

from link.program.cli import run_app
from scenarios.app import app


@pytest.mark.parametrize(
    "command",
    [
        "campaign straight_5 --seeds",
        "sortie straight_10 --seeds",
        "retries straight_5 --seeds",
        "rare straight_5 --particles",
        "table report --seeds",
    ],
)
def test_more_landings_than_can_be_listed_are_refused(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    *_, option = command.split()
    assert run_app("scenarios", app, [*command.split(), "1000000000"]) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"scenarios: {option} 1000000000: must be a whole number from ")
    assert " to 1000000 " in told
    assert told.count("\n") == 1
