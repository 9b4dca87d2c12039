"""The energy that is left and the way home: closed forms, and what BATTERY_STATUS can tell."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.sortie.memory import RESOLUTION, BatteryWatch, left_s, update_battery, use_per_s
from companion.sortie.station import closing_speed_m_s, intercept_s

RESERVE = 0.2


def watched(shares: list[tuple[float, float]]) -> BatteryWatch:
    """A battery that was told these (seconds, share)."""
    watch = BatteryWatch()
    for time_s, share in shares:
        watch = update_battery(watch, share, round(time_s * 1e9))
    return watch


def left_of(watch: BatteryWatch, time_s: float) -> float:
    return left_s(watch, RESERVE, round(time_s * 1e9))


def test_rate_of_use_is_that_between_two_changes() -> None:
    # The first percent had begun before the flight: what it took says nothing.
    watch = watched([(0.0, 1.0), (3.0, 0.99), (9.0, 0.99), (21.0, 0.98), (39.0, 0.97)])
    assert use_per_s(watch) == pytest.approx(0.02 / 36.0)
    assert left_of(watch, 39.0) == pytest.approx((0.97 - RESOLUTION - RESERVE) * 1800.0)


def test_without_a_rate_only_the_reserve_is_told() -> None:
    assert left_of(BatteryWatch(), 0.0) == math.inf
    assert left_of(watched([(0.0, 0.6), (10.0, 0.59)]), 10.0) == math.inf
    assert left_of(watched([(0.0, 0.21), (10.0, 0.2)]), 10.0) == 0.0


def test_two_quick_percents_of_a_voltage_that_sags_are_no_rate_of_use() -> None:
    sags = watched([(0.0, 0.51), (10.0, 0.5), (11.0, 0.49)])
    assert left_of(sags, 11.0) > 600.0


def test_two_changes_told_at_once_make_no_rate() -> None:
    assert use_per_s(watched([(0.0, 0.6), (10.0, 0.59), (10.0, 0.58)])) is None


@given(
    risen=st.lists(st.tuples(st.integers(30, 420), st.integers(1, 5)), max_size=8),
    sagged=st.lists(st.tuples(st.integers(60, 420), st.integers(1, 3)), max_size=3),
)
def test_share_that_sags_and_recovers_leaves_the_rate_of_use_what_it_was(
    risen: list[tuple[int, int]], sagged: list[tuple[int, int]]
) -> None:
    """One report a second of a battery that lasts 20 minutes; some are up to 5 percents too high, some too low."""
    off = dict(risen) | {at: -percents for at, percents in sagged}
    watch = BatteryWatch()
    for time_s in range(450):
        told = 0.6 - 0.01 * (time_s // 12 - off.get(time_s, 0))
        watch = update_battery(watch, round(told, 2), time_s * 10**9)
        if time_s > 120 and time_s not in off:
            truly_s = (0.6 - RESERVE) * 1200.0 - time_s
            assert abs(left_of(watch, float(time_s)) - truly_s) < 0.35 * truly_s + 24.0


def test_share_that_is_found_to_be_more_counts_at_the_rate_of_before() -> None:
    watch = watched([(0.0, 0.5), (10.0, 0.49), (46.0, 0.48), (60.0, 0.9)])
    assert use_per_s(watch) == pytest.approx(0.01 / 36.0)
    assert left_of(watch, 60.0) == pytest.approx((0.9 - RESOLUTION - RESERVE) * 3600.0)


def test_share_that_was_told_far_too_low_for_a_moment_is_forgotten_after_half_a_minute() -> None:
    """One report a second of a battery that lasts 20 minutes; two of them say that it is empty."""
    watch = BatteryWatch()
    for time_s in range(240):
        share = 0.1 if time_s in (100, 101) else round(0.8 - 0.01 * (time_s // 12), 2)
        watch = update_battery(watch, share, time_s * 10**9)
        if time_s == 101:
            assert left_of(watch, 101.0) == 0.0
    assert left_of(watch, 239.0) == pytest.approx((0.8 - RESERVE) * 1200.0 - 240.0, rel=0.1)


@given(silent_s=st.floats(0.0, 3600.0))
def test_battery_that_tells_nothing_more_drains_on_as_it_did(silent_s: float) -> None:
    watch = watched([(0.0, 0.62), (12.0, 0.61), (24.0, 0.60), (36.0, 0.59), (48.0, 0.58)])
    truly_s = (0.58 - RESERVE) * 1200.0 - silent_s
    assert left_of(watch, 48.0 + silent_s) == pytest.approx(max(min(truly_s, (0.57 - RESERVE) * 1200.0), 0.0))


def test_a_share_that_is_not_told_changes_nothing() -> None:
    watch = watched([(0.0, 0.5), (10.0, 0.49)])
    assert update_battery(watch, None, 20_000_000_000) is watch


ways = st.tuples(st.floats(-900.0, 900.0), st.floats(-900.0, 900.0)).map(np.array)


@given(way=ways, vehicle=st.tuples(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0)).map(np.array))
def test_a_drone_that_closes_in_flies_at_its_limit_and_meets_the_vehicle(way: np.ndarray, vehicle: np.ndarray) -> None:
    limit_m_s = 14.0
    closing_m_s = closing_speed_m_s(way, vehicle, limit_m_s)
    distance_m = math.hypot(*way.tolist())
    if distance_m < 1e-3:
        return
    flown = vehicle + closing_m_s * way / distance_m
    assert math.hypot(*flown.tolist()) == pytest.approx(limit_m_s)
    meets_s = distance_m / closing_m_s
    assert flown * meets_s == pytest.approx(way + vehicle * meets_s, abs=1e-6)


def test_a_vehicle_that_is_faster_is_not_met_from_behind() -> None:
    assert intercept_s(np.array([40.0, 5.0]), np.array([16.0, 2.0]), 14.0, 1.5) is None
    assert intercept_s(np.array([-40.0, -5.0]), np.array([16.0, 2.0]), 14.0, 1.5) is not None


def test_an_intercept_takes_the_time_to_gain_and_lose_speed_too() -> None:
    # 300 m behind a vehicle of 10 m/s at 14 m/s: 75 s at 4 m/s of difference, and 4 / 1.5 s to gain and lose that.
    assert intercept_s(np.array([300.0, 0.0]), np.array([10.0, 0.0]), 14.0, 1.5) == pytest.approx(75.0 + 4.0 / 1.5)
