import io
import json
import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from scenarios.catalogue.catalogue import load_scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.recordings.result import LANDED, score_run
from scenarios.source_report import figures
from scenarios.source_report.cases import CASES, STANDS_S
from scenarios.source_report.figures import draw_report
from scenarios.source_report.flight import ReportFlight, ReportTask, fly, row_of
from scenarios.source_report.step_responses import step_rows
from scenarios.source_report.table import print_report, report_table, write_markdown
from tests.scenarios.source_report.recomputation import outcome, shared_noise

PUBLISHED = {case.scenario: case.landing for case in CASES}
NOISE_M = 0.1 * shared_noise(2600)


def shared_flight(task: ReportTask) -> ReportFlight:
    """One of those that other tests fly, on the same road."""
    return flight({"report_4": "report_3"}.get(task.scenario, task.scenario))


@cache
def flight(scenario: str, system: str = "report") -> ReportFlight:
    return fly(ReportTask(scenario=scenario, system=system, seed=1))


@pytest.mark.slow
@pytest.mark.parametrize(("scenario", "within_s"), [("report_1", 1.5), ("report_3", 1.0)])
def test_report_lands_when_and_where_it_published(scenario: str, within_s: float) -> None:
    published, landing = PUBLISHED[scenario], flight(scenario).landing(noisy=True)
    assert published is not None
    assert landing is not None
    assert landing.t_s == pytest.approx(published.t_s, abs=within_s)
    assert math.dist((landing.x_m, landing.y_m), (published.x_m, published.y_m)) < 2.5


@pytest.mark.slow
@pytest.mark.parametrize(("scenario", "system"), [("report_2", "report"), ("report_3", "report_unboosted")])
def test_report_does_not_land_in_scenario_2_nor_without_the_velocity_factor(scenario: str, system: str) -> None:
    assert flight(scenario, system).landing(noisy=True) is None


@pytest.mark.slow
@pytest.mark.parametrize("scenario", [1, 2, 3])
def test_flights_through_the_whole_stack_agree_with_a_recomputation_without_it(scenario: int) -> None:
    ours, theirs = flight(f"report_{scenario}"), outcome(scenario, NOISE_M)
    landing = ours.landing(noisy=True)
    assert (landing is None) == (theirs.t_s is None)
    if landing is not None and theirs.t_s is not None:
        assert landing.t_s == pytest.approx(theirs.t_s, abs=0.25)  # the test's own noise moves it by 0.1 s
    assert ours.distance_m(noisy=False)[ours.counts].min() == pytest.approx(theirs.closest_m, abs=0.08)


@pytest.mark.slow
def test_planners_own_estimate_while_standing_explains_the_published_landing_of_scenario_1() -> None:
    landed = outcome(1, NOISE_M, estimates=True)
    assert landed.t_s == pytest.approx(11.0, abs=0.3)
    assert landed.drone_m == pytest.approx((4.3, 0.0), abs=0.15)


@pytest.mark.slow
def test_recomputation_with_the_smooth_road_lands_in_scenario_3_as_published() -> None:
    landed = outcome(3, NOISE_M, estimates=True)
    assert landed.t_s == pytest.approx(13.5, abs=0.1)
    assert landed.drone_m == pytest.approx((30.0, -9.0), abs=0.2)


@pytest.mark.slow
def test_reports_chase_begins_with_the_departure() -> None:
    lockstep = Lockstep(load_scenario("report_1+system=report"), 3)
    while "chase" not in lockstep.recording.phase_times_s():
        lockstep.step()
    departs_ns = lockstep.simulation.vehicle.memory.departs_ns
    assert departs_ns is not None
    departs_s = (departs_ns - lockstep.recording.drone[0].t_ns) * 1e-9
    assert lockstep.recording.phase_times_s()["chase"] == pytest.approx(departs_s, abs=0.1)


@pytest.mark.slow
def test_parts_that_can_be_selected_land_together_on_a_car_at_5_m_s() -> None:
    scenario, other = (load_scenario(f"straight_5+system={part}") for part in ("pn", "lqr_feedforward"))
    system = scenario.system.model_copy(update={"drone": other.system.drone})
    scenario = scenario.model_copy(update={"system": system})
    lockstep = Lockstep(scenario, 1)
    lockstep.run()
    assert score_run(scenario, 1, lockstep.recording).tier in LANDED


def straight_flight(distance_m: list[float], *, t_s: list[float], noise_m: float = 0.0) -> ReportFlight:
    """A drone behind a vehicle at (10, 2) m by each distance."""
    n = len(distance_m)
    vehicle = np.tile([10.0, 2.0, 0.0], (n, 1))
    return ReportFlight(
        t_s=np.array(t_s),
        drone_m=vehicle - np.outer(distance_m, [1.0, 0.0, 0.0]),
        vehicle_m=vehicle,
        noise_m=np.tile([-noise_m, 0.0, 0.0], (n, 1)),
        road_end_s=9.0,
        score=None,
    )


def test_landing_is_the_first_instant_within_0_7_m() -> None:
    landing = straight_flight([2.0, 0.71, 0.69, 0.3], t_s=[5.0, 6.0, 7.0, 8.0]).landing(noisy=False)
    assert landing is not None
    assert (landing.t_s, landing.x_m, landing.y_m) == (7.0, 10.0, 2.0)


def test_noisy_landing_is_from_where_the_vehicle_was_measured() -> None:
    near = straight_flight([0.8, 0.8], t_s=[6.0, 7.0], noise_m=0.15)
    assert near.landing(noisy=False) is None
    assert near.landing(noisy=True) is not None


def test_nothing_counts_before_the_departure_or_behind_the_roads_end() -> None:
    assert straight_flight([0.1, 2.0, 0.1], t_s=[STANDS_S - 0.01, 7.0, 9.01]).landing(noisy=False) is None


@pytest.mark.slow
def test_table_counts_landings_and_tells_their_median_and_range() -> None:
    rows = [
        row_of(ReportTask(scenario="report_1", system="report", seed=seed), straight_flight([0.5], t_s=[t_s]))
        for seed, t_s in enumerate((6.0, 8.5, 7.0, 4.0), 1)
    ]
    (cell,) = report_table(rows)["landings"]
    assert (cell["seeds"], cell["truth"]["landed"]) == (4, 3)
    assert cell["truth"]["t_s"] == {"median": 7.0, "min": 6.0, "max": 8.5}
    assert cell["published"]["t_s"] == 11.0
    json.dumps(cell, allow_nan=False)


@pytest.mark.slow
def test_printed_table_has_a_line_for_each_case_and_each_response() -> None:
    rows = [row_of(ReportTask(scenario="report_2", system="report", seed=1), straight_flight([5.0], t_s=[6.0]))]
    out = io.StringIO()
    table = report_table(rows)
    print_report(table, out)
    lines = out.getvalue().splitlines()
    assert any("report_2" in line and "never catches up" in line and "0 of 1" in line for line in lines)
    assert sum(
        line.split()[0] in {"lqr", "lqr,", "lqr_feedforward", "geometric"} for line in lines if line.strip()
    ) == len(table["step_responses"])


def test_markdown_has_the_same_number_of_cells_in_every_line_of_a_table() -> None:
    rows = [row_of(ReportTask(scenario="report_2", system="report", seed=1), straight_flight([0.5], t_s=[6.0]))]
    out = io.StringIO()
    write_markdown(report_table(rows), out)
    landings, steps = out.getvalue().rstrip().split("\n\n")
    assert {line.count("|") for line in landings.splitlines()} == {12}
    assert {line.count("|") for line in steps.splitlines()} == {7}


def test_linear_step_responses_are_the_published_ones() -> None:
    rows = [row for row in step_rows() if row["loop"] == "lqr, linear"]
    settling = {row["axis"]: row["settling_s"] for row in rows}
    assert settling == pytest.approx({"x": 1.41, "y": 1.33, "z": 1.53, "yaw": 0.62}, abs=0.01)
    assert [row["overshoot"] for row in rows] == pytest.approx([0.112, 0.109, 0.080, 0.081], abs=0.001)


def test_successors_settle_in_1_5_s_and_overshoot_by_2_percent_at_most() -> None:
    rows = [row for row in step_rows() if not str(row["loop"]).startswith("lqr,") and row["loop"] != "lqr"]
    places = [row for row in rows if row["axis"] != "yaw"]
    assert len(places) == 12
    assert all(float(row["settling_s"] or 9.0) <= 1.5 and float(row["overshoot"] or 0.0) <= 0.02 for row in places)


@pytest.mark.slow
def test_figures_are_drawn_as_png_and_svg(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(figures, "fly", shared_flight)
    files = draw_report(tmp_path)
    assert [file.name for file in files if file.suffix == ".png"] == [
        f"figure_{number:02d}.png" for number in (3, 6, 7, 8, 9, 10)
    ]
    assert all(file.with_suffix(".svg").read_text(encoding="utf-8").rstrip().endswith("</svg>") for file in files)
    assert all(file.with_suffix(".png").read_bytes().startswith(b"\x89PNG") for file in files)
