"""Clocks by a hand-turned wall clock: rates, monotony, and what happens when ticks stay away."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.program.clock import EXTRAPOLATION_MAX_S, ScaledClock, SimulatedClock, SystemClock, TickFilter

MS = 1_000_000
S = 1_000_000_000
EPOCH_NS = 1_750_000_000 * S


class Wall:
    """A monotonic clock that a test turns."""

    def __init__(self) -> None:
        self.ns = 987_654_321

    def __call__(self) -> int:
        return self.ns


def ticking(wall: Wall, *, speed: int, ticks: int) -> SimulatedClock:
    """Return a clock after `ticks` ticks, 10 ms of wall time apart."""
    clock = SimulatedClock(monotonic_ns=wall)
    for index in range(ticks):
        wall.ns += 10 * MS
        clock.tick(EPOCH_NS + index * 10 * MS * speed)
    return clock


def test_system_clock_ignores_a_step_of_the_system_time() -> None:
    wall = Wall()
    utc_ns = iter([EPOCH_NS, EPOCH_NS + 3600 * S])
    clock = SystemClock(utc_ns=lambda: next(utc_ns), monotonic_ns=wall)
    wall.ns += 3 * S
    assert clock.now_ns() == EPOCH_NS + 3 * S
    assert clock.wall_s(0.25) == 0.25


def test_scaled_clock_runs_at_its_speed() -> None:
    wall = Wall()
    clock = ScaledClock(speed=4.0, epoch_ns=EPOCH_NS, monotonic_ns=wall)
    wall.ns += 5 * MS
    assert clock.now_ns() == EPOCH_NS + 20 * MS
    assert clock.wall_s(0.2) == 0.05


@pytest.mark.parametrize("speed", [0.0, -1.0, float("inf"), float("nan")])
def test_scaled_clock_refuses_a_speed_that_is_none(speed: float) -> None:
    with pytest.raises(ValueError, match="speed"):
        ScaledClock(speed=speed, epoch_ns=0)


def test_simulated_clock_is_ready_with_the_first_tick() -> None:
    clock = SimulatedClock(monotonic_ns=Wall())
    was_ready = clock.ready
    with pytest.raises(RuntimeError, match="not ticked"):
        clock.now_ns()
    clock.tick(EPOCH_NS)
    assert (was_ready, clock.ready) == (False, True)
    assert clock.now_ns() == EPOCH_NS


@pytest.mark.parametrize("speed", [1, 4, 50])
def test_simulated_clock_runs_on_between_ticks_at_their_rate(speed: int) -> None:
    wall = Wall()
    clock = ticking(wall, speed=speed, ticks=20)
    last_ns = clock.now_ns()
    wall.ns += 7 * MS
    assert clock.rate == pytest.approx(speed)
    assert clock.now_ns() - last_ns == pytest.approx(7 * MS * speed)
    assert clock.wall_s(0.1) == pytest.approx(0.1 / speed)


def test_simulated_clock_stops_when_ticks_stay_away() -> None:
    wall = Wall()
    clock = ticking(wall, speed=4, ticks=20)
    last_ns = clock.now_ns()
    wall.ns += 10 * S
    assert clock.now_ns() - last_ns == pytest.approx(4 * EXTRAPOLATION_MAX_S * S)


def test_simulated_clock_stands_until_the_simulator_has_caught_up() -> None:
    wall = Wall()
    clock = ticking(wall, speed=4, ticks=20)
    wall.ns += 40 * MS
    ahead_ns = clock.now_ns()
    clock.tick(ahead_ns - 30 * MS)
    assert clock.now_ns() == ahead_ns


def test_simulated_clock_takes_queued_ticks_for_no_rate() -> None:
    wall = Wall()
    clock = SimulatedClock(monotonic_ns=wall)
    for index in range(10):
        wall.ns += 1000
        clock.tick(EPOCH_NS + index * 10 * MS)
    assert clock.rate == 1.0


def test_simulated_clock_learns_a_new_rate_within_its_window() -> None:
    wall = Wall()
    clock = ticking(wall, speed=10, ticks=100)
    newest_ns = EPOCH_NS + 99 * 100 * MS
    for index in range(1, 100):
        wall.ns += 10 * MS
        clock.tick(newest_ns + index * 10 * MS)
    assert clock.rate == pytest.approx(1.0)


@pytest.mark.slow
@given(st.lists(st.tuples(st.integers(0, 100 * MS), st.integers(-50 * MS, 500 * MS)), max_size=50))
def test_simulated_clock_never_goes_back(steps: list[tuple[int, int]]) -> None:
    wall = Wall()
    clock = SimulatedClock(monotonic_ns=wall)
    simulated_ns = EPOCH_NS
    clock.tick(simulated_ns)
    shown_ns = clock.now_ns()
    for wall_step_ns, simulated_step_ns in steps:
        wall.ns += wall_step_ns
        simulated_ns += simulated_step_ns
        clock.tick(simulated_ns)
        assert clock.now_ns() >= shown_ns
        shown_ns = clock.now_ns()


def test_a_stray_tick_is_not_believed_and_does_not_disturb_the_others() -> None:
    ticks = TickFilter()
    taken = [t_s for t_s in (100, 101, 9_000, 102, 2, 103, 104) if ticks.accepts(t_s * S)]
    assert taken == [100, 101, 102, 103, 104]


@pytest.mark.parametrize("start_s", [3, 5_000])
def test_a_simulator_that_starts_anew_is_believed_after_a_few_ticks(start_s: int) -> None:
    ticks = TickFilter()
    assert ticks.accepts(100 * S)
    believed = [ticks.accepts(start_s * S + tick * 10_000_000) for tick in range(8)]
    assert believed == [False] * 4 + [True] * 4


def test_simulated_clock_runs_on_when_the_simulator_is_started_anew_in_the_past() -> None:
    wall = Wall()
    clock = SimulatedClock(monotonic_ns=wall)
    clock.tick(EPOCH_NS)
    before_ns = clock.now_ns()
    for tick in range(100):
        wall.ns += 10 * MS
        clock.tick(EPOCH_NS - 60 * S + tick * 40 * MS)
    assert before_ns + 3.7 * S < clock.now_ns() < before_ns + 4.0 * S
