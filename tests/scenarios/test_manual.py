"""The manual builds without a warning and without the network; what is made from the program is all there."""

import re
from pathlib import Path

import pytest

from companion.config.companion import CompanionConfig
from companion.situation.phases import TRANSITIONS, Phase
from link.payloads.cdr import ROS_TYPES
from link.program.toml_config import StrictModel
from scenarios.catalogue.catalogue import list_presets
from scenarios.config import Scenario
from scenarios.manual.commands import PROGRAMS, helps
from scenarios.manual.folders import PACKAGES, folders_of
from scenarios.manual.pages import PAGES, fetched_from_elsewhere, with_whole_options
from scenarios.manual.phase_chart import FROM_ANYWHERE, PLACES, arrows, phase_chart
from scenarios.manual.settings import keys_of, meaning_of, tables_of
from sim_autopilot.runtime.config import SimAutopilotConfig

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGE_FILES = ["README.md", *(f"docs/{path.name}" for path in DOCS.glob("*.md"))]


@pytest.mark.parametrize(
    ("path", "model"),
    [
        ("reference/companion.md", CompanionConfig),
        ("reference/sim_autopilot.md", SimAutopilotConfig),
        ("reference/scenario.md", Scenario),
    ],
)
def test_reference_has_every_key_of_a_configuration(path: str, model: type[StrictModel]) -> None:
    text = PAGES[path]()
    for table in tables_of(model, elsewhere={CompanionConfig} - {model}):
        part = text.split(f"[{table.path.removesuffix('[]')}]" if table.path else "# The file itself")[1:]
        if table.model is CompanionConfig and table.path:
            continue
        for key in keys_of(table.model):
            assert any(f"| `{key}` |" in one for one in part), (table.path, key)


@pytest.mark.parametrize("model", [CompanionConfig, SimAutopilotConfig, Scenario])
def test_every_setting_has_a_meaning(model: type[StrictModel]) -> None:
    for table in tables_of(model, elsewhere={CompanionConfig} - {model}):
        missing = [key for key in keys_of(table.model) if not meaning_of(table.model, key)]
        assert missing == [], table.path


def test_every_folder_says_what_is_in_it() -> None:
    assert [folder for package in PACKAGES for folder, text in folders_of(package) if not text] == []


def test_reference_has_every_command() -> None:
    names = {name for name, _ in helps()}
    assert {*PROGRAMS, "companion check", "scenarios run", "scenarios view", "scenarios campaign"} <= names
    assert all(text.startswith(f"Usage: {name} ") for name, text in helps())


def test_no_help_has_a_value_of_a_kind_that_only_typer_knows() -> None:
    for name, text in helps():
        assert " range>" not in text, name


@pytest.mark.slow
def test_wire_reference_has_every_type_and_what_the_companion_sends() -> None:
    text = PAGES["reference/wire.md"]()
    for ros_type in ROS_TYPES.values():
        assert f"`{ros_type}`" in text


def test_phase_chart_has_every_phase_and_event_and_is_the_same_each_time() -> None:
    chart = phase_chart()
    assert set(PLACES) == set(Phase)
    assert sum(len(events) for events in arrows().values()) == sum(e is not FROM_ANYWHERE for _, e in TRANSITIONS)
    for (_, event), phase in TRANSITIONS.items():
        assert phase.value in chart
        assert event is FROM_ANYWHERE or event.value in chart
    assert phase_chart() == chart


def test_presets_of_the_page_are_those_that_there_are() -> None:
    page = (DOCS / "own_scenario.md").read_text()
    rows = dict(re.findall(r"^\| `(\w+)` \| (`.*) \|$", page, re.MULTILINE))
    listed = list_presets()
    assert {section: set(re.findall(r"`(\w+)`", cell)) for section, cell in rows.items()} == {
        section: set(names) for section, names in listed.items()
    }


@pytest.mark.parametrize("page", PAGE_FILES)
def test_files_that_a_page_leads_to_are_there_without_the_manual_being_built(page: str) -> None:
    path = ROOT / page
    for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", path.read_text(encoding="utf-8")):
        assert (path.parent / target).exists(), target


@pytest.mark.parametrize(
    ("tag", "fetches"), [('src="assets/own.js"', False), ('src="https://there.invalid/x.js"', True)]
)
def test_what_a_page_would_fetch_is_found(tag: str, fetches: bool) -> None:
    assert (fetched_from_elsewhere(f"<p>text</p><script {tag}></script>") is not None) is fetches


def test_options_within_a_line_are_kept_whole_and_blocks_of_code_are_not_touched() -> None:
    block = "<pre><code>check --speed-max 5</code></pre>"
    found = with_whole_options(f"<p><code>check --speed-max 5</code></p>{block}")
    assert found == f'<p><code>check <span class="word">--speed-max</span> 5</code></p>{block}'


@pytest.mark.parametrize("page", sorted(DOCS.glob("*.md")), ids=lambda page: page.name)
def test_an_empty_line_ends_each_table_or_the_next_line_would_be_a_row_of_it(page: Path) -> None:
    lines = [line.strip() for line in page.read_text(encoding="utf-8").splitlines()]
    rows = [line.startswith("|") for line in lines]
    swallowed = [after for row, after in zip(rows, lines[1:], strict=False) if row and after and after[0] != "|"]
    assert swallowed == []
