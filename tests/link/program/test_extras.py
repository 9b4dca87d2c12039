"""Extras: pyproject.toml's are those that the commands ask for, and the base works without any of them."""

import importlib.util
import re
import subprocess
import sys
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest
from typer.main import get_command

from companion.config.companion import CompanionConfig
from companion.config.estimation import EstimatorKind
from companion.config.planning import SolverKind
from companion.runtime.build import build_node
from link.errors import UserError
from link.program.cli import run_app
from link.program.exit_codes import EXIT_USER_ERROR
from link.program.extras import EXTRAS
from link.zenoh.keys import Keys
from scenarios.app import app

ROOT = Path(__file__).parents[3]
PACKAGES = ("companion", "link", "scenarios", "sim_autopilot")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
BLOCKED = """
import sys

class Blocker:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {modules}:
            raise ModuleNotFoundError(f"{{name}} is of an extra")

sys.meta_path.insert(0, Blocker())
import companion.eyes.app
import companion.check.command, companion.runtime.loop, companion.recording.folder
import scenarios.app, scenarios.commands.ground_vehicle, scenarios.vehicle_sources.loop
import scenarios.wire.run, scenarios.wire.world, sim_autopilot.runtime.run
"""


@cache
def brought() -> Mapping[str, list[str]]:
    """Which distributions bring a module, of all that is installed."""
    return packages_distributions()


def distributions(requirements: list[str]) -> set[str]:
    names = (re.split(r"[\[><=]", requirement)[0] for requirement in requirements)
    return {name.lower() for name in names} - {"decklander"}


def asked_extras() -> set[tuple[str, str]]:
    """What asks for an extra in the sources: the extra, and the words of the user that need it."""
    sources = (path.read_text(encoding="utf-8") for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
    return {found for text in sources for found in re.findall(r'require\("(\w+)", "([^"]+)"\)', text)}


@pytest.mark.parametrize("extra", EXTRAS)
def test_modules_of_an_extra_come_with_it(extra: str) -> None:
    declared = distributions(PROJECT["optional-dependencies"][extra])
    of_modules = [{name.lower() for name in brought()[module]} for module in EXTRAS[extra]]
    assert all(names & declared for names in of_modules)  # two may bring one: OpenCV with windows and without
    assert declared <= set().union(*of_modules)
    assert not declared & distributions(PROJECT["dependencies"])


def test_all_has_every_extra() -> None:
    named = set(re.findall(r"\w+", PROJECT["optional-dependencies"]["all"][0].partition("[")[2]))
    for extra in list(named):
        named |= {part for one in PROJECT["optional-dependencies"][extra] for part in re.findall(r"\[(\w+)\]", one)}
    assert named | {"campaign", "sim"} == set(PROJECT["optional-dependencies"]) - {"all"}


def test_installation_names_every_command_and_with_an_extra_all_that_asks_for_it() -> None:
    table = (ROOT / "docs" / "install.md").read_text(encoding="utf-8")
    rows = dict(re.findall(r"^\| `\[?(\w+)\]?` \|(.*)\|$", table, re.MULTILINE))
    assert set(rows) == {"decklander", "all", *EXTRAS}
    words = set(re.findall(r"[\w-]+", " ".join(rows.values())))
    commands: dict[str, object] = vars(get_command(app))["commands"]
    assert words >= {*PROJECT["scripts"], *commands}
    for extra, asked in asked_extras():
        assert asked.removeprefix("scenarios ").split()[0] in rows[extra], asked


@pytest.mark.slow
def test_drone_vehicle_and_simulation_need_no_extra() -> None:
    modules = {module for extra in EXTRAS.values() for module in extra}
    done = subprocess.run([sys.executable, "-c", BLOCKED.format(modules=modules)], check=False, capture_output=True)
    assert done.returncode == 0, done.stderr.decode()


@pytest.mark.parametrize(
    ("arguments", "extra"),
    [
        (["campaign", "straight_5"], "campaign"),
        (["table", "runs/none"], "campaign"),
        (["compare", "runs/a", "runs/b"], "campaign"),
        (["faults"], "campaign"),
        (["retries"], "campaign"),
        (["falsify", "world"], "campaign"),
        (["rare", "world"], "campaign"),
        (["figures", "runs/none"], "report"),
        (["report", "runs/none"], "report"),
        (["view", "runs/none"], "view"),
        (["run", "straight_5", "--view"], "view"),
        (["eyes"], "camera"),
        (["camera", "straight_5+camera=day"], "camera"),
    ],
)
def test_command_names_the_extra_that_is_missing(
    arguments: list[str], extra: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    there = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None if name in EXTRAS[extra] else there(name))
    assert run_app("scenarios", app, arguments) == EXIT_USER_ERROR
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert f"install the extra '{extra}' (docs/install.md)" in error


@pytest.mark.parametrize(
    "choice",
    [{"estimator": {"kind": EstimatorKind.LKF}}, {"guidance": {"mpc": {"solver": SolverKind.OSQP}}}],
    ids=["lkf", "osqp"],
)
def test_configuration_names_the_extra_that_it_needs(
    choice: dict[str, object], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)
    with pytest.raises(UserError, match=r"the extra 'sim'"):
        build_node(CompanionConfig.model_validate(choice), Keys())
