import math
import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.mavlink.clock_line import ClockPair, fit_clock_line
from link.mavlink.clock_map import ClockMap, RoundTrip, with_round_trip, with_system_time

MS = 1_000_000
S = 1_000_000_000
LOCAL_NS = 1_795_000_000 * S
BOOT_NS = 17 * S
UTC_AHEAD_NS = 41 * S + 7_654_321


def boot_at(local_ns: int, drift: float) -> int:
    return BOOT_NS + round((local_ns - LOCAL_NS) * (1.0 + drift))


def exchanged(drift: float, way_s: tuple[float, float], duration_s: float, seed: int) -> tuple[ClockMap, int]:
    """The map after TIMESYNC at 10 Hz for 2 s, then at 2 Hz, each way taking a uniform time; and the time then."""
    generator = random.Random(seed)
    clock, t_ns, count = ClockMap(), LOCAL_NS, 0
    while t_ns < LOCAL_NS + duration_s * S:
        there_ns, back_ns = (round(generator.uniform(*way_s) * S) for _ in range(2))
        answered = boot_at(t_ns + there_ns, drift)
        clock = with_round_trip(clock, RoundTrip(t_ns, t_ns + there_ns + back_ns, answered))
        t_ns += 100 * MS if count < 20 else 500 * MS
        count += 1
    return clock, t_ns


@pytest.mark.parametrize("drift", [0.025, -0.025, 2e-5])
@pytest.mark.parametrize("duration_s", [1.0, 3.0, 60.0])
def test_a_drifting_clock_is_mapped_within_2_ms_over_a_quick_link(drift: float, duration_s: float) -> None:
    clock, t_ns = exchanged(drift, (0.0005, 0.0025), duration_s, seed=3)
    for ahead_ns in (0, 500 * MS):
        mapped = clock.local_to_boot_ns(t_ns + ahead_ns)
        assert mapped is not None
        assert abs(mapped - boot_at(t_ns + ahead_ns, drift)) < 2 * MS


@pytest.mark.slow
def test_a_jittering_link_is_averaged_below_its_jitter() -> None:
    errors_ns = []
    for seed in range(20):
        clock, t_ns = exchanged(0.025, (0.05, 0.15), 30.0, seed)
        errors_ns.append((clock.local_to_boot_ns(t_ns) or 0) - boot_at(t_ns, 0.025))
    assert math.sqrt(np.mean(np.square(errors_ns))) < 12 * MS  # one exchange alone: 20 ms


@pytest.mark.parametrize("jitter_s", [0.0, 0.004, 0.05])
def test_the_deviation_of_the_delay_is_that_of_one_way(jitter_s: float) -> None:
    clock, _ = exchanged(1e-5, (0.1 - jitter_s, 0.1 + jitter_s), 60.0, seed=5)
    uniform_s = jitter_s / math.sqrt(3.0)
    assert clock.one_way_std_s == pytest.approx(uniform_s, rel=0.3, abs=1e-6)
    assert ClockMap().one_way_std_s == 0.0


@pytest.mark.slow
def test_the_stated_uncertainty_is_that_of_the_errors() -> None:
    shares = []
    for seed in range(40):
        clock, t_ns = exchanged(0.01, (0.01, 0.03), 20.0, seed)
        error_ns = (clock.local_to_boot_ns(t_ns) or 0) - boot_at(t_ns, 0.01)
        shares.append(error_ns / (clock.local_to_boot_std_ns(t_ns) or math.nan))
    assert 0.3 < math.sqrt(np.mean(np.square(shares))) < 1.5


def test_drift_is_found() -> None:
    clock, _ = exchanged(0.025, (0.0005, 0.0015), 10.0, seed=5)
    assert clock.local_to_boot is not None
    assert clock.local_to_boot.drift == pytest.approx(0.025, abs=2e-4)


def test_the_companions_own_clock_error_cancels() -> None:
    utc_error_ns = []
    for own_error_ns in (0, 3 * 3600 * S):
        clock, t_ns = exchanged(0.001, (0.001, 0.001), 5.0, seed=1)
        shifted = ClockMap()
        for trip in clock.round_trips:
            moved = RoundTrip(trip.sent_ns + own_error_ns, trip.received_ns + own_error_ns, trip.boot_ns)
            shifted = with_round_trip(shifted, moved)
        shifted = with_system_time(shifted, boot_at(t_ns, 0.001), t_ns + UTC_AHEAD_NS)
        utc_error_ns.append(shifted.local_to_utc_ns(t_ns + own_error_ns) - (t_ns + UTC_AHEAD_NS))
    assert max(map(abs, utc_error_ns)) < 10_000


def test_local_time_is_taken_for_utc_until_utc_is_known() -> None:
    clock, t_ns = exchanged(0.02, (0.001, 0.001), 3.0, seed=1)
    unset = with_system_time(clock, boot_at(t_ns, 0.02), 0)
    assert not unset.is_utc_known
    assert unset.local_to_utc_ns(t_ns) == t_ns
    assert unset.boot_to_utc_ns(boot_at(t_ns, 0.02)) == pytest.approx(t_ns, abs=MS)
    assert with_system_time(clock, boot_at(t_ns, 0.02), t_ns + UTC_AHEAD_NS).is_utc_known


@pytest.mark.parametrize("unix_ns", [2**31 * S, (2**64 - 1) * 1000], ids=["no room in a stamp", "all bits"])
def test_utc_of_another_age_is_passed_over(unix_ns: int) -> None:
    clock, t_ns = exchanged(0.02, (0.001, 0.001), 3.0, seed=1)
    assert with_system_time(clock, boot_at(t_ns, 0.02), unix_ns) is clock


def test_an_empty_map_knows_only_local_time() -> None:
    clock = ClockMap()
    assert clock.local_to_utc_ns(LOCAL_NS) == LOCAL_NS
    assert (clock.local_to_boot_ns(LOCAL_NS), clock.boot_to_utc_ns(BOOT_NS)) == (None, None)


@pytest.mark.slow
@given(st.floats(-0.025, 0.025), st.integers(-60 * S, 60 * S))
def test_mapping_there_and_back_returns_to_the_start(drift: float, since_ns: int) -> None:
    clock, t_ns = exchanged(drift, (0.001, 0.002), 4.0, seed=2)
    for k in range(4):
        clock = with_system_time(clock, boot_at(LOCAL_NS + k * S, drift), LOCAL_NS + k * S + UTC_AHEAD_NS)
    local_ns = t_ns + since_ns
    boot_ns = clock.local_to_boot_ns(local_ns)
    assert boot_ns is not None
    assert abs((clock.boot_to_local_ns(boot_ns) or 0) - local_ns) <= 2


def test_a_step_of_the_boot_clock_is_followed_once_three_round_trips_tell_of_it() -> None:
    clock, t_ns = exchanged(0.01, (0.001, 0.002), 10.0, seed=4)
    for count in range(3):
        before = clock.local_to_boot
        answered = boot_at(t_ns + MS, 0.01) - 8 * S
        clock = with_round_trip(clock, RoundTrip(t_ns, t_ns + 2 * MS, answered))
        assert (clock.local_to_boot is before) is (count < 2)
        t_ns += 500 * MS
    t_ns -= 500 * MS
    assert abs((clock.local_to_boot_ns(t_ns + MS) or 0) - answered) < 2 * MS


def told_once_a_second(seconds: int) -> ClockMap:
    """The map after SYSTEM_TIME at 1 Hz."""
    clock = ClockMap()
    for k in range(seconds):
        clock = with_system_time(clock, BOOT_NS + k * S, LOCAL_NS + k * S)
    return clock


def test_a_step_of_utc_is_followed_once_three_messages_tell_of_it() -> None:
    clock = told_once_a_second(8)
    for k in range(8, 11):
        before = clock.boot_to_utc
        clock = with_system_time(clock, BOOT_NS + k * S, LOCAL_NS + k * S + UTC_AHEAD_NS)
        assert (clock.boot_to_utc is before) is (k < 10)
    assert clock.boot_to_utc_ns(BOOT_NS + 10 * S) == LOCAL_NS + 10 * S + UTC_AHEAD_NS


@pytest.mark.parametrize("known_s", [1, 8])
@pytest.mark.parametrize("period_ms", [20, 500])
@pytest.mark.parametrize("rate", [0.0, 0.5, -1.0])
def test_a_utc_that_stands_or_runs_slower_than_the_boot_clock_is_not_followed(
    rate: float, period_ms: int, known_s: int
) -> None:
    clock = told_once_a_second(known_s)
    began_ns = (known_s - 1) * S
    for k in range(1, 10 * S // (period_ms * MS)):
        since_ns = k * period_ms * MS
        unix_ns = LOCAL_NS + began_ns + round(rate * since_ns)
        clock = with_system_time(clock, BOOT_NS + began_ns + since_ns, unix_ns)
    assert abs((clock.boot_to_utc_ns(BOOT_NS + began_ns + 10 * S) or 0) - (LOCAL_NS + began_ns + 10 * S)) < 500 * MS


@pytest.mark.parametrize("rate", [1.12, 1.5])
def test_the_computers_utc_is_followed_beside_a_simulation_that_falls_behind(rate: float) -> None:
    clock = told_once_a_second(8)
    for k in range(1, 60):
        clock = with_system_time(clock, BOOT_NS + 7 * S + k * S // 2, LOCAL_NS + 7 * S + round(rate * k * S / 2))
    now_ns = LOCAL_NS + 7 * S + round(rate * 59 * S / 2)
    assert abs((clock.boot_to_utc_ns(BOOT_NS + 7 * S + 59 * S // 2) or 0) - now_ns) < 50 * MS


@pytest.mark.parametrize("steps_ms", [(100,), (190,), (-100, 100), (300, 100, -400)])
def test_messages_that_tell_of_no_step_together_move_nothing(steps_ms: tuple[int, ...]) -> None:
    clock = told_once_a_second(8)
    line = clock.boot_to_utc
    for k in range(30):
        boot_ns = BOOT_NS + 8 * S + k * S // 10
        clock = with_system_time(clock, boot_ns, LOCAL_NS + boot_ns - BOOT_NS + steps_ms[k % len(steps_ms)] * MS)
        if k % len(steps_ms) == len(steps_ms) - 1:
            clock = with_system_time(clock, boot_ns, LOCAL_NS + boot_ns - BOOT_NS)
    assert line is not None
    assert clock.boot_to_utc is not None
    for at_ns in (BOOT_NS + 8 * S, BOOT_NS + 12 * S):
        assert clock.boot_to_utc.y_ns(at_ns) == pytest.approx(line.y_ns(at_ns), abs=MS)


def test_a_simulation_at_four_times_real_time_is_followed() -> None:
    clock, t_ns = exchanged(3.0, (0.0005, 0.0015), 5.0, seed=6)
    assert abs((clock.local_to_boot_ns(t_ns) or 0) - boot_at(t_ns, 3.0)) < 5 * MS


def test_a_round_trip_that_ends_before_it_begins_is_passed_over() -> None:
    clock = ClockMap()
    assert with_round_trip(clock, RoundTrip(LOCAL_NS, LOCAL_NS - 1, BOOT_NS)) is clock


def test_uncertainty_grows_away_from_the_pairs() -> None:
    clock, t_ns = exchanged(0.01, (0.001, 0.003), 5.0, seed=4)
    near_ns, far_ns = (clock.local_to_boot_std_ns(t_ns + ahead_s * S) or math.nan for ahead_s in (0, 60))
    assert 0.0 < near_ns < far_ns


def test_the_fit_equals_numpys_least_squares_with_the_prior_as_a_row() -> None:
    generator = np.random.default_rng(11)
    x_ns = np.sort(generator.integers(0, 10 * S, 9))
    offset_ns = 5_000_000 + 0.013 * x_ns + generator.normal(0.0, 1e5, 9)
    std_ns = generator.uniform(1e5, 1e6, 9)
    pairs = [ClockPair(int(x), int(x + o), float(s)) for x, o, s in zip(x_ns, offset_ns, std_ns, strict=True)]
    line = fit_clock_line(pairs, 0.002, 0.01)
    x_s = (x_ns - x_ns[-1]) / S
    rows = np.vstack([np.column_stack([np.ones(9), x_s]) / std_ns[:, None], [0.0, 1.0 / 0.01e9]])
    values = np.append(np.array([p.y_ns - p.x_ns for p in pairs]) / std_ns, 0.002e9 / 0.01e9)
    expected, *_ = np.linalg.lstsq(rows, values)
    assert line.offset_ns == pytest.approx(expected[0], abs=1.0)
    assert line.drift == pytest.approx(expected[1] / S, rel=1e-6)
    covariance = np.linalg.inv(rows.T @ rows)
    assert line.std_ns(int(x_ns[-1]) + 3 * S) == pytest.approx(
        math.sqrt(np.array([1.0, 3.0]) @ covariance @ np.array([1.0, 3.0])), rel=1e-6
    )
