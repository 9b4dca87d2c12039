"""The pages that a pilot reads say what the program does: reasons with their limits, parameters with their values."""

import re
from pathlib import Path

import pytest

from companion.check.firmwares import FIRMWARES
from companion.check.rules import ParameterRule
from companion.config.companion import CompanionConfig
from companion.core.reason_help import reason_helps
from companion.core.reasons import Reason
from companion.landing.decisions.feasibility import OBSTACLES
from link.mavlink.dialect import mavlink
from scenarios.manual.reasons import reasons_page
from tests.golden.reasons import CONDITIONS

SINK_M_S = CompanionConfig().descent.sink.rate_max_m_s
ARDUPILOT_RULES = FIRMWARES[mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA].rules_for(SINK_M_S)
PX4_RULES = FIRMWARES[mavlink.MAV_AUTOPILOT_PX4].rules_for(SINK_M_S)
DOCS = Path(__file__).parents[2] / "docs"
SPEEDS_M_S = (5.0, 8.0, 10.0)


def rows(page: str) -> list[list[str]]:
    """Return the cells of all tables of a page."""
    lines = (DOCS / page).read_text(encoding="utf-8").splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]


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


@pytest.mark.parametrize(("page", "rules"), [("px4.md", PX4_RULES), ("ardupilot.md", ARDUPILOT_RULES)])
def test_advised_parameters_are_those_of_the_check(page: str, rules: tuple[ParameterRule, ...]) -> None:
    expected = {
        tuple(spelling.name for spelling in rule.spellings): [f"{rule.advised(speed):g}" for speed in SPEEDS_M_S]
        for rule in rules
    }
    found = {tuple(re.findall(r"`(\w+)`", row[0])): row[1:4] for row in rows(page) if len(row) == 5 and "`" in row[0]}
    assert found == expected
