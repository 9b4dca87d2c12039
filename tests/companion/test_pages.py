"""The pages that a pilot reads say what the program does: aborts with their limits, parameters with their values."""

import math
import re
from pathlib import Path

import pytest

from companion.check.assessment import FIRMWARES
from companion.check.rules import ParameterRule
from companion.config.companion import CompanionConfig
from companion.landing.feasibility import OBSTACLES
from link.mavlink.dialect import mavlink
from tests.golden.reasons import CONDITIONS

SINK_M_S = CompanionConfig().descent.descent_rate_max_m_s
ARDUPILOT_RULES = FIRMWARES[mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA].rules_for(SINK_M_S)
PX4_RULES = FIRMWARES[mavlink.MAV_AUTOPILOT_PX4].rules_for(SINK_M_S)
DOCS = Path(__file__).parents[2] / "docs"
SPEEDS_M_S = (5.0, 8.0, 10.0)


def rows(page: str) -> list[list[str]]:
    """Return the cells of all tables of a page."""
    lines = (DOCS / page).read_text(encoding="utf-8").splitlines()
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]


@pytest.mark.parametrize("reason", [one.reason.value for one in CONDITIONS])
def test_each_abort_is_explained(reason: str) -> None:
    told = [row for row in rows("safety.md") if reason in row[0] and len(row) == 3]
    assert told
    assert all(row[-1] for row in told)


def test_each_reason_for_no_retry_is_explained() -> None:
    cells = " ".join(row[0] for row in rows("safety.md"))
    for obstacle in OBSTACLES:
        assert f"`{obstacle.reason.name}`" in cells


def test_the_aborts_limits_are_the_defaults() -> None:
    config, text = CompanionConfig(), " ".join(" ".join(row) for row in rows("safety.md"))
    for said in (
        f"no fix younger than {config.abort.fix_age_max_s:g} s",
        f"the last fix is older than {config.abort.alive_lost_fix_age_max_s:g} s",
        f"no better than {config.abort.position_std_max_m:g} m",
        f"{config.abort.own_age_max_s:g} s without a position",
        f"for {config.abort.fix_ahead_hold_s:g} s each of its fixes",
        f"more than {config.abort.fix_ahead_max_s:g} s before its stamp",
        f"{config.abort.tracking_stds_max:g} times as far off as gusts and the link put it",
        f"for {config.abort.tracking_hold_s:g} s",
        f"{config.descent.cone_radius_at_pad_m:g} m beside the pad's middle, and {config.descent.cone_slope:g} m more",
        f"more than {config.abort.near_speed_max_m_s:g} m/s",
        f"{config.chase.time_limit_s:g}, {config.descent.align_time_limit_s:g} and {config.descent.time_limit_s:g} s",
        f"more than {config.touchdown.lost_height_m:g} m",
        f"at {config.chase.course_speed_min_m_s:g} m/s or more",
        f"more than {round(math.degrees(config.chase.heading_off_max_rad))} degrees",
        f"for {config.touchdown.range_off_hold_s:g} s something is {config.touchdown.range_off_max_m:g} m nearer",
        f"more than {config.chase.ground_step_max_m:g} m, and {config.chase.ground_slope_max:g} m per metre",
        f"within {config.chase.ground_within_m:g} m",
        f"for {config.descent.stray_hold_s:g} s, for the {config.descent.strays_max + 1}th time in one approach",
        f"slower than {config.descent.waiting_speed_m_s:g} m/s",
        f"for up to {config.descent.surprise_wait_max_s:g} s",
    ):
        assert said in text


@pytest.mark.parametrize(("page", "rules"), [("px4.md", PX4_RULES), ("ardupilot.md", ARDUPILOT_RULES)])
def test_advised_parameters_are_those_of_the_check(page: str, rules: tuple[ParameterRule, ...]) -> None:
    expected = {
        tuple(spelling.name for spelling in rule.spellings): [f"{rule.advised(speed):g}" for speed in SPEEDS_M_S]
        for rule in rules
    }
    found = {tuple(re.findall(r"`(\w+)`", row[0])): row[1:4] for row in rows(page) if len(row) == 5 and "`" in row[0]}
    assert found == expected
