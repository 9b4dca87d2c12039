"""The pages that a pilot reads say what the program does: reasons with their limits, parameters with their values."""

import re
from pathlib import Path

import pytest

from companion.check.firmwares import FIRMWARES, Firmware
from companion.config.companion import CompanionConfig
from companion.core.reason_help import reason_helps
from companion.core.reasons import Reason
from companion.landing.decisions.feasibility import OBSTACLES
from scenarios.manual.parameters import SPEEDS_M_S, parameters_page
from scenarios.manual.reasons import reasons_page
from tests.golden.reasons import CONDITIONS

SINK_M_S = CompanionConfig().descent.sink.rate_max_m_s
DOCS = Path(__file__).parents[2] / "docs"


def test_each_reason_is_explained_and_what_ends_an_approach_or_forbids_it_has_a_remedy() -> None:
    helps = {one.reason: one for one in reason_helps(CompanionConfig())}
    assert set(helps) == set(Reason)
    assert all(one.meaning for one in helps.values())
    for condition in (*CONDITIONS, *OBSTACLES):
        assert helps[condition.reason].remedy, condition.reason


def test_the_page_of_reasons_says_what_ends_an_approach_or_forbids_it_and_what_to_do() -> None:
    page = reasons_page()
    for one in reason_helps(CompanionConfig()):
        if one.remedy and len(one.reason.value) <= 70:  # a longer message says itself what to do
            assert re.search(rf"`{one.reason.name}` \| .+ \| .+ \|$", page, re.MULTILINE), one.reason


@pytest.mark.parametrize("firmware", FIRMWARES.values(), ids=lambda one: one.name)
def test_the_page_of_parameters_has_each_that_the_check_judges_and_what_it_advises(firmware: Firmware) -> None:
    part = parameters_page().split(f"## {firmware.name}\n")[1].split("\n## ")[0]
    for rule in firmware.rules_for(SINK_M_S, launches=True):
        advised = " | ".join(f"{rule.advised(0.0, speed):g}" for speed in SPEEDS_M_S)
        assert f"`{rule.spellings[0].name}`" in part
        assert f"| {advised} | {rule.unit} | {rule.reason} |" in part


@pytest.mark.parametrize("page", ["px4.md", "ardupilot.md"])
def test_parameters_that_a_page_names_have_the_value_that_the_check_advises(page: str) -> None:
    text = (DOCS / page).read_text(encoding="utf-8")
    advised = {
        spelling.name: {f"{rule.advised(0.0, speed):g}" for speed in SPEEDS_M_S}
        for firmware in FIRMWARES.values()
        for rule in firmware.rules_for(SINK_M_S)
        for spelling in rule.spellings
    }
    told = [(name, value) for name, value in re.findall(r"`([A-Z_]+)` (\d+)(?!\d)", text) if name in advised]
    assert len(told) >= 4
    assert [(name, value) for name, value in told if value not in advised[name]] == []
