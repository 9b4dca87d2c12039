"""Fixes from the future, or whose stamps step: no landing on them is begun or goes on; a few of them change nothing."""

from collections.abc import Iterable
from itertools import zip_longest

import numpy as np
import pytest

from companion.core.reasons import Reason
from companion.integrity.stamps import FixStamps, have_stamps_stepped, is_step_of_stamps, update_fix_stamps
from companion.integrity.way import WayError
from companion.situation.phases import Phase
from link.messages import Command
from link.records import replace
from tests.companion.facts import changed, pad_at, situation
from tests.companion.world import CONFIG, LANDING, PAD, START_NS, Flight, KnownVehicle, reached

AHEAD_S = 0.3
HOLD_S = CONFIG.integrity.fix_ahead_hold_s


@pytest.mark.slow
@pytest.mark.parametrize("phase", LANDING)
def test_landing_on_fixes_from_the_future_is_broken_off(phase: Phase) -> None:
    flight = reached(phase)
    flight.stamps_ahead_s = AHEAD_S
    flight.run_until(Phase.ABORT, limit_s=HOLD_S + 0.1)
    assert flight.reason is Reason.VEHICLE_CLOCK_AHEAD
    flight.run_until(Phase.HOLD)
    assert "0.30 s before their stamps" in flight.sentence
    assert "link is too slow" in flight.sentence


GPS_WEEKS_1024_S = 1024 * 7 * 86400.0


@pytest.mark.slow
@pytest.mark.parametrize("set_back_s", [3.0, GPS_WEEKS_1024_S])
def test_clock_that_is_set_back_in_flight_is_told_as_such(set_back_s: float) -> None:
    flight = reached(Phase.CHASE)
    flight.stamps_ahead_s = -set_back_s
    flight.run_until(Phase.ABORT, limit_s=CONFIG.abort.fix_age_max_s + 0.2)
    flight.run_until(Phase.HOLD)
    assert flight.reason is Reason.STAMPS_LATE
    assert f"{set_back_s:.2f} s after their stamps" in flight.sentence


def test_launch_over_late_stamps_is_refused_for_them() -> None:
    flight = Flight(stamps_ahead_s=-GPS_WEEKS_1024_S)
    flight.run(1.0)
    reply = flight.step(Command.LAUNCH).reply
    assert reply is not None
    assert not reply.accepted
    assert "after their stamps" in reply.reason


def test_wait_tells_of_late_stamps_before_it_tells_of_a_heading_that_they_leave_unknown() -> None:
    far = replace(PAD, antenna_to_pad_m=(1.0, 0.0, 0.0))
    flight = Flight(vehicle=KnownVehicle((-20.0, 0.4, 1.5), (4.0, 0.0, 0.0), yaw_rad=None), pad=far)
    flight.start_and_reach(Phase.WAITING)
    told = flight.step()
    flight.stamps_ahead_s = -GPS_WEEKS_1024_S
    flight.run(1.0)
    now = flight.step()
    assert (told.status.reason_code, now.status.reason_code) == ("HEADING_UNKNOWN", "STAMPS_LATE")


def test_one_fix_that_comes_very_late_among_others_is_no_clock_that_was_set() -> None:
    flight = reached(Phase.WAITING)
    for step in range(100):
        flight.stamps_ahead_s = -3.0 if step % 40 == 0 else -0.05
        flight.step()
        assert flight.memory.progress.obstacle is None


def test_landing_on_fixes_from_the_future_is_not_begun() -> None:
    flight = Flight(stamps_ahead_s=AHEAD_S)
    flight.run(HOLD_S + 0.1)
    reply = flight.step(Command.START).reply
    assert reply is not None
    assert not reply.accepted
    assert "set its clock" in reply.reason
    assert flight.phase is Phase.IDLE


@pytest.mark.slow
@pytest.mark.parametrize("ahead_s", [-0.4, -0.1, 0.0, 0.9 * CONFIG.integrity.fix_ahead_max_s])
def test_late_fixes_and_clocks_that_err_a_little_are_landed_on(ahead_s: float) -> None:
    flight = Flight(stamps_ahead_s=ahead_s)
    flight.start_and_reach(Phase.SECURED)
    assert Phase.ABORT not in flight.history


def test_early_fixes_among_others_change_nothing() -> None:
    flight = reached(Phase.CHASE)
    for step in range(round(3.0 * HOLD_S / 0.02)):
        flight.stamps_ahead_s = AHEAD_S if step % 40 == 0 else -0.05
        flight.step()
        assert flight.phase is not Phase.ABORT


def on_way(ahead_s: float, across_m: float = 0.02, speed_m_s: float = 7.0) -> WayError:
    return WayError(ahead_s=ahead_s, across_m=across_m, speed_m_s=speed_m_s)


def heard(
    stamps: FixStamps, ages_s: Iterable[float], period_s: float = 0.1, ways: Iterable[WayError] = ()
) -> FixStamps:
    """The stamps after fixes of these ages, one each period, and where the first of them are on the vehicle's way."""
    for age_s, way in zip_longest(list(ages_s), ways):
        now_ns = (stamps.ages[-1][0] if not stamps.recent else stamps.recent[-1][0]) if stamps.ages else START_NS
        now_ns += round(period_s * 1e9)
        stamps = update_fix_stamps(stamps, now_ns - round(age_s * 1e9), now_ns, now_ns, way=way)
    return stamps


def jittering(count: int, about_s: float = 0.1, seed: int = 1) -> list[float]:
    return [about_s + off_s for off_s in np.random.default_rng(seed).uniform(-0.05, 0.05, count).tolist()]


@pytest.mark.parametrize("stepped_s", [-0.4, -0.16, 0.16, 0.4])
@pytest.mark.parametrize("period_s", [0.05, 0.1, 0.2, 0.5])
def test_clock_that_was_set_is_found_within_two_seconds_and_by_how_much(stepped_s: float, period_s: float) -> None:
    before = heard(FixStamps(), jittering(60), period_s)
    after = heard(before, jittering(round(2.0 / period_s), 0.1 + stepped_s, seed=2), period_s)
    assert after.stepped_s == pytest.approx(stepped_s, abs=0.1)
    assert after.stepped_s * stepped_s > 0.0


@pytest.mark.parametrize("seed", range(20))
def test_jitter_and_a_burst_after_an_outage_are_no_step(seed: int) -> None:
    ages_s = [*jittering(80, seed=seed), 2.0, 1.5, 1.0, 0.5, *jittering(80, seed=100 + seed)]
    stamps = FixStamps()
    for age_s in ages_s:
        stamps = heard(stamps, [age_s])
        assert stamps.stepped_s == 0.0


def test_step_is_over_once_fixes_come_as_before_or_after_a_minute() -> None:
    stepped = heard(heard(FixStamps(), jittering(60)), jittering(20, 0.3, seed=2))
    assert stepped.stepped_s > 0.0
    assert heard(stepped, jittering(20, seed=3)).stepped_s == 0.0
    assert heard(stepped, jittering(590, 0.3, seed=3)).stepped_s > 0.0
    assert heard(stepped, jittering(620, 0.3, seed=3)).stepped_s == 0.0


@pytest.mark.parametrize(("ahead_s", "is_step"), [(0.01, False), (-0.04, False), (0.19, True), (-0.12, True)])
def test_link_that_becomes_slower_is_no_step_but_a_clock_that_is_set_back_is(ahead_s: float, *, is_step: bool) -> None:
    before = heard(FixStamps(), jittering(60), ways=[on_way(0.01)] * 60)
    after = heard(before, jittering(20, 0.3, seed=2), ways=[on_way(ahead_s), *[on_way(-0.01)] * 19])
    assert (after.stepped_s != 0.0) is is_step


@pytest.mark.parametrize(
    ("age_s", "way", "expected"),
    [
        (0.18, on_way(0.08), True),
        (0.03, on_way(-0.072), True),
        (0.18, on_way(0.04), False),  # 0.28 m less than its stamp explains
        (0.18, on_way(0.08, across_m=0.2), False),
        (0.1, on_way(0.08), False),
        (0.1, on_way(0.002), False),
        (0.18, None, False),
    ],
)
def test_step_of_a_stamp_is_one_that_age_and_way_tell_alike(
    age_s: float, way: WayError | None, *, expected: bool
) -> None:
    assert is_step_of_stamps(heard(FixStamps(), [0.1] * 12), age_s, way) is expected


@pytest.mark.parametrize(
    ("speed_m_s", "stepped_s", "is_seen", "expected"),
    [(5.0, 0.07, False, True), (5.0, 0.055, False, False), (15.0, -0.06, False, True), (15.0, -0.06, True, False)],
)
def test_step_counts_where_it_moves_an_unseen_pad_by_more_than_s2_allows(
    speed_m_s: float, stepped_s: float, expected: bool, *, is_seen: bool
) -> None:
    pad = pad_at((speed_m_s, 0.0, 0.0))
    pad = replace(pad, frame_offset=replace(pad.frame_offset, is_confirmed=is_seen))
    assert have_stamps_stepped(changed(situation(pad=pad), stamps_stepped_s=stepped_s), CONFIG) is expected


def told(stamps: FixStamps, newest_ns: int | None, t_ns: int, refused_age_s: float | None = None) -> FixStamps:
    return update_fix_stamps(stamps, newest_ns, t_ns, t_ns, refused_age_s=refused_age_s)


def test_age_is_that_of_the_step_which_took_the_fix_in() -> None:
    first = told(FixStamps(), START_NS, START_NS + 200_000_000)
    assert first.age_on_arrival_s == pytest.approx(0.2)
    assert told(first, START_NS, START_NS + 900_000_000) == first
    second = told(first, START_NS + 500_000_000, START_NS + 400_000_000)
    assert second.age_on_arrival_s == pytest.approx(-0.1)
    assert told(second, None, START_NS) == FixStamps()


def test_refused_fix_from_the_future_tells_by_how_much_it_came_early() -> None:
    known = told(FixStamps(), START_NS, START_NS + 200_000_000)
    refused = told(known, START_NS, START_NS + 300_000_000, refused_age_s=-3.0)
    assert refused == replace(known, age_on_arrival_s=-3.0)
