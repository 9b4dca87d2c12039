"""Variables of the environment that would change nothing of what is flown."""

import pytest

from link.program.cli import run_app
from scenarios.app import app

SPEED, SLOPE = "DECKLANDER_SCENARIO__TRACK__SPEED_M_S", "DECKLANDER_COMPANION__DESCENT__CONE__SLOPE"


@pytest.mark.parametrize(
    ("command", "variable"),
    [
        ("campaign straight_5 --seeds 1", SPEED),
        ("sortie straight_10", SPEED),
        ("falsify world:urban", SPEED),
        ("rare straight_5", SPEED),
        ("retries straight_5", SPEED),
        ("bench", SPEED),
        ("attack", SPEED),
        ("rare straight_5", SLOPE),
        ("run straight_5 --lockstep", SLOPE),
        ("fly straight_5", SLOPE),
    ],
)
def test_variable_without_effect_is_refused(
    command: str, variable: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(variable, "0.5")
    assert run_app("scenarios", app, command.split()) == 2
    assert capsys.readouterr().err.startswith(f"scenarios: environment: {variable} would change nothing here: unset it")
