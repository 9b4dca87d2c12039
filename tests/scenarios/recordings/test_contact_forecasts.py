"""What a run's row keeps of the forecasts: of one descent, when it leaves the height of waiting and commits."""

from typing import Any

import pytest

from companion.config.descent import DescentConfig
from companion.situation.phases import Phase
from link.messages import LandingStatus
from link.records import replace
from scenarios.recordings.contact_forecasts import forecast_columns
from tests.companion.facts import forecast_of
from tests.scenarios.statuses import status_of

START_NS = 1_767_225_600_000_000_000
DESCENT = DescentConfig()
LANDED = {
    "contact_s": 21.4,
    "on_pad": True,
    "horizontal_error_m": 0.2,
    "relative_speed_m_s": 0.3,
    "sink_rate_m_s": 0.5,
    "tilt_over_trim_rad": 0.02,
}


def _status(at_s: float, height_m: float, phase: Phase = Phase.DESCEND, unsafe: float = 0.01) -> LandingStatus:
    said = status_of(START_NS + round(at_s * 1e9), phase)
    contact = forecast_of(unsafe, in_s=0.8) if phase is Phase.DESCEND else None
    return replace(said, height_above_pad_m=height_m, fix_age_s=0.1, contact_forecast=contact)


FLIGHT = [
    _status(10.0, 0.3, unsafe=0.7),  # of an approach that was broken off
    _status(11.0, 2.0, Phase.ABORT),
    _status(19.0, 1.2),
    _status(20.0, 0.79, unsafe=0.02),
    _status(20.9, 0.34, unsafe=0.03),
    _status(21.3, 0.05, unsafe=0.001),
    _status(21.5, 0.0, Phase.TOUCHDOWN),
]


@pytest.mark.parametrize(
    ("result", "came"),
    [
        (LANDED, "s2"),
        (LANDED | {"horizontal_error_m": 0.4}, "s1"),
        (LANDED | {"horizontal_error_m": 0.6}, "unsafe"),
        (LANDED | {"on_pad": False}, "unsafe"),
        (LANDED | {"contact_s": 29.0}, "broken_off"),
        ({"contact_s": None}, "broken_off"),
    ],
)
def test_the_descent_to_the_contact_counts_and_what_came_of_it(result: dict[str, Any], came: str) -> None:
    columns = forecast_columns(FLIGHT, START_NS, result, DESCENT)
    assert (columns["forecast_waiting_at_s"], columns["forecast_waiting_unsafe"]) == (20.0, 0.02)
    assert (columns["forecast_commit_at_s"], columns["forecast_commit_unsafe"]) == (20.9, 0.03)
    assert columns["forecast_commit_came"] == came


def test_a_run_without_a_descent_has_no_forecast() -> None:
    assert set(forecast_columns(FLIGHT[1:2], START_NS, LANDED, DESCENT).values()) == {None}


def test_a_drone_that_touched_and_lifted_off_again_is_judged_by_the_approach_of_that_touch() -> None:
    columns = forecast_columns(FLIGHT, START_NS, LANDED | {"contact_s": 10.5, "horizontal_error_m": 0.6}, DESCENT)
    assert (columns["forecast_commit_at_s"], columns["forecast_commit_unsafe"]) == (10.0, 0.7)
    assert columns["forecast_commit_came"] == "unsafe"


def test_of_a_drone_that_had_touched_something_before_its_first_descent_nothing_is_known() -> None:
    columns = forecast_columns(FLIGHT, START_NS, LANDED | {"contact_s": 9.0}, DESCENT)
    assert set(columns.values()) == {None}
