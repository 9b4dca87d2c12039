"""What the truth shows of failures, on rows made by hand."""

from typing import Any

import pytest

from scenarios.campaigns.causes import NOTHING, causes, events_before, outcome
from scenarios.campaigns.landing_task import Row
from tests.scenarios.campaigns.test_summary import row

QUIET: Row = {
    "before_brake_m_s2": 0.4,
    "before_departs": False,
    "before_lateral_m_s2": 0.2,
    "before_rise_m_s": 0.1,
    "before_gust_m_s": 0.0,
    "before_silence_s": 0.0,
}
ON_PAD: Row = {
    "on_pad": True,
    "horizontal_error_m": 0.2,
    "relative_speed_m_s": 0.3,
    "sink_rate_m_s": 0.4,
    "tilt_over_trim_rad": 0.05,
    "slid_m": 0.01,
}


def unsafe(seed: int, reason: str, **values: Any) -> Row:
    return row(seed, "unsafe", reason=reason, **(QUIET | values))


def given_up(seed: int, closest_m: float, **values: Any) -> Row:
    return row(seed, "abort", reason="no touchdown", closest_m=closest_m, **(QUIET | values))


@pytest.mark.parametrize(
    ("column", "value", "event"),
    [
        ("before_brake_m_s2", 1.7, "brake"),
        ("before_departs", True, "departure"),
        ("before_lateral_m_s2", 1.1, "turn-in"),
        ("before_rise_m_s", 0.31, "climb, crest or bump"),
        ("before_gust_m_s", 4.0, "gust"),
        ("before_silence_s", 0.1, "silent link"),
    ],
)
def test_event_is_shown_by_its_own_column(column: str, value: float, event: str) -> None:
    assert events_before(QUIET) == []
    assert events_before(QUIET | {column: value}) == [event]
    assert events_before(QUIET | {column: None}) == []


@pytest.mark.parametrize(
    ("landing", "told"),
    [
        (unsafe(1, "contact with the ground", on_pad=False), "contact with the ground"),
        (unsafe(1, "never took off", on_pad=None), "never took off"),
        (
            unsafe(1, "contact on the pad beyond the limits: ...", **(ON_PAD | {"sink_rate_m_s": 1.01})),
            "on the pad beyond S1: sink rate",
        ),
        (
            unsafe(1, "...", **(ON_PAD | {"relative_speed_m_s": 1.2, "tilt_over_trim_rad": 0.3, "slid_m": 0.6})),
            "on the pad beyond S1: relative speed, tilt over trim, slid",
        ),
        (
            unsafe(1, "tipped over on the deck", **ON_PAD),
            "after contact on the pad: tipped over on the deck",
        ),
        (
            unsafe(1, "contact with the ground", **(ON_PAD | {"slid_m": 1.4})),
            "after contact on the pad, slid: contact with the ground",
        ),
        (given_up(1, 0.9), "given up within 1 m of the pad"),
        (given_up(1, 1.1), "given up within 5 m of the pad"),
        (given_up(1, 40.0), "never within 5 m of the pad"),
    ],
)
def test_outcome_is_what_the_truth_shows(landing: Row, told: str) -> None:
    assert outcome(landing) == told


ROWS = [
    unsafe(1, "contact with the ground", before_brake_m_s2=6.0),
    unsafe(2, "contact with the ground", before_brake_m_s2=3.0, before_gust_m_s=4.0),
    unsafe(3, "contact with the vehicle's side"),
    given_up(4, 2.0, before_gust_m_s=5.0),
    *(row(seed, "S3", **(QUIET | {"before_brake_m_s2": 2.0 if seed == 5 else 0.0})) for seed in range(5, 15)),
    row(20, "S2"),  # of a campaign that kept nothing of this
]


def test_failures_are_grouped_by_what_the_truth_shows_the_most_frequent_first() -> None:
    found = causes(ROWS, lambda one: f"world@{one['seed']}")
    assert found["unsafe"] == [
        {
            "outcome": "contact with the ground",
            "count": 2,
            "before": {"brake": 2, "gust": 1},
            "worlds": ["world@1", "world@2"],
        },
        {"outcome": "contact with the vehicle's side", "count": 1, "before": {NOTHING: 1}, "worlds": ["world@3"]},
    ]
    (one,) = found["given_up"]
    assert (one["outcome"], one["before"]) == ("given up within 5 m of the pad", {"gust": 1})


def test_events_are_counted_among_what_failed_and_what_landed() -> None:
    brake = causes(ROWS, lambda _: "")["before"][0]
    assert brake["event"] == "brake"
    counts = {part: (brake[part]["count"], brake[part]["of"]) for part in ("unsafe", "given_up", "landed")}
    assert counts == {"unsafe": (2, 3), "given_up": (0, 1), "landed": (1, 10)}


def test_event_that_nothing_is_known_of_has_no_share() -> None:
    assert causes([row(1)], lambda _: "")["before"][0]["landed"] is None
