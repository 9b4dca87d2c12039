"""Rollouts obey what is known in closed form, and their machine code is their Python."""

import math

import numpy as np
import pytest

from companion.core.data import GRAVITY_M_S2
from companion.forecast import knowledge, rollout, steering
from companion.forecast import samples as samples_of
from companion.forecast.knowledge import relearn
from companion.forecast.rollout import roll_out
from companion.forecast.samples import ALONG, ASIDE, CONTACT, DT_S, ERROR, IN_S, SINK, SPEED, TILT
from tests.companion.forecast.descents import HEIGHT_M, NEVER_S, RULES, SINK_M_S, descent, samples


def test_a_contact_over_a_vehicle_that_does_what_is_expected_is_the_planned_one() -> None:
    (end,) = roll_out(samples(), descent(), 0.1)
    lowest_m = RULES.foot_radius_m * 0.5 / GRAVITY_M_S2
    assert end[CONTACT] == 1.0
    assert end[IN_S] == pytest.approx((HEIGHT_M - lowest_m) / SINK_M_S, abs=DT_S)
    assert end[[ERROR, SPEED, SINK, TILT]] == pytest.approx([0.0, 0.0, SINK_M_S, 0.0], abs=1e-9)


def test_a_brake_that_is_told_after_the_contact_meets_a_drone_that_flies_on() -> None:
    # from the newest datum on, 0.1 s ago: v = a t and s = a t^2 / 2, of which the drone knows nothing
    brakes = samples(kind=ALONG, event=np.array([0.0, -3.0, 1e-6, NEVER_S]), delay_s=5.0)
    (end,) = roll_out(brakes, descent(), 0.1)
    lasts_s = 0.1 + end[IN_S]
    assert end[CONTACT] == 1.0
    assert end[SPEED] == pytest.approx(3.0 * lasts_s, rel=0.1)
    assert end[ERROR] == pytest.approx(1.5 * lasts_s**2, rel=0.1)


def test_the_later_a_brake_is_known_the_faster_is_the_contact() -> None:
    speeds_m_s = [
        roll_out(samples(kind=ALONG, event=np.array([0.1, -2.0, 0.1, NEVER_S]), delay_s=late_s), descent(), 0.1)[0]
        for late_s in (0.05, 0.3, 0.6)
    ]
    first, second, third = (end[SPEED] for end in speeds_m_s)
    assert first < second < third


def test_a_brake_that_has_just_come_to_be_known_is_answered_once_a_setpoint_takes_effect() -> None:
    known = descent(0.15, level_below_m=-1.0)
    known.course.along_m_s2[:] = -3.0
    known.course.model[2] = [1.8, 2.4]  # the model does not brake yet
    later_s = 3.0 * DT_S
    ends = [roll_out(samples()._replace(ahead_s=np.array([s])), known, 0.1)[0] for s in (0.0, later_s)]
    assert all(end[CONTACT] == 1.0 for end in ends)
    assert 0.5 < (ends[1][SPEED] - ends[0][SPEED]) / (3.0 * later_s) < 1.0  # some of it is made up for


BEND_ENDS = np.array([0.1, 2.5, 1.2, NEVER_S])
"""Within 1.2 s by 2.5 m/s^2: a clothoid in town."""


def test_a_bend_that_a_trailing_antenna_shows_is_met_the_farther_beside_the_pad() -> None:
    ends = [roll_out(samples(kind=ASIDE, event=BEND_ENDS), descent(0.5, trails_s=s), 0.1)[0] for s in (-0.2, 0.0, 0.2)]
    ahead, at_pad, behind = (end[SPEED] for end in ends)
    assert ahead < at_pad < behind
    assert ends[2][ERROR] > ends[1][ERROR]


def test_an_acceleration_along_the_way_is_told_by_an_antenna_wherever_it_is() -> None:
    brakes = samples(kind=ALONG, event=np.array([0.1, -2.0, 0.1, NEVER_S]))
    ends = [roll_out(brakes, descent(0.5, trails_s=trails_s), 0.1)[0] for trails_s in (0.0, 0.2)]
    assert ends[1] == pytest.approx(ends[0], abs=1e-9)


def test_a_brake_ends_at_rest() -> None:
    stops = samples(kind=ALONG, event=np.array([0.0, -20.0, 1e-6, NEVER_S]), delay_s=9.0)
    (end,) = roll_out(stops, descent(), 0.5)
    assert end[SPEED] == pytest.approx(8.0, abs=0.2)  # a vehicle that went backwards would be met faster


def test_an_error_of_the_estimate_stays_an_error() -> None:
    errs = samples()
    errs.vehicle[0, 0] = [0.12, -0.05]
    (end,) = roll_out(errs, descent(), 0.1)
    assert end[ERROR] == pytest.approx(0.13, abs=1e-6)


def test_an_error_of_the_velocity_brings_the_drone_beside_the_pad_unless_it_is_learnt_anew() -> None:
    errs = samples()
    errs.vehicle[0, 1] = [0.3, -0.1]
    stays_m, goes_m = (roll_out(errs, descent(0.8, relearns_hz=hz), 0.1)[0, ERROR] for hz in (0.0, 5.0))
    assert goes_m < 0.5 * stays_m


def test_an_error_of_the_velocity_keeps_its_deviation_while_it_becomes_another_one() -> None:
    generator, relearns_hz, std_m_s = np.random.default_rng(6), 2.5, 0.2
    error, seen = np.array([[0.1, 0.1], [0.9, -0.9]]), []
    for _ in range(20_000):
        relearn(error, generator.standard_normal(2), math.exp(-relearns_hz * DT_S), std_m_s)
        seen.append(error[1].copy())
    later = round(1.0 / relearns_hz / DT_S)
    errors = np.array(seen[100:])
    alike = np.mean(errors[later:] * errors[:-later]) / std_m_s**2
    assert np.mean(np.square(errors)) == pytest.approx(std_m_s**2, rel=0.1)
    assert alike == pytest.approx(math.exp(-1.0), abs=0.06)
    assert error[0] == pytest.approx([0.1, 0.1])


@pytest.mark.parametrize("speed_m_s", [RULES.near_speed_m_s + 0.01, RULES.near_speed_m_s + 0.05])
def test_a_contact_after_a_short_wait_comes_as_much_later(speed_m_s: float) -> None:
    plain, moves = descent(0.8), samples()
    moves.deviation[0, 1] = [speed_m_s, 0.0]  # beside the model, which its gains take away
    (end,), (before,) = roll_out(moves, plain, 0.1), roll_out(samples(), plain, 0.1)
    waits_s = end[IN_S] - before[IN_S]
    assert end[CONTACT] == 1.0
    assert 0.0 < waits_s <= RULES.waits_max_s
    impatient = plain._replace(rules=RULES._replace(waits_max_s=waits_s - 2.0 * DT_S))
    assert roll_out(moves, impatient, 0.1)[0, CONTACT] == 0.0


def test_a_drone_that_sees_a_brake_above_where_it_commits_does_not_land() -> None:
    brakes = samples(kind=ALONG, event=np.array([0.0, -4.0, 0.1, NEVER_S]), delay_s=0.1)
    assert roll_out(brakes, descent(0.8), 0.3)[0, CONTACT] == 0.0
    assert roll_out(brakes, descent(0.15), 0.3)[0, CONTACT] == 1.0  # too low to stop sinking


def test_a_drone_whose_setpoints_are_led_is_level_at_the_contact_where_another_still_leans() -> None:
    leans = descent(turns_hz=4.0, level_m_s2=1.0, level_below_m=0.08)
    leans.course.left_m_s2[:] = 3.0
    as_it_comes, led = (
        roll_out(samples(), leans._replace(drone=leans.drone._replace(led_share=share)), 0.1)[0, TILT]
        for share in (0.0, 1.0)
    )
    level_rad = math.atan(1.0 / GRAVITY_M_S2) - math.atan(0.5 / GRAVITY_M_S2)  # of 1 m/s^2 the air takes a half
    assert led < level_rad + 0.02
    assert as_it_comes > led + 0.03


@pytest.mark.parametrize("slope", [(0.15, 0.0), (0.05, 0.14), (-0.21, 0.1)])
def test_a_drone_that_levels_leans_with_a_deck_that_tilts_and_gains_little_speed_by_that(
    slope: tuple[float, float],
) -> None:
    upright, levels = descent(level_below_m=-1.0), descent(level_below_m=0.1)
    for one in (upright, levels):
        one.course.slope[:] = slope
        one.course.air_enu_m_s2[:] = 0.0
    tilts_rad = [roll_out(samples(), one, 0.1)[0, TILT] for one in (upright, levels)]
    assert tilts_rad[0] == pytest.approx(math.atan(math.hypot(*slope)))
    assert tilts_rad[1] == pytest.approx(math.atan(levels.drone.level_m_s2 / GRAVITY_M_S2), abs=0.03)
    assert roll_out(samples(), levels, 0.1)[0, SPEED] < 0.35


@pytest.mark.parametrize("now", [-0.15, 0.0, 0.15])
def test_a_drone_levels_against_the_deck_as_it_will_tilt_at_the_contact_not_as_it_tilts_before(now: float) -> None:
    tilts_rad = []
    for later in (0.0, 0.15):
        swings = descent(level_below_m=0.1)
        swings.course.air_enu_m_s2[:] = 0.0
        swings.course.slope[:, 0] = np.interp(DT_S * np.arange(len(swings.course.slope)), [0.0, 0.7], [now, later])
        tilts_rad.append(roll_out(samples(), swings, 0.1)[0, TILT])
    assert tilts_rad == pytest.approx([0.0, math.atan(swings.drone.level_m_s2 / GRAVITY_M_S2)], abs=0.02)


@pytest.mark.parametrize("share", [0.0, 0.4, 1.0])
def test_what_holds_against_a_steady_wind_leans_the_drone_by_its_trim_whoever_holds_it(share: float) -> None:
    # a place that is off by what the gains answer to the push is at rest; the integrator holds the rest of the wind
    steady = descent()
    drone, wind = steady.drone, -steady.course.air_enu_m_s2
    pushed = samples()
    pushed.deviation[0, 3], pushed.deviation[0, 2] = share * wind, -share * wind
    pushed.deviation[0, 0] = share * wind / drone.stiffness_per_s2
    steady = steady._replace(drone=drone._replace(way_s=1e3))
    steady.course.model[0] = -pushed.deviation[0, 0]
    (end,) = roll_out(pushed, steady, 0.1)
    assert end[TILT] == pytest.approx(0.0, abs=math.radians(0.5))


def test_machine_code_is_its_python(monkeypatch: pytest.MonkeyPatch) -> None:
    several = samples(5, kind=ALONG, event=np.array([0.15, -2.5, 0.2, 0.8]))
    generator = np.random.default_rng(4)
    several = several._replace(
        vehicle=0.1 * generator.standard_normal(several.vehicle.shape),
        deviation=0.1 * generator.standard_normal(several.deviation.shape),
        pushes=generator.standard_normal(several.pushes.shape),
    )
    uneven = descent(push_std_m_s2=0.5, relearns_hz=3.0, error_std_m_s=0.1)
    compiled = roll_out(several, uneven, 0.17)
    for module in (rollout, steering, samples_of, knowledge):
        for name, kernel in vars(module).items():
            if hasattr(kernel, "py_func") and name != "roll_out":
                monkeypatch.setattr(module, name, kernel.py_func)
    plain = roll_out.py_func(several, uneven, 0.17)
    assert compiled == pytest.approx(plain, abs=1e-12)
