"""A landing as a task; the flights themselves are tested with lockstep."""

import math
from types import MappingProxyType
from typing import Any

import pytest

from companion.situation.phases import Phase
from link.errors import UserError
from link.records import replace
from scenarios.campaigns import landing_task
from scenarios.campaigns.landing_task import Flights, Task, row_of, wave_offs
from scenarios.catalogue.catalogue import load_scenario
from scenarios.recordings.recording import Recording
from scenarios.recordings.versions import sources, versions
from scenarios.scoring.score import Score, Tier
from scenarios.scoring.touchdown import Touchdown

TASK = Task(cell="straight_5", seed=7)
TABLE: MappingProxyType[str, Any] = MappingProxyType(
    {
        "scenario": "straight_5",
        "seed": 7,
        "tier": "S2",
        "start_s": 1.0,
        "phases_s": {"takeoff": 0.5, "descend": 9.25},
        "approaches": [
            {"ended": "abort", "reason_code": "OUTSIDE_CONE", "begun_anew": [{"reason_code": "STRAYS"}] * 2},
            {"ended": "abort", "reason_code": "SETPOINT_NOT_FOLLOWED", "begun_anew": []},
            {"ended": "abort", "reason_code": "SETPOINT_NOT_FOLLOWED", "begun_anew": []},
            {"ended": "touchdown", "reason_code": "CONTACT", "begun_anew": [{"reason_code": "PAD_NOT_SEEN"}]},
        ],
    }
)
FLIGHTS = Flights(cells={"straight_5": load_scenario("straight_5")}, sources=sources())


def values(*phases: Phase) -> list[str]:
    return [phase.value for phase in phases]


def test_row_is_the_result_without_nesting_with_a_column_for_each_phase() -> None:
    row = row_of(TASK, TABLE, Recording())
    assert {name: row[name] for name in ("cell", "seed", "error", "tier", "start_s")} == {
        "cell": "straight_5",
        "seed": 7,
        "error": None,
        "tier": "S2",
        "start_s": 1.0,
    }
    assert {name for name in row if name.startswith("phase_")} == {f"phase_{one.name.lower()}_s" for one in Phase}
    assert (row["phase_takeoff_s"], row["phase_descend_s"], row["phase_pilot_s"]) == (0.5, 9.25, None)
    assert not any(isinstance(value, dict | list) for value in row.values())


def test_row_tells_why_approaches_were_broken_off_or_begun_anew() -> None:
    row = row_of(TASK, TABLE, Recording())
    assert row["approaches"] == 4
    assert (row["first_abort"], row["last_abort"]) == ("OUTSIDE_CONE", "SETPOINT_NOT_FOLLOWED")
    assert row["aborts_by_reason"] == "SETPOINT_NOT_FOLLOWED 2, OUTSIDE_CONE 1"
    assert row["begun_anew_by_reason"] == "STRAYS 2, PAD_NOT_SEEN 1"


def test_row_of_a_landing_at_once_has_no_reason() -> None:
    row = row_of(TASK, {**TABLE, "approaches": TABLE["approaches"][3:]}, Recording())
    assert (row["first_abort"], row["last_abort"], row["aborts_by_reason"]) == (None, None, "")


def test_wave_offs_are_entries_into_abort_and_retries_the_approaches_after_it() -> None:
    flight = [Phase.CHASE, Phase.ABORT, Phase.ABORT, Phase.CHASE, Phase.DESCEND, Phase.ABORT, Phase.HOLD]
    assert wave_offs(values(*flight)) == {"aborts": 2, "retries": 1}
    assert wave_offs(values(Phase.CHASE, Phase.DESCEND, Phase.SECURED)) == {"aborts": 0, "retries": 0}
    assert wave_offs([]) == {"aborts": 0, "retries": 0}


@pytest.mark.slow
def test_landing_that_raises_is_a_row_that_tells_what_and_where(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> Any:
        raise ArithmeticError("not\n finite")

    monkeypatch.setattr(landing_task, "Lockstep", fail)
    flown = FLIGHTS(TASK)
    assert flown.row["error"] == "ArithmeticError: not finite (test_landing_task.py, fail)"
    assert (flown.row["cell"], flown.row["seed"]) == ("straight_5", 7)


def test_worker_with_other_sources_refuses() -> None:
    with pytest.raises(UserError, match="other sources"):
        replace(FLIGHTS, sources="0123456789ab")(TASK)


def test_job_of_one_cell_holds_no_other() -> None:
    both = replace(FLIGHTS, cells={**FLIGHTS.cells, "circle_5": load_scenario("circle_5")})
    assert both.only("circle_5").cells.keys() == {"circle_5"}


def test_versions_name_the_numerics() -> None:
    assert versions()["sources"] == sources()
    assert {"numpy", "numba", "osqp", "python"} < versions().keys()
    assert "not installed" not in versions().values()


@pytest.mark.parametrize(
    ("tier", "error_m", "expected"),
    [
        (Tier.S3, 0.29, True),
        (Tier.S3, 0.31, False),
        (Tier.S2, 0.29, True),
        (Tier.S1, 0.31, False),
        (Tier.UNSAFE, 0.1, False),
    ],
)
def test_s2_quality_is_landed_within_the_limits_of_s2(tier: Tier, error_m: float, *, expected: bool) -> None:
    contact = Touchdown(
        contact_t_ns=0,
        on_pad=True,
        horizontal_error_m=error_m,
        contact_forward_m=error_m,
        contact_left_m=0.0,
        relative_speed_m_s=0.2,
        sink_rate_m_s=0.4,
        tilt_rad=0.1,
        trim_rad=0.05,
        tilt_over_trim_rad=math.radians(3.0),
    )
    result = Score(
        tier=tier,
        reason="",
        margin=0.6,
        touchdown=contact,
        start_t_ns=0,
        time_to_contact_s=3.0,
        time_to_s0_s=2.0,
        closest_m=0.1,
        slid_m=0.0,
        motors_off_s=0.5,
    )
    assert result.s2_quality is expected
    assert result.to_json()["s2_quality"] is expected
