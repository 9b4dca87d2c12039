"""What helps and pages show is taken by the programs themselves: command lines, settings, files, JSON and Python."""

import json
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from pydantic import BaseModel

from companion.component.commands import COMMANDS
from companion.config.companion import CompanionConfig
from link.messages import Order
from link.payloads import json_messages
from link.program.cli import command_of
from link.program.near_names import models_in
from link.program.settings import COMPANION, PREFIXES, SCENARIO, SIM_AUTOPILOT, settings_of_environment
from link.program.settings import settings_of_options as settings_of
from link.program.toml_config import StrictModel, load_config, validate
from link.ros2.topic_map import TopicMap
from link.transports.device import parse_device
from link.zenoh.options import ZenohOptions
from scenarios.campaigns.cells import load_cell
from scenarios.catalogue.catalogue import load_changed_scenario, load_scenario
from scenarios.config import Scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.manual.commands import PROGRAMS, helps
from scenarios.recordings.result import score_run
from scenarios.scoring.score import Tier
from scenarios.vehicle_sources.pad import pad_geometry
from sim_autopilot.runtime.config import SimAutopilotConfig

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", *sorted(DOCS.glob("*.md"))]
TEXTS = {page.name: page.read_text(encoding="utf-8") for page in PAGES}

BLOCK = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
TITLED = re.compile(r'toml title="(\w+\.toml)"')
FILES = {
    title[1]: text for page in TEXTS.values() for kind, text in BLOCK.findall(page) if (title := TITLED.match(kind))
}
MODELS: Mapping[str, type[StrictModel]] = {
    "companion.toml": CompanionConfig,
    "sim.toml": SimAutopilotConfig,
    "topics.toml": TopicMap,
}
SCENARIO_FILES = sorted(FILES.keys() - MODELS.keys() - {"pad.toml"})

_PROGRAM = rf"(?:\.venv/bin/)?({'|'.join(PROGRAMS)})(?= |$)"
_STAND_INS = {"DEVICE": "/dev/ttyACM0,921600", "M_S": "5", "N": "3", "NAME": "straight_5"}
_SORTIE_WORLDS = "urban"
_STANDS_FOR_ADDRESS = re.compile(r"\b(HOST|VEHICLE)\b")


def lines_of(text: str) -> Iterator[str]:
    """Yield the command lines in the blocks of a page."""
    for kind, block in BLOCK.findall(text):
        if not kind:
            for line in block.replace("\\\n", " ").splitlines():
                if re.match(_PROGRAM, line):
                    yield line


def spans_of(text: str) -> list[str]:
    """Return what stands in a page's running text as code."""
    return re.findall(r"`([^`\n]+)`", BLOCK.sub("", text))


@cache
def program(name: str) -> Any:
    return command_of(import_module(PROGRAMS[name]).app)


def check_line(line: str) -> None:
    """Parse a command line as its program does, without running it, and check the values that only a run would."""
    plain = _STANDS_FOR_ADDRESS.sub("192.0.2.1", line.split(" > ", maxsplit=1)[0]).removesuffix(" ...")
    words = shlex.split(plain, comments=True)
    name, *arguments = [_STAND_INS.get(word, word) for word in words]
    name = name.removeprefix(".venv/bin/")
    command = program(name)
    with command.make_context(name, _with_values(arguments)) as context:
        _check_below(command, context)


def _with_values(arguments: Sequence[str]) -> list[str]:
    """Give the options that may stand alone their value, as `run_app` does."""
    following = [*arguments[1:], ""][: len(arguments)]
    pairs = zip(arguments, following, strict=True)
    return [
        part
        for word, after in pairs
        for part in ([word, "0"] if word in {"--foxglove", "--ros2"} and not after.isdigit() else [word])
    ]


def _check_below(command: Any, context: Any) -> None:
    _check_values(context.params)
    words = [*getattr(context, "_protected_args", ()), *context.args]
    if words and getattr(command, "commands", {}):
        name, part, arguments = command.resolve_command(context, words)
        with part.make_context(name, arguments, parent=context) as inner:
            _check_below(part, inner)


def _check_values(values: Mapping[str, Any]) -> None:
    scenario = next(
        (values[key] for key in ("name", "scenario", "road", "slice_name", "cell") if values.get(key)), None
    )
    for cell in [scenario, *(values.get("cells") or ())]:
        if isinstance(cell, str) and cell != _SORTIE_WORLDS and not _is_file(cell):
            load_cell(cell)
    for device in values.get("mavlink") or () if isinstance(values.get("mavlink"), list) else [values.get("mavlink")]:
        if device:
            parse_device(device)
    ZenohOptions(
        mode=values.get("mode"),
        connect=tuple(values.get("connect") or ()),
        listen=tuple(values.get("listen") or ()),
    )
    changes = values.get("changes")
    if changes and scenario:
        load_changed_scenario(scenario, changes)
    elif changes:
        load_config(None, CompanionConfig, settings_of(changes))


def _is_file(name: str) -> bool:
    """Return whether a scenario is a file; it must be one that a page shows, or that a program writes."""
    assert not name.endswith(".toml") or name in FILES or name.startswith("runs/"), name
    return name.endswith(".toml")


def check_mention(text: str) -> None:
    """Check that there is a command with all the options that are named."""
    name, *words = text.replace("|", " ").split()
    command = program(name.removeprefix(".venv/bin/"))
    for word in words:
        if word.startswith("--"):
            option = word.split("=")[0]
            assert option in {known for one in command.params for known in one.opts} | {"--help"}, text
        elif word in getattr(command, "commands", {}):
            command = command.commands[word]


@pytest.mark.slow
@pytest.mark.parametrize("name", PROGRAMS)
def test_each_help_ends_with_examples_that_its_command_takes(name: str) -> None:
    for command, text in helps():
        if command.split()[0] == name:
            assert "Examples:" in text, command
            for line in text.split("Examples:")[1].strip().splitlines():
                check_line(line)


@pytest.mark.parametrize("page", [name for name, text in TEXTS.items() if any(lines_of(text))])
def test_command_lines_of_a_page_are_taken_by_the_programs(page: str) -> None:
    for line in lines_of(TEXTS[page]):
        check_line(line)


def test_command_lines_of_the_services_are_taken_by_the_programs() -> None:
    units = list((DOCS / "systemd").glob("*.service"))
    assert units
    for unit in units:
        found = re.search(r"^ExecStart=/opt/decklander/(.*)$", unit.read_text(encoding="utf-8"), re.MULTILINE)
        assert found is not None, unit
        check_line(found[1])


@pytest.mark.parametrize("page", TEXTS)
def test_commands_and_options_that_the_text_names_exist(page: str) -> None:
    for span in spans_of(TEXTS[page]):
        if re.match(_PROGRAM, span) and "->" not in span:
            check_mention(span)


def test_a_line_that_a_program_would_refuse_is_found() -> None:
    for wrong in (
        "scenarios run strait_5",
        "scenarios run straight_5+wind=gale",
        "scenarios run straight_5 --sed 1",
        "scenarios run unheard_of.toml",
        "scenarios run straight_5 --set track.sped_m_s=6",
        "companion --mavlink 127.0.0.1:14540",
        "companion -e 127.0.0.1:7447",
        "companion --set descent.cone.slop=0.3",
    ):
        with pytest.raises(Exception, match=r"."):
            check_line(wrong)
    with pytest.raises(AssertionError):
        check_mention("scenarios campaign --sheduler")


@pytest.mark.parametrize("page", TEXTS)
def test_targets_and_variables_of_make_exist(page: str) -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target, variables in re.findall(r"(?:`|^)make (\w+)((?: [A-Z]+=[\w./]+)*)", TEXTS[page], re.MULTILINE):
        assert re.search(rf"^{target}:", makefile, re.MULTILINE), target
        for variable in re.findall(r"([A-Z]+)=", variables):
            assert f"$({variable})" in makefile or f"$(if $({variable})" in makefile, variable


@pytest.mark.parametrize("page", TEXTS)
def test_settings_that_a_page_names_exist(page: str) -> None:
    known = {key for model in (CompanionConfig, Scenario, SimAutopilotConfig) for key in _keys_below(model)}
    roots = {key for key in known if "." not in key} - {"link"}  # a package, too
    for span in spans_of(TEXTS[page]):
        found = re.fullmatch(r"([a-z]\w*(?:\.[a-z]\w*)+)(?: = .*)?", span)
        if found and found[1].split(".")[0] in roots and not re.search(r"\.(toml|json5?|py)$", found[1]):
            assert found[1] in known, found[1]


def _keys_below(model: type[BaseModel], table: str = "") -> Iterator[str]:
    for name, field in model.model_fields.items():
        yield f"{table}{name}"
        for below in models_in(field.annotation):
            yield from _keys_below(below, f"{table}{name}.")


@pytest.mark.parametrize("page", TEXTS)
def test_variables_of_the_environment_that_a_page_sets_are_settings(page: str) -> None:
    models: dict[str, type[StrictModel]] = {
        COMPANION: CompanionConfig,
        SIM_AUTOPILOT: SimAutopilotConfig,
        SCENARIO: Scenario,
    }
    for name, value in re.findall(rf"`((?:{'|'.join(PREFIXES)})__\w+)=([^`]+)`", TEXTS[page]):
        prefix = name.split("__")[0]
        validate(
            models[prefix], {}, source="", environment=settings_of_environment(prefix, models[prefix], {name: value})
        )


def test_every_toml_of_a_page_says_what_file_it_is() -> None:
    kinds = [kind for page in TEXTS.values() for kind, _ in BLOCK.findall(page) if kind.startswith("toml")]
    assert [kind for kind in kinds if not TITLED.fullmatch(kind)] == []


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (title[1], text)
        for page in TEXTS.values()
        for kind, text in BLOCK.findall(page)
        if (title := TITLED.match(kind)) and title[1] not in SCENARIO_FILES
    ],
)
def test_example_file_is_read_by_its_program(name: str, text: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text, encoding="utf-8")
    if name == "pad.toml":
        pad_geometry(tmp_path / name)
    else:
        load_config(tmp_path / name, MODELS[name])


@pytest.mark.parametrize("name", SCENARIO_FILES)
def test_example_scenario_is_one(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(FILES[name], encoding="utf-8")
    load_scenario(str(tmp_path / name))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["careful.toml", "poor_fix.toml"])
def test_example_scenario_with_another_companion_or_sensor_lands(name: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(FILES[name], encoding="utf-8")
    scenario = load_scenario(str(tmp_path / name))
    run = Lockstep(scenario, 1)
    run.run()
    assert score_run(scenario, 1, run.recording).tier is Tier.S3


def test_json_of_a_page_is_an_order_to_the_companion() -> None:
    found = [span for text in TEXTS.values() for span in spans_of(text) if span.startswith('{"')]
    assert len(found) >= 2
    for span in found:
        json_messages.decode(Order, span.encode())


def test_actions_for_qgroundcontrol_are_commands_of_the_component() -> None:
    actions = json.loads((DOCS / "qgroundcontrol" / "landing.json").read_text(encoding="utf-8"))["actions"]
    assert {action["compId"] for action in actions} == {191}
    assert {action["mavCmd"] for action in actions} <= set(COMMANDS)


@pytest.mark.slow
def test_python_of_a_page_runs_on_the_campaign_that_it_names(tmp_path: Path) -> None:
    examples = [text for page in TEXTS.values() for kind, text in BLOCK.findall(page) if kind == "python"]
    assert examples
    campaign = [sys.executable, "-m", "scenarios", "campaign", "world", "--seeds", "1", "--workers", "1"]
    runs = [[*campaign, "--out", "runs/world"], *([sys.executable, "-c", example] for example in examples)]
    for run in runs:
        subprocess.run(run, cwd=tmp_path, check=True, capture_output=True)
