"""The report about worlds, on rows made by hand, and as people read it."""

from io import StringIO
from typing import Any

import pytest
from scipy import stats

from scenarios.campaigns.cells import Population
from scenarios.campaigns.landing_task import Row, Task, failed_row
from scenarios.campaigns.sheets import print_sheets, write_sheets
from scenarios.campaigns.worlds_report import worlds_report
from scenarios.campaigns.worlds_sheets import worlds_sheets
from tests.scenarios.campaigns.test_summary import row

URBAN = Population(slice="world:urban")
BOTH = {one.name: one for one in (Population(slice="world", firmware=firmware) for firmware in ("px4", "ardupilot"))}


def landing(seed: int, tier: str = "S3", cell: str = "world:urban", **values: Any) -> Row:
    """A landing of 100 worlds: the faster the vehicle, the more of them fail."""
    base: Row = {
        "reason": "contact with the ground" if tier == "unsafe" else "as it should",
        "closest_m": 0.1,
        "margin": -0.01 * seed if tier == "unsafe" else 0.5,
        "world.drive.cruise_m_s": 0.2 * seed,
        "world.road.class": "residential" if seed % 2 else "arterial",
        "world.drone.firmware": "px4",
        "before_brake_m_s2": 6.0 if tier == "unsafe" else 0.5,
    }
    return row(seed, tier, cell, **(base | values))


ERROR = failed_row(
    Task(cell="world:urban", seed=101), {"firmware": None}, "ValueError: cannot be drawn (world.py, draw)"
)
ROWS = [landing(seed, "unsafe" if seed > 88 else "S3") for seed in range(1, 101)]


def report(rows: list[Row], populations: dict[str, Population] | None = None) -> dict[str, Any]:
    (one,) = worlds_report(rows, populations or {URBAN.name: URBAN})
    return one


def test_overall_rates_count_each_landing_and_each_error() -> None:
    found = report([*ROWS, ERROR])["overall"]
    unsafe = found["tiers"]["unsafe"]
    expected = stats.binomtest(12, 101).proportion_ci(0.95, method="wilson")
    assert (found["landings"], found["errors"], unsafe["count"]) == (101, 1, 12)
    assert (unsafe["low"], unsafe["high"]) == pytest.approx((expected.low, expected.high), abs=1e-6)


def test_bins_and_words_show_where_it_fails() -> None:
    found = report(ROWS)
    speed = found["over"]["world.drive.cruise_m_s"]
    assert [one["tiers"]["unsafe"]["count"] for one in speed] == [0, 0, 0, 0, 12]
    assert {word: one["landings"] for word, one in found["by"]["world.road.class"].items()} == {
        "arterial": 50,
        "residential": 50,
    }
    assert list(found["by"]) == ["world.road.class"]


def test_worst_are_ten_of_the_least_margin_as_commands_that_replay() -> None:
    worst = report(ROWS)["worst"]
    assert [one["world"] for one in worst] == [f"world:urban@{seed}" for seed in range(100, 90, -1)]
    assert worst[0]["command"] == "scenarios run world:urban@100 --lockstep"
    assert (worst[0]["outcome"], worst[0]["before"]) == ("contact with the ground", ["brake"])


def test_worst_without_an_unsafe_one_are_the_nearest_to_it() -> None:
    worst = report([landing(seed, margin=0.01 * seed) for seed in (3, 2, 4)] + [ERROR])["worst"]
    assert [one["world"] for one in worst] == ["world:urban@2", "world:urban@3", "world:urban@4"]


def test_worlds_with_both_firmwares_are_one_report_that_compares_them_in_pairs() -> None:
    px4, ardupilot = BOTH
    rows = [landing(seed, "unsafe" if seed > 15 else "S3", px4) for seed in range(1, 21)]
    rows += [landing(seed, "unsafe" if seed == 1 else "S3", ardupilot) for seed in range(1, 21)]
    found = report(rows, BOTH)
    assert {firmware: one["landings"] for firmware, one in found["by_firmware"].items()} == {"ardupilot": 20, "px4": 20}
    pairs = found["pairs"]
    assert pairs["pairs"] == 20
    assert (pairs["unsafe"]["only_px4"], pairs["unsafe"]["only_ardupilot"]) == (5, 1)
    assert pairs["unsafe"]["p"] == pytest.approx(stats.binomtest(5, 6).pvalue)
    assert found["worst"][0]["world"] == "world@20+firmware=px4"


def test_each_slice_has_its_own_report_in_the_order_of_the_cells() -> None:
    yard = Population(slice="world:yard")
    rows = [landing(1), landing(1, cell="world:yard")]
    found = worlds_report(rows, {yard.name: yard, URBAN.name: URBAN})
    assert [(one["worlds"], one["overall"]["landings"]) for one in found] == [("world:yard", 1), ("world:urban", 1)]


def test_campaign_whose_worlds_all_failed_to_be_drawn_is_told() -> None:
    found = report([ERROR])
    assert (found["overall"]["errors"], found["worst"], found["over"]) == (1, [], {})
    assert [sheet.title for sheet in worlds_sheets(found)]


def test_report_is_read_on_a_terminal_and_as_markdown() -> None:
    sheets, plain, markdown = worlds_sheets(report(ROWS)), StringIO(), StringIO()
    print_sheets(sheets, plain)
    write_sheets(sheets, markdown)
    for text in (plain.getvalue(), markdown.getvalue()):
        assert "scenarios run world:urban@100 --lockstep" in text
        assert "12.0 (7.0 to 19.8)" in text  # Wilson's interval of 12 in 100
        assert "cruising speed [m/s]" in text
        assert "16.0 to 20.0" in text  # the fastest fifth is from the 80th percentile on
    assert all(len(line) == len(sheet.head) for sheet in sheets for line in sheet.rows)
