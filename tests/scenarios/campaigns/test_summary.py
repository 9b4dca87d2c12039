import json
from io import StringIO
from typing import Any

import numpy as np
import pytest

from scenarios.campaigns.landing_task import Row, Task, failed_row
from scenarios.campaigns.summary import MEASURES, summarize
from scenarios.campaigns.tables import print_summary
from scenarios.scoring.score import Tier


def row(seed: int, tier: str = "S3", cell: str = "straight_5", **values: Any) -> Row:
    contact = dict.fromkeys(MEASURES, 0.1 * seed) if tier in {"S1", "S2", "S3"} else {}
    firmware = "ardupilot" if cell.endswith("+firmware=ardupilot") else "px4"
    base = {
        "cell": cell,
        "firmware": firmware,
        "seed": seed,
        "error": None,
        "tier": tier,
        "s2_quality": False,
        "aborts": 0,
        "retries": 0,
    }
    return base | contact | values


ROWS = [
    row(1, s2_quality=True),
    row(2, "S3", aborts=2, retries=2),
    row(3, "S2", s2_quality=True),
    row(4, "S1"),
    row(5, "abort", aborts=4, retries=3),
    row(6, "unsafe"),
    row(1, cell="circle_5"),
]


def cell(name: str, rows: list[Row] = ROWS) -> dict[str, Any]:
    return next(one for one in summarize(rows)["cells"] if one["cell"] == name)


def test_summary_counts_each_landing_for_its_best_tier() -> None:
    assert cell("straight_5")["tiers"] == {"S3": 2, "S2": 1, "S1": 1, "S0": 0, "abort": 1, "unsafe": 1}
    assert cell("straight_5")["seeds"] == 6


def test_summary_begins_with_what_scripts_rely_on() -> None:
    assert list(cell("straight_5"))[: 3 + len(MEASURES)] == ["cell", "seeds", "tiers", *MEASURES]
    assert list(cell("straight_5")["tiers"]) == [tier.value for tier in Tier]
    assert all(list(cell("straight_5")[name]) == ["median", "p95"] for name in MEASURES)


def test_summary_counts_secured_landings_for_s2_only_by_their_contact() -> None:
    assert cell("straight_5")["s1_or_better"]["share"] == pytest.approx(4 / 6, abs=1e-6)
    assert cell("straight_5")["s2_quality"]["share"] == pytest.approx(2 / 6, abs=1e-6)
    assert cell("straight_5")["unsafe"]["share"] == pytest.approx(1 / 6, abs=1e-6)


def test_summary_has_both_firmwares_of_a_cell_side_by_side() -> None:
    cells = ["straight_5+firmware=ardupilot", "circle_5+firmware=ardupilot", "straight_5", "circle_5+firmware=px4"]
    found = summarize([row(1, cell=name) for name in cells])["cells"]
    assert [(one["cell"], one["firmware"]) for one in found] == [
        ("circle_5+firmware=px4", "px4"),
        ("circle_5+firmware=ardupilot", "ardupilot"),
        ("straight_5", "px4"),
        ("straight_5+firmware=ardupilot", "ardupilot"),
    ]


def test_every_table_names_the_firmware_of_each_cell_once() -> None:
    out = StringIO()
    print_summary(summarize([row(1, cell="static+firmware=ardupilot", aborts_by_reason="STRAYS 1")]), out)
    lines = [line.split() for line in out.getvalue().splitlines() if line.startswith("static")]
    assert len(lines) == 5  # tables
    assert all(line[:2] == ["static", "ardupilot"] for line in lines)


def test_summary_takes_its_measures_over_contacts_only() -> None:
    errors_m = [0.1, 0.2, 0.3, 0.4]
    expected = {"median": pytest.approx(np.median(errors_m)), "p95": pytest.approx(np.percentile(errors_m, 95))}
    assert cell("straight_5")["horizontal_error_m"] == expected
    assert cell("straight_5")["contacts"] == 4


def test_summary_without_contacts_has_no_measures() -> None:
    assert cell("static", [row(1, "abort", "static")])["sink_rate_m_s"] == {"median": None, "p95": None}


def test_error_counts_as_a_landing_that_failed() -> None:
    rows = [row(1), failed_row(Task(cell="straight_5", seed=2), {"firmware": "px4"}, "ValueError: wrong")]
    found = cell("straight_5", rows)
    assert (found["seeds"], found["errors"], sum(found["tiers"].values())) == (2, 1, 1)
    assert found["s1_or_better"]["share"] == 0.5


def test_summary_does_not_depend_on_the_order_of_rows() -> None:
    assert json.dumps(summarize(ROWS)) == json.dumps(summarize(ROWS[::-1]))


def test_table_outside_a_terminal_is_plain_and_one_line_a_cell() -> None:
    out = StringIO()
    print_summary(summarize([*ROWS, row(7, cell="straight_5+sensors=nominal+wind=moderate+link=nominal")]), out)
    lines = out.getvalue().splitlines()
    assert "\x1b" not in out.getvalue()
    assert out.getvalue().isascii()
    assert sum(line.startswith("straight_5 ") for line in lines) == 4
    assert sum(line.startswith("straight_5+sensors=nominal+wind=moderate+link=nominal ") for line in lines) == 4


WHY = [
    row(1, aborts_by_reason="OUTSIDE_CONE 1", approaches=2, ended_reason_code="MOTORS_OFF"),
    row(2, "abort", aborts_by_reason="SETPOINT_NOT_FOLLOWED 3, OUTSIDE_CONE 1", begun_anew_by_reason="STRAYS 2",
        approaches=4, ended_reason_code="NO_RETRY_LEFT"),
    row(1, cell="circle_5", aborts_by_reason="OUTSIDE_CONE 1", approaches=2, ended_reason_code="MOTORS_OFF"),
]  # fmt: skip


def test_summary_adds_up_the_reasons_of_a_cell() -> None:
    found = cell("straight_5", WHY)
    assert found["approaches"] == 6
    assert list(found["aborts_by_reason"].items()) == [("SETPOINT_NOT_FOLLOWED", 3), ("OUTSIDE_CONE", 2)]
    assert found["begun_anew_by_reason"] == {"STRAYS": 2}
    assert found["not_landed_by_reason"] == {"NO_RETRY_LEFT": 1}


def test_table_tells_the_reasons_by_cell_and_together() -> None:
    out = StringIO()
    print_summary(summarize(WHY), out)
    told = [line.split() for line in out.getvalue().splitlines() if "OUTSIDE_CONE" in line]
    straight = ["SETPOINT_NOT_FOLLOWED", "3,", "OUTSIDE_CONE", "2", "STRAYS", "2", "NO_RETRY_LEFT", "1"]
    assert told[0] == ["circle_5", "px4", "2", "OUTSIDE_CONE", "1", "-", "-"]
    assert told[1] == ["straight_5", "px4", "6", *straight]
    assert told[2][:6] == ["all", "px4", "8", "OUTSIDE_CONE", "3,", "SETPOINT_NOT_FOLLOWED"]


def test_table_without_reasons_has_no_part_for_them() -> None:
    out = StringIO()
    print_summary(summarize(ROWS), out)
    assert "Why" not in out.getvalue()


def test_summary_pools_consistency_and_shows_its_band() -> None:
    rows = [row(seed, nees_mean=4.0 + seed, nis_sum=90.0 + 10.0 * seed, nis_dof=100) for seed in (1, 2, 3)]
    found = cell("straight_5", rows)
    assert (found["nees"]["mean"], found["nees"]["runs"], found["nees"]["dof"]) == (6.0, 3, 6)
    # chi-square quantiles of 18 degrees of freedom, 8.231 and 31.526, over 3 runs
    assert (found["nees"]["low"], found["nees"]["high"]) == pytest.approx((8.231 / 3.0, 31.526 / 3.0), abs=1e-3)
    assert (found["nis_per_dof"]["mean"], found["nis_per_dof"]["dof"]) == (1.1, 300)


def test_summary_has_computing_times_where_they_are_known() -> None:
    times = [
        {"cell": "straight_5", "seed": seed, "wall_s": 2.0 * seed, "cpu_s": 1.5, "planner_max_ms": 3.0 * seed}
        for seed in (1, 2, 3)
    ]
    summary = summarize([row(1), row(1, cell="circle_5")], times)
    circle, straight = summary["cells"]
    assert "planner_ms" not in circle
    assert straight["planner_ms"] == {"median": None, "p99": None, "max": 9.0}
    assert straight["computing"] == {"wall_s": 4.0, "cpu_s": 1.5}
    out = StringIO()
    print_summary({"cells": [straight]}, out)
    assert "planner max [ms]" in out.getvalue()
