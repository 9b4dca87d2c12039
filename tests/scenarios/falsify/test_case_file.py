from pathlib import Path

import pytest

from scenarios.catalogue.catalogue import load_scenario
from scenarios.falsify.falsify import case_text
from scenarios.falsify.simplify import details, without
from scenarios.worlds.world import draw_world


@pytest.mark.parametrize(
    "name",
    [
        "straight_5",
        "lane_change_5+sensors=nominal+wind=gust+link=degraded",
        "report_1",
        "circle_5+firmware=ardupilot+sensors=degraded_no_heading",
    ],
)
def test_file_of_a_case_is_the_same_scenario(name: str, tmp_path: Path) -> None:
    scenario = load_scenario(name)
    path = tmp_path / "case.toml"
    path.write_text(case_text(scenario, ["a note"]), encoding="utf-8")
    assert load_scenario(str(path)) == scenario.model_copy(update={"name": "case"})


def test_file_of_a_case_without_a_frame_offset_is_the_same_scenario(tmp_path: Path) -> None:
    # A drawn world does not tell that its receivers have one frame, whatever offset they have.
    drawn = draw_world("world", 3).scenario
    scenario = without(drawn, details(drawn))
    assert scenario is not None
    assert scenario.sensors.frame_offset_m == 0.0
    path = tmp_path / "case.toml"
    path.write_text(case_text(scenario, []), encoding="utf-8")
    assert load_scenario(str(path)) == scenario.model_copy(update={"name": "case"})


def test_notes_are_comments_that_fit_the_page() -> None:
    text = case_text(load_scenario("straight_5"), ["word " * 60, "Fly it: scenarios run case.toml"])
    comments = [line for line in text.splitlines() if line.startswith("#")]
    assert len(comments) == 4
    assert max(len(line) for line in comments) <= 120
    assert comments[-1] == "# Fly it: scenarios run case.toml"


def test_plain_values_of_a_list_share_a_line() -> None:
    text = case_text(load_scenario("report_1"), [])
    assert "waypoints_m = [\n    [0.0, 0.0],\n    [50.0, 0.0],\n]\nspeeds_m_s = [0.0, 5.0]\n" in text
