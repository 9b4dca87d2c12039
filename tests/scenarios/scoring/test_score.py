import math

import numpy as np
import pytest

from link.frames.rotations import quaternion_from_roll_pitch_yaw, rotate
from link.messages import BodyTruth, Vector3
from link.records import replace
from scenarios.catalogue.catalogue import load_scenario
from scenarios.scoring.score import Score, Tier, score
from scenarios.scoring.touchdown import ScoreRules, rules_of
from sim_autopilot.air.airflow import Obstacle
from sim_autopilot.physics.contact import BLADE_REACH_M
from tests.scenarios.scoring.synthetic import (
    CALM,
    CONTACT_S,
    RULES,
    STILL,
    TIMES_S,
    Landing,
    at_ns,
    body,
    flown,
    scored,
)

NOT_SECURED = Landing(off_after_s=None)
HANGAR = Obstacle(length_m=20.0, width_m=13.7, height_m=6.1, ahead_m=20.0, foot_m=1.5)


def test_measures_at_contact_are_those_of_the_descent() -> None:
    result = scored(Landing(error_m=(0.12, -0.09), drift_m_s=(0.3, 0.4), sink_m_s=0.6, tilt_rad=0.1))
    assert result.touchdown is not None
    assert result.touchdown.horizontal_error_m == pytest.approx(0.15, abs=0.005)
    assert result.touchdown.relative_speed_m_s == pytest.approx(0.5)
    assert result.touchdown.sink_rate_m_s == pytest.approx(0.6)
    assert result.touchdown.tilt_rad == pytest.approx(0.1)
    assert result.touchdown.on_pad


def test_contact_is_interpolated_between_the_samples() -> None:
    # Only the lowest point tells the instant; at 100 Hz the samples are 10 ms apart.
    sink_m_s = 0.4
    drop_m = [
        (t_s, body(t_s, (0.0, 0.0, 1.62 + sink_m_s * (CONTACT_S - t_s)), (0.0, 0.0, -sink_m_s))) for t_s in TIMES_S
    ]
    result = flown([sample for t_s, sample in drop_m if t_s < CONTACT_S + 0.02])
    assert result.touchdown is not None
    assert result.touchdown.contact_t_ns == pytest.approx(at_ns(CONTACT_S), abs=1000)


def test_time_to_contact_starts_when_the_vehicle_passes_the_waiting_point() -> None:
    result = scored(Landing())
    assert result.start_t_ns == at_ns(2.0)
    assert result.time_to_contact_s == pytest.approx(CONTACT_S - 2.0, abs=0.01)


def test_time_to_contact_starts_when_a_standing_vehicle_departs() -> None:
    hover = [body(t_s, (0.0, 0.0, 5.0), STILL) for t_s in TIMES_S]
    vehicle = [body(t_s, (max(0.0, t_s - 5.0), 0.0, 0.0), STILL) for t_s in TIMES_S]
    assert score(hover, vehicle, [], CALM).start_t_ns == at_ns(5.0)


def test_start_of_the_manoeuvre_can_be_given() -> None:
    landing = Landing()
    truth = [landing.drone(t_s) for t_s in TIMES_S], [landing.vehicle(t_s) for t_s in TIMES_S]
    result = score(*truth, [], CALM, started_ns=at_ns(3.0))
    assert result.time_to_contact_s == pytest.approx(CONTACT_S - 3.0, abs=0.01)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("landing", "tier"),
    [
        (replace(NOT_SECURED, error_m=(0.299, 0.0)), Tier.S2),
        (replace(NOT_SECURED, error_m=(0.301, 0.0)), Tier.S1),
        (replace(NOT_SECURED, error_m=(0.0, -0.499)), Tier.S1),
        (replace(NOT_SECURED, error_m=(0.0, -0.501)), Tier.UNSAFE),
        (replace(NOT_SECURED, drift_m_s=(0.0, 0.499)), Tier.S2),
        (replace(NOT_SECURED, drift_m_s=(0.0, 0.501)), Tier.S1),
        (replace(NOT_SECURED, drift_m_s=(-0.999, 0.0)), Tier.S1),
        (replace(NOT_SECURED, drift_m_s=(-1.001, 0.0)), Tier.UNSAFE),
        (replace(NOT_SECURED, sink_m_s=0.699), Tier.S2),
        (replace(NOT_SECURED, sink_m_s=0.701), Tier.S1),
        (replace(NOT_SECURED, sink_m_s=0.999), Tier.S1),
        (replace(NOT_SECURED, sink_m_s=1.001), Tier.UNSAFE),
        (replace(NOT_SECURED, tilt_rad=math.radians(9.99)), Tier.S2),
        (replace(NOT_SECURED, tilt_rad=math.radians(10.01)), Tier.S1),
        (replace(NOT_SECURED, tilt_rad=math.radians(14.99)), Tier.S1),
        (replace(NOT_SECURED, tilt_rad=math.radians(15.01)), Tier.UNSAFE),
    ],
)
def test_tier_changes_at_its_limit(landing: Landing, tier: Tier) -> None:
    assert scored(landing).tier is tier


@pytest.mark.slow
@pytest.mark.parametrize(
    ("landing", "tier"),
    [
        (Landing(error_m=(0.45, 0.0)), Tier.S3),  # S3 is S1, secured
        (Landing(off_after_s=1.98), Tier.S3),
        (Landing(off_after_s=2.02), Tier.S2),
        (Landing(off_after_s=0.5, slide_m_s=0.116), Tier.S3),  # slides for 2.5 s
        (Landing(off_after_s=0.5, slide_m_s=0.124), Tier.S2),
    ],
)
def test_secured_means_motors_off_in_time_and_no_sliding(landing: Landing, tier: Tier) -> None:
    assert scored(landing).tier is tier


def test_landing_is_not_secured_before_it_has_stayed_for_two_seconds() -> None:
    landing = Landing(off_after_s=1.0)
    assert scored(landing, until_s=CONTACT_S + 1.0 + 1.95).tier is Tier.S2
    assert scored(landing, until_s=CONTACT_S + 1.0 + 2.05).tier is Tier.S3


def test_motors_off_and_slide_are_measured() -> None:
    result = scored(Landing(off_after_s=0.5, slide_m_s=0.1))
    assert result.motors_off_s == pytest.approx(0.5, abs=0.011)
    assert result.slid_m == pytest.approx(0.25, abs=0.003)


def test_trim_is_the_tilt_that_the_drag_needs() -> None:
    result = scored(replace(NOT_SECURED, vehicle_m_s=20.0), replace(RULES, obstacle=None))
    assert result.touchdown is not None
    assert result.touchdown.trim_rad == pytest.approx(math.atan(0.25 * 20.0 / (1.507 * 9.81)))


def test_trim_counts_the_air_that_the_vehicle_makes() -> None:
    landing = replace(NOT_SECURED, vehicle_m_s=20.0)
    over_the_car, behind_a_hangar = (
        scored(landing, replace(RULES, obstacle=obstacle)).touchdown for obstacle in (RULES.obstacle, HANGAR)
    )
    assert over_the_car is not None
    assert behind_a_hangar is not None
    assert over_the_car.trim_rad == pytest.approx(math.atan(0.25 * 24.0 / (1.507 * 9.81)), abs=0.02)
    assert behind_a_hangar.trim_rad == pytest.approx(0.0, abs=0.05)


def test_trim_counts_the_wind() -> None:
    tailwind = replace(RULES, wind_mean_enu_m_s=(20.0, 0.0, 0.0))
    result = scored(replace(NOT_SECURED, vehicle_m_s=20.0), tailwind)
    assert result.touchdown is not None
    assert result.touchdown.trim_rad == pytest.approx(0.0, abs=1e-9)


def test_tilt_within_the_trim_is_allowed() -> None:
    fast = replace(NOT_SECURED, vehicle_m_s=20.0, tilt_rad=math.radians(28.0))
    assert scored(fast, RULES).tier is Tier.S2
    assert scored(fast, CALM).tier is Tier.UNSAFE


@pytest.mark.parametrize(
    ("landing", "words"),
    [
        (Landing(error_m=(0.0, 0.7)), "roof outside the pad"),
        (Landing(sink_m_s=1.4, drift_m_s=(1.2, 0.0)), "relative_speed_m_s 1.2, sink_rate_m_s 1.4"),
    ],
)
def test_unsafe_contact_says_why(landing: Landing, words: str) -> None:
    result = scored(landing)
    assert result.tier is Tier.UNSAFE
    assert words in result.reason


def test_contact_with_the_ground_is_unsafe() -> None:
    pad_on_road = replace(CALM, box=replace(CALM.box, roof_height_m=0.0))
    result = scored(Landing(error_m=(0.0, 1.6), roof_m=0.0), pad_on_road)
    assert (result.tier, result.reason) == (Tier.UNSAFE, "contact with the ground")


def test_flying_into_the_flank_is_unsafe() -> None:
    path = [body(t_s, (-6.0 + t_s, 0.0, 1.0), (1.0, 0.0, 0.0)) for t_s in TIMES_S[:500]]
    result = flown(path)
    assert (result.tier, result.reason) == (Tier.UNSAFE, "contact with the vehicle's side")


def test_motors_off_in_the_air_are_unsafe() -> None:
    path = [body(t_s, (9.0, 0.0, 5.0), STILL) for t_s in TIMES_S[:500]]
    result = flown(path, speed_rad_s=0.0)
    assert (result.tier, result.reason) == (Tier.UNSAFE, "motors off in the air")


def _tips_over(rules: ScoreRules, from_index: int = -300) -> Score:
    landing = NOT_SECURED
    drone = [landing.drone(t_s) for t_s in TIMES_S]
    tipped = quaternion_from_roll_pitch_yaw(1.0, 0.0, 0.0)
    drone[from_index:] = [replace(sample, orientation_wxyz=tipped) for sample in drone[from_index:]]
    return score(drone, [landing.vehicle(t_s) for t_s in TIMES_S], [], rules)


def test_tipping_over_on_the_deck_is_unsafe() -> None:
    result = _tips_over(CALM)
    assert (result.tier, result.reason) == (Tier.UNSAFE, "tipped over on the deck")


def test_what_a_deck_does_not_carry_is_judged_by_its_contact_alone() -> None:
    rules = replace(CALM, carries=False)
    assert _tips_over(rules).tier in {Tier.S1, Tier.S2}
    assert _tips_over(rules, from_index=0).tier is Tier.UNSAFE


def test_breaking_the_fence_is_unsafe() -> None:
    path = [body(t_s, (10.0 * t_s, 0.0, 5.0), (10.0, 0.0, 0.0)) for t_s in TIMES_S[:500]]
    assert flown(path, replace(CALM, fence_radius_m=40.0)).reason == "fence broken"


@pytest.mark.parametrize(("vehicle_m_s", "is_broken"), [(10.0, False), (1.0, True)])
def test_fence_of_a_sortie_drives_along_with_its_vehicle(vehicle_m_s: float, is_broken: bool) -> None:
    drone = [body(t_s, (10.0 * t_s, 3.0, 5.0), (10.0, 0.0, 0.0)) for t_s in TIMES_S[:500]]
    vehicle = [body(t_s, (vehicle_m_s * t_s, 0.0, 0.0), (vehicle_m_s, 0.0, 0.0)) for t_s in TIMES_S[:500]]
    result = score(drone, vehicle, [], replace(CALM, fence_radius_m=40.0, fence_drives_along=True))
    assert (result.reason == "fence broken") is is_broken
    assert (result.margin < 0.0) is is_broken


def test_reported_fault_is_unsafe_whatever_the_landing() -> None:
    result = scored(Landing(), faults=("fights the pilot",))
    assert (result.tier, result.reason) == (Tier.UNSAFE, "fights the pilot")


def test_drone_that_ends_in_the_air_clear_and_stable_aborted() -> None:
    assert flown([body(t_s, (0.0, 0.0, 5.0), STILL) for t_s in TIMES_S[:300]]).tier is Tier.ABORT


@pytest.mark.parametrize(
    ("position", "roll_rad", "reason"),
    [
        ((0.0, 0.0, 2.3), 0.0, "ends close to the vehicle or the ground"),
        ((9.0, 0.0, 0.9), 0.0, "ends close to the vehicle or the ground"),
        ((9.0, 0.0, 5.0), 1.0, "ends unstable"),
        ((9.0, 0.0, 5.0), 1.5, "tipped over"),
    ],
)
def test_end_in_the_air_that_is_not_clear_or_stable_is_unsafe(position: Vector3, roll_rad: float, reason: str) -> None:
    result = flown([body(t_s, position, STILL, roll_rad=roll_rad) for t_s in TIMES_S[:300]])
    assert (result.tier, result.reason) == (Tier.UNSAFE, reason)


@pytest.mark.parametrize(("apart_m", "tier"), [(0.05, Tier.UNSAFE), (0.99, Tier.UNSAFE), (1.01, Tier.ABORT)])
@pytest.mark.parametrize("axis", [0, 1])
def test_drone_that_ends_beside_the_flank_is_clear_from_a_metre_on(axis: int, apart_m: float, tier: Tier) -> None:
    position = [0.0, 0.0, 1.3]
    position[axis] = -0.5 * RULES.box.roof_size_m[axis] - BLADE_REACH_M - apart_m
    beside = (position[0], position[1], position[2])
    vehicle = [body(t_s, STILL, STILL) for t_s in TIMES_S[:300]]
    result = score([body(t_s, beside, STILL) for t_s in TIMES_S[:300]], vehicle, [], CALM)
    assert result.tier is tier


def test_drone_that_never_took_off_is_unsafe() -> None:
    result = flown([body(t_s, (9.0, 0.0, 0.12), STILL) for t_s in TIMES_S[:300]])
    assert (result.tier, result.reason) == (Tier.UNSAFE, "never took off")


def test_standing_on_the_ground_before_take_off_is_no_contact() -> None:
    rise = [body(t_s, (9.0, 0.0, 0.118 + max(0.0, t_s - 1.0)), (0.0, 0.0, 1.0)) for t_s in TIMES_S[:600]]
    result = flown(rise)
    assert (result.tier, result.touchdown) == (Tier.ABORT, None)


REPORT = rules_of(load_scenario("report_1"))


def near_pass(distance_m: float) -> list[BodyTruth]:
    """Return a flight that comes down to `distance_m` above the vehicle's centre and climbs again."""
    return [body(t_s, (0.0, 0.0, distance_m + abs(4.0 - t_s)), STILL) for t_s in TIMES_S[:800]]


@pytest.mark.parametrize(("distance_m", "tier"), [(0.699, Tier.S0), (0.701, Tier.ABORT)])
def test_report_counts_a_distance_of_seventy_centimetres(distance_m: float, tier: Tier) -> None:
    path = near_pass(distance_m)
    vehicle = [replace(sample, position_enu_m=STILL) for sample in path]
    result = score(path, vehicle, [], REPORT, started_ns=at_ns(1.0))
    assert result.tier is tier
    assert (result.time_to_s0_s is not None) is (tier is Tier.S0)
    assert result.closest_m == pytest.approx(distance_m, abs=1e-9)


def test_report_counts_the_distance_even_when_the_contact_after_it_is_hard() -> None:
    landing = Landing(roof_m=0.0, sink_m_s=3.0)
    result = scored(landing, REPORT)
    assert result.tier is Tier.S0
    assert result.touchdown is not None
    assert result.touchdown.sink_rate_m_s == pytest.approx(3.0)


def test_report_landing_counts_for_the_best_it_reaches() -> None:
    assert scored(Landing(roof_m=0.0), REPORT).tier is Tier.S3


def test_seventy_centimetres_from_the_pad_of_a_roof_are_reported_but_no_landing() -> None:
    path = [body(t_s, (0.0, 0.0, 2.15 + abs(4.0 - t_s)), STILL) for t_s in TIMES_S[:800]]
    result = score(path, [replace(sample, position_enu_m=STILL) for sample in path], [], CALM, started_ns=at_ns(1.0))
    assert result.tier is Tier.ABORT
    assert result.time_to_s0_s is not None


def test_report_ignores_the_distance_before_the_start() -> None:
    path = [body(t_s, (0.0, 0.0, min(5.0, 0.12 + t_s)), STILL) for t_s in TIMES_S]
    vehicle = [replace(sample, position_enu_m=STILL) for sample in path]
    result = score(path, vehicle, [], REPORT, started_ns=at_ns(8.0))
    assert (result.tier, result.time_to_s0_s) == (Tier.ABORT, None)


@pytest.mark.slow
@pytest.mark.parametrize("landing", [Landing(), Landing(error_m=(0.0, 0.7)), Landing(off_after_s=None)])
def test_json_has_the_same_keys_for_every_outcome_and_only_finite_numbers(landing: Landing) -> None:
    table = scored(landing).to_json()
    assert table.keys() == flown(near_pass(4.0)).to_json().keys()
    assert all(math.isfinite(value) for value in table.values() if isinstance(value, float))
    assert {type(value) for value in table.values()} <= {str, bool, int, float, type(None)}


def test_truth_of_the_vehicle_at_other_times_is_interpolated() -> None:
    landing = NOT_SECURED
    shifted = [landing.vehicle(t_s + 0.0043) for t_s in TIMES_S]
    result = score([landing.drone(t_s) for t_s in TIMES_S], [landing.vehicle(0.0), *shifted], [], CALM)
    assert result.touchdown is not None
    assert result.touchdown.horizontal_error_m == pytest.approx(0.1, abs=1e-6)


def test_too_little_truth_is_refused() -> None:
    with pytest.raises(ValueError, match="cannot be scored"):
        score([body(0.0, STILL, STILL)], [], [], CALM)


def test_truth_out_of_order_is_refused() -> None:
    backwards = [body(t_s, (0.0, 0.0, 5.0), STILL) for t_s in (1.0, 0.0)]
    with pytest.raises(ValueError, match="order of time"):
        score(backwards, backwards, [], CALM)


def test_relative_speed_on_a_turning_deck_is_against_the_pad_below() -> None:
    # Both turn about the vehicle's origin at 0.5 rad/s, the drone 0.4 m away: no motion against the deck.
    rate_rad_s = 0.5
    times_s = [t_s for t_s in TIMES_S if t_s < CONTACT_S + 0.02]

    def turning(t_s: float, radius_m: float, z_m: float, climb_m_s: float) -> BodyTruth:
        q_WB = quaternion_from_roll_pitch_yaw(0.0, 0.0, rate_rad_s * t_s)
        out = rotate(q_WB, (radius_m, 0.0, 0.0))
        return BodyTruth(
            t_ns=at_ns(t_s),
            position_enu_m=(out[0], out[1], z_m),
            orientation_wxyz=q_WB,
            velocity_flu_m_s=(0.0, rate_rad_s * radius_m, climb_m_s),
            angular_velocity_flu_rad_s=(0.0, 0.0, rate_rad_s),
        )

    drone = [turning(t_s, 0.4, 1.62 + 0.5 * (CONTACT_S - t_s), -0.5) for t_s in times_s]
    result = score(drone, [turning(t_s, 0.0, 0.0, 0.0) for t_s in times_s], [], CALM)
    assert result.touchdown is not None
    assert result.touchdown.relative_speed_m_s == pytest.approx(0.0, abs=1e-6)
    assert result.touchdown.horizontal_error_m == pytest.approx(0.4, abs=1e-4)
    assert np.isclose(result.touchdown.sink_rate_m_s, 0.5)
