import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from link.messages import BodyTruth, Vector3
from link.records import replace
from scenarios.scoring.flight_faults import flight_of
from scenarios.scoring.margin import LEAST, margin_of, margin_terms
from scenarios.scoring.score import Tier, score_log
from scenarios.scoring.touch import touches
from scenarios.scoring.touchdown import landing_of
from scenarios.scoring.truth_log import truth_log
from sim_autopilot.physics.contact import BLADE_REACH_M, FOOT_OFFSET_M
from tests.scenarios.scoring.synthetic import CALM, STEP_S, STILL, TIMES_S, Landing, body, flown, scored

PAD_HALF_M = 0.75
HIGH = (0.0, 0.0, 5.0)


def hover(position: Vector3, roll_rad: float = 0.0, seconds: float = 3.0) -> list[BodyTruth]:
    return [body(t_s, position, STILL, roll_rad=roll_rad) for t_s in TIMES_S[: round(seconds / STEP_S)]]


def approach(low_m: float, aside_m: float = 0.0, speed_m_s: float = 0.0) -> list[BodyTruth]:
    """Return a flight that comes down to `low_m` of its centre above the road, and leaves upwards again."""
    half = len(TIMES_S) // 2
    heights_m = [5.0 - (5.0 - low_m) * min(index, len(TIMES_S) - 1 - index) / half for index in range(len(TIMES_S))]
    return [
        body(t_s, (aside_m, 0.0, height_m), (speed_m_s, 0.0, 0.0))
        for t_s, height_m in zip(TIMES_S, heights_m, strict=True)
    ]


@pytest.mark.parametrize(
    ("landing", "expected"),
    [
        (Landing(error_m=(0.3, 0.27)), 1.0 - math.hypot(0.3, 0.27) / 0.5),
        (Landing(drift_m_s=(0.0, 0.85)), 0.15),
        (Landing(sink_m_s=0.93), 0.07),
        (Landing(sink_m_s=1.3), -0.3),
        (Landing(tilt_rad=math.radians(13.0)), 2.0 / 15.0),
        (Landing(tilt_rad=math.radians(21.0)), -6.0 / 15.0),
    ],
)
def test_margin_of_a_contact_is_what_its_worst_measure_leaves_of_the_limit(landing: Landing, expected: float) -> None:
    assert scored(landing).margin == pytest.approx(expected, abs=0.02)


def test_contact_beside_the_pad_is_below_zero_by_how_far_its_feet_are_outside() -> None:
    long_pad = replace(CALM, box=replace(CALM.box, pad_size_m=(4.0, 0.2)))  # narrower than the feet stand
    result = scored(Landing(error_m=(0.0, 0.0)), long_pad)
    assert result.tier is Tier.UNSAFE
    assert result.margin == pytest.approx((0.1 - FOOT_OFFSET_M) / 0.5, abs=0.005)


def test_contact_is_less_safe_the_nearer_its_feet_are_to_the_edge_of_the_pad() -> None:
    pads_m = [1.5, 0.8, 0.6, 0.5, 0.4, 0.3]
    margins = [
        scored(Landing(error_m=(0.0, 0.0)), replace(CALM, box=replace(CALM.box, pad_size_m=(pad_m, pad_m)))).margin
        for pad_m in pads_m
    ]
    assert margins == sorted(margins, reverse=True)
    assert margins[-1] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(
    error_m=st.tuples(st.floats(-1.0, 1.0), st.floats(-1.5, 1.5)),
    drift_m_s=st.tuples(st.floats(-0.8, 0.8), st.floats(-0.8, 0.8)),
    sink_m_s=st.floats(0.2, 1.3),
    tilt_rad=st.floats(0.0, 0.4),
)
def test_least_term_of_a_landing_is_negative_exactly_when_it_is_unsafe(
    error_m: tuple[float, float], drift_m_s: tuple[float, float], sink_m_s: float, tilt_rad: float
) -> None:
    landing = Landing(error_m=error_m, drift_m_s=drift_m_s, sink_m_s=sink_m_s, tilt_rad=tilt_rad)
    times_s = TIMES_S[400:900]
    log = truth_log([landing.drone(t_s) for t_s in times_s], [landing.vehicle(t_s) for t_s in times_s], [])
    touched = touches(log, CALM.box)
    flight = flight_of(log, touched, CALM.box)
    contact = None if flight.first is None else landing_of(log, flight.first, CALM)
    terms = margin_terms(log, touched, flight, contact, CALM)
    assert (min(terms.values()) < 0.0) is (score_log(log, CALM).tier is Tier.UNSAFE)


@pytest.mark.parametrize(
    ("position", "roll_rad"),
    [
        (HIGH, 0.0),
        (HIGH, 0.7),
        ((0.0, 0.0, 3.0), 0.0),
        ((0.0, 0.0, 2.3), 0.0),
        ((9.0, 0.0, 0.9), 0.0),
        ((9.0, 0.0, 5.0), 1.0),
        ((9.0, 0.0, 5.0), 1.5),
        ((9.0, 0.0, 0.3), 0.0),
        ((-3.0, 0.0, 5.0), 0.2),
    ],
)
def test_margin_of_a_flight_without_contact_is_negative_exactly_when_it_is_unsafe(
    position: Vector3, roll_rad: float
) -> None:
    log = truth_log(hover(position, roll_rad), [body(t_s, STILL, STILL) for t_s in TIMES_S[:300]], [])
    touched = touches(log, CALM.box)
    terms = margin_terms(log, touched, flight_of(log, touched, CALM.box), None, CALM)
    assert (min(terms.values()) < 0.0) is (flown(hover(position, roll_rad)).tier is Tier.UNSAFE)


def test_margin_at_the_flank_of_the_vehicle_is_its_depth_below_the_roof() -> None:
    path = [body(t_s, (-6.0 + t_s, 0.0, 1.0), (1.0, 0.0, 0.0)) for t_s in TIMES_S[:500]]
    wide_pad = replace(CALM, box=replace(CALM.box, pad_size_m=CALM.box.roof_size_m))
    assert flown(path, wide_pad).margin < -0.5


def test_margin_of_contact_with_the_ground_is_how_far_it_is_from_the_pad() -> None:
    pad_on_road = replace(CALM, box=replace(CALM.box, roof_height_m=0.0))
    result = scored(Landing(error_m=(0.0, 1.6), roof_m=0.0), pad_on_road)
    assert result.margin == pytest.approx(min(1.0 - 1.6 / 0.5, (PAD_HALF_M - 1.6 - FOOT_OFFSET_M) / 0.5), abs=0.02)


def test_wave_off_is_less_safe_the_nearer_it_came_to_the_roof_beside_the_pad() -> None:
    heights_m = (2.6, 2.0, 1.9, 1.8, 1.7)
    margins = [flown(approach(low_m, aside_m=1.2)).margin for low_m in heights_m]
    assert margins[0] > 0.7
    assert margins == sorted(margins, reverse=True)
    assert margins[-1] == pytest.approx((1.7 - 1.5 - 0.12) / 0.5, abs=0.02)


def test_wave_off_that_is_fast_above_the_pad_is_less_safe_than_one_that_is_slow_there() -> None:
    slow, fast = (flown(approach(1.7, speed_m_s=speed_m_s)).margin for speed_m_s in (0.1, 1.6))
    assert fast == pytest.approx((1.7 - 1.5 - 0.12) / 0.5, abs=0.02)
    assert slow > 0.3


def test_landing_that_swung_just_above_the_pad_is_less_safe_than_one_that_did_not() -> None:
    landing = Landing(error_m=(0.0, 0.0), sink_m_s=0.3)
    drone = [landing.drone(t_s) for t_s in TIMES_S]
    before = 770  # 0.1 m above the pad
    rolled = body(TIMES_S[before], drone[before].position_enu_m, (5.0, 1.5, -0.3))
    swung = [*drone[:before], rolled, *drone[before + 1 :]]
    vehicle = [landing.vehicle(t_s) for t_s in TIMES_S]
    margins = []
    for path in (drone, swung):
        log = truth_log(path, vehicle, [landing.rotors(t_s) for t_s in TIMES_S])
        touched = touches(log, CALM.box)
        margins.append(margin_terms(log, touched, flight_of(log, touched, CALM.box), None, CALM)["S1 while near"])
    height_m = drone[before].position_enu_m[2] - 1.5 - landing.reach_m
    assert margins[1] == pytest.approx(height_m / 0.5, abs=0.01)
    assert margins[0] > margins[1]


def test_drone_that_stops_its_motors_in_the_air_is_below_zero_by_its_height() -> None:
    result = flown(hover((9.0, 0.0, 0.9)), speed_rad_s=0.0)
    assert result.margin == pytest.approx(1.0 - (0.9 - 0.12) / 0.3, abs=0.01)


def test_drone_that_never_took_off_is_below_zero() -> None:
    assert flown(hover((9.0, 0.0, 0.12))).margin == pytest.approx(-1.0)


def test_fence_counts_from_the_distance_in_which_a_fast_drone_stops() -> None:
    path = [body(t_s, (10.0 * t_s, 0.0, 5.0), (10.0, 0.0, 0.0)) for t_s in TIMES_S[:500]]
    margins = [flown(path, replace(CALM, fence_radius_m=radius_m)).margin for radius_m in (40.0, 50.0, 70.0, 500.0)]
    assert margins[0] == pytest.approx((40.0 - 49.9) / 60.0)
    assert margins == sorted(margins)


def test_tilt_of_an_aggressive_flight_within_the_airframes_limit_is_no_danger() -> None:
    rolled = hover((0.0, 0.0, 6.0), roll_rad=math.radians(44.0))
    assert flown([*rolled, *[body(t_s, HIGH, STILL) for t_s in TIMES_S[300:500]]]).margin == 1.0


def test_reported_fault_is_below_zero_whatever_the_landing() -> None:
    assert scored(Landing(), faults=("fights the pilot",)).margin == -1.0


def test_success_of_the_source_report_has_what_is_left_of_its_distance() -> None:
    report = replace(CALM, report_rule=True, box=replace(CALM.box, roof_height_m=0.0))
    path = [body(t_s, (0.3, 0.0, 5.0 - min(t_s, 4.5)), (0.0, 0.0, -1.0)) for t_s in TIMES_S[:500]]
    result = flown(path, report)
    assert result.tier is Tier.S0
    assert result.margin == pytest.approx(1.0 - result.closest_m / 0.7)


@pytest.mark.parametrize(
    ("least", "unsafe", "expected"), [(0.0, True, -LEAST), (-1e-9, True, -LEAST), (0.0, False, 0.0)]
)
def test_sign_at_the_limit_is_that_of_the_tier_and_survives_rounding(
    least: float, unsafe: bool, expected: float
) -> None:
    margin = margin_of({"one": least, "other": 0.5}, unsafe=unsafe)
    assert round(margin, 6) == expected


def test_margin_does_not_jump_where_the_contact_leaves_the_limits() -> None:
    errors_m = np.linspace(0.47, 0.53, 4)
    margins = [scored(Landing(error_m=(float(error_m), 0.0))).margin for error_m in errors_m]
    assert np.diff(margins) == pytest.approx(-0.04, abs=0.004)


def test_blades_above_the_roof_beside_the_pad_count_as_near_to_it() -> None:
    centred, aside = (scored(Landing(error_m=(error_m, 0.0), sink_m_s=0.3)).margin for error_m in (0.0, 0.42))
    assert aside < centred
    outside_m = 0.42 + BLADE_REACH_M - PAD_HALF_M
    assert outside_m > 0.0
    assert aside <= 0.12 / 0.5 + 0.01
