"""A setpoint that is carried on after its companion's death; its path is the simulated ArduCopter's own."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.autopilots.px4 import Px4Driver
from companion.autopilots.response import Shaping
from companion.landing.carried_on import (
    FARTHEST_M,
    Carried,
    bound_climb,
    bound_motion,
    bound_reference,
    bound_sink,
    carried_m,
    speed_carried_m_s,
)
from companion.planning.guidance import ReferenceState
from sim_autopilot.core.limits import PathLimits
from sim_autopilot.setpoints.path import Motion, carry_on, correction_speed, lead_to_position

DEFAULT = ArduPilotDriver().shaping({})
ADVISED = ArduPilotDriver().shaping({"GUID_TIMEOUT": 1.0, "WPNAV_ACCEL": 500.0, "PSC_JERK_XY": 10.0})
DT_S, SETTLES_S = 0.02, 9.0
FEW = settings(max_examples=25)  # a path each
SHAPINGS = [shaping for shaping in (DEFAULT, ADVISED) if shaping is not None]

speeds, accelerations, rates = st.floats(-6.0, 6.0), st.floats(-4.0, 4.0), st.floats(-1.2, 2.0)
planes = st.tuples(speeds, speeds)
pushes = st.tuples(accelerations, accelerations)
shapings = st.sampled_from(SHAPINGS)


def _limits(shaping: Shaping) -> PathLimits:
    return PathLimits(
        speed_m_s=10.0,
        climb_m_s=2.5,
        descent_m_s=1.5,
        acceleration_m_s2=shaping.acceleration_m_s2,
        vertical_acceleration_m_s2=shaping.vertical_acceleration_m_s2,
        jerk_m_s3=shaping.jerk_m_s3,
        vertical_jerk_m_s3=shaping.vertical_jerk_m_s3,
        timeout_s=shaping.carried_s,
        throttle_slew_s=2.0,
    )


def _wish(reference: ReferenceState) -> Motion:
    position, velocity, acceleration = (
        (float(one[0]), float(one[1]), float(one[2]))
        for one in (reference.position_enu_m, reference.velocity_enu_m_s, reference.acceleration_enu_m_s2)
    )
    return Motion(position=position, velocity=velocity, acceleration=acceleration)


def _led(path: Motion, wish: Motion, shaping: Shaping, duration_s: float) -> list[Motion]:
    """Return the path of a drone that hears no more: its wish is carried on, and then it stands."""
    limits, motions = _limits(shaping), [path]
    for step in range(round(duration_s / DT_S)):
        if step * DT_S >= shaping.carried_s:
            wish = Motion(position=wish.position)
        path = carry_on(lead_to_position(path, wish, limits, correction_speed(limits), DT_S), DT_S)
        wish = carry_on(wish, DT_S)
        motions.append(path)
    return motions


def _moving(
    velocity: tuple[float, float, float], acceleration: tuple[float, float, float], height_m: float = 0.0
) -> ReferenceState:
    return ReferenceState(
        position_enu_m=np.array([0.0, 0.0, height_m]),
        velocity_enu_m_s=np.array(velocity),
        acceleration_enu_m_s2=np.array(acceleration),
    )


def test_px4_carries_nothing_on() -> None:
    assert Px4Driver().shaping({}) is None


def test_shaping_is_read_from_the_parameters_by_their_old_and_their_new_names() -> None:
    old = {"GUID_TIMEOUT": 2.0, "WPNAV_ACCEL": 300.0, "PSC_JERK_XY": 4.0, "WPNAV_ACCEL_Z": 150.0, "PSC_JERK_Z": 7.0}
    new = {"GUID_TIMEOUT": 2.0, "WP_ACC": 3.0, "PSC_JERK_NE": 4.0, "WP_ACC_Z": 1.5, "PSC_JERK_D": 7.0}
    assert ArduPilotDriver().shaping(old) == ArduPilotDriver().shaping(new)
    assert ArduPilotDriver().shaping(new) == Shaping(
        carried_s=2.0,
        acceleration_m_s2=3.0,
        jerk_m_s3=4.0,
        vertical_acceleration_m_s2=1.5,
        vertical_jerk_m_s3=7.0,
    )


@pytest.mark.parametrize("shaping", SHAPINGS)
def test_steady_flight_at_the_speed_that_may_be_carried_on_ends_as_far_as_is_accepted(shaping: Shaping) -> None:
    speed_m_s = speed_carried_m_s(shaping)
    assert carried_m((0.6 * speed_m_s, 0.8 * speed_m_s), (0.0, 0.0), shaping) == pytest.approx(FARTHEST_M / 1.08)
    path = _moving((0.6 * speed_m_s, 0.8 * speed_m_s, 0.0), (0.0, 0.0, 0.0))
    flown = _led(_wish(path), _wish(path), shaping, SETTLES_S)
    assert max(math.hypot(*motion.position[:2]) for motion in flown) == pytest.approx(FARTHEST_M / 1.08, abs=0.6)


@FEW
@given(planes, pushes, shapings)
def test_drone_is_carried_no_farther_than_from_the_steady_speed(
    velocity: tuple[float, float], acceleration: tuple[float, float], shaping: Shaping
) -> None:
    fast_m_s = max(speed_carried_m_s(shaping), math.hypot(*velocity))
    bounded = bound_motion(velocity, acceleration, fast_m_s, shaping)
    assert carried_m(*bounded, shaping) <= carried_m((fast_m_s, 0.0), (0.0, 0.0), shaping) * (1.0 + 1e-9)
    before = _wish(_moving((*velocity, 0.0), (*acceleration, 0.0)))
    wish = _wish(_moving((*bounded[0], 0.0), (*bounded[1], 0.0)))
    limit_m = carried_m((fast_m_s, 0.0), (0.0, 0.0), shaping)
    flown = _led(before, wish, shaping, shaping.carried_s + 6.0)
    lag_m = 0.5 * shaping.acceleration_m_s2 / shaping.jerk_m_s3 * math.hypot(*acceleration) + 1.0
    assert max(math.hypot(*motion.position[:2]) for motion in flown) <= limit_m + lag_m


@given(planes, pushes)
def test_what_is_asked_for_otherwise_accelerates_the_path_alike(
    velocity: tuple[float, float], acceleration: tuple[float, float]
) -> None:
    shaping, fast_m_s = SHAPINGS[0], 40.0
    slow_m_s = max(math.hypot(*velocity), 6.0) + 2.0
    size = max(math.hypot(*acceleration) / 2.4, 1.0)  # the correction's own limit is 2.5 m/s^2
    gentle = (acceleration[0] / size, acceleration[1] / size)
    asked = [bound_motion(velocity, gentle, most, shaping) for most in (fast_m_s, slow_m_s)]
    before = _wish(_moving((*velocity, 0.0), (*gentle, 0.0)))
    after = [_led(before, _wish(_moving((*v, 0.0), (*a, 0.0))), shaping, DT_S)[-1] for v, a in asked]
    np.testing.assert_allclose(after[0].acceleration, after[1].acceleration, atol=2.0 * shaping.jerk_m_s3 * DT_S)


@FEW
@given(rates, accelerations, st.floats(0.0, 4.0), shapings)
def test_sinking_path_ends_no_lower_than_it_has_room_or_than_by_the_setpoint_as_it_was(
    climb_m_s: float, up_m_s2: float, room_m: float, shaping: Shaping
) -> None:
    lower_m, rate_m_s, rest_m_s2 = bound_sink(climb_m_s, up_m_s2, room_m, shaping)
    plain = _moving((0.0, 0.0, climb_m_s), (0.0, 0.0, up_m_s2))
    changed = _moving((0.0, 0.0, rate_m_s), (0.0, 0.0, rest_m_s2), -lower_m)
    ends_m = [
        min(motion.position[2] for motion in _led(_wish(plain), _wish(asked), shaping, SETTLES_S))
        for asked in (plain, changed)
    ]
    overshoots_m = 0.15  # of a path whose acceleration needs its time
    assert ends_m[1] >= min(ends_m[0], 0.0) - overshoots_m


@pytest.mark.parametrize("sink_m_s", [0.1, 0.45, 0.8, 1.2])
def test_setpoint_that_stays_lower_sinks_a_path_as_fast(sink_m_s: float) -> None:
    shaping = SHAPINGS[0]
    path = _wish(_moving((0.0, 0.0, -sink_m_s), (0.0, 0.0, 0.0), 3.0))
    limits, height_m = _limits(shaping), 3.0
    for _ in range(round(1.0 / DT_S)):
        asked = _moving((0.0, 0.0, -sink_m_s), (0.0, 0.0, 0.0), height_m)
        carried = Carried(speed_m_s=30.0, climb_m_s=3.0, lowest_enu_m=height_m)
        wish = _wish(bound_reference(asked, carried, shaping))
        path = carry_on(lead_to_position(path, wish, limits, correction_speed(limits), DT_S), DT_S)
        height_m -= sink_m_s * DT_S
    assert path.velocity[2] == pytest.approx(-sink_m_s, abs=0.01)
    assert path.position[2] == pytest.approx(3.0 - sink_m_s, abs=0.01)


def test_descent_with_room_is_asked_for_as_it_is() -> None:
    assert bound_sink(-0.5, -0.1, 3.0, SHAPINGS[0]) == (0.0, -0.5, -0.1)


@given(rates, accelerations, shapings)
def test_climb_is_carried_on_to_the_fastest_that_is_planned(climb_m_s: float, up_m_s2: float, shaping: Shaping) -> None:
    rate_m_s, rest_m_s2 = bound_climb(climb_m_s, up_m_s2, 2.5, shaping)
    led_m_s = climb_m_s + up_m_s2 * shaping.vertical_acceleration_m_s2 / shaping.vertical_jerk_m_s3
    assert rate_m_s + rest_m_s2 * shaping.carried_s <= max(2.5, led_m_s) + 1e-9


@pytest.mark.parametrize(("told_s", "carried_s"), [(0.0, 0.1), (-1.0, 0.1), (0.05, 0.1), (2.0, 2.0), (math.nan, 3.0)])
def test_a_timeout_that_no_autopilot_flies_is_the_one_that_it_takes(told_s: float, carried_s: float) -> None:
    shaping = ArduPilotDriver().shaping({"GUID_TIMEOUT": told_s})
    assert shaping is not None
    assert shaping.carried_s == carried_s
