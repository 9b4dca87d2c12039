"""A pad that is seen where neither receiver allows it, and sightings that contradict each other, end an approach."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.autopilots.frame_moves import FrameMoves
from companion.config.companion import CompanionConfig
from companion.config.estimation import EstimatorKind
from companion.config.integrity import IntegrityConfig, ReceiverFrames
from companion.core.data import FIXED_STD_MAX_M, Measurement, Quantity
from companion.core.reasons import Cause, Reason
from companion.integrity.sightings import (
    SightingWatch,
    are_sightings_impossible,
    do_sightings_disagree,
    forget_agreement,
    forget_step,
    is_pad_sighted,
    is_seen_elsewhere,
    update_sightings,
)
from companion.situation.phases import Event, Phase
from companion.situation.situation import Situation
from companion.vehicle.estimator import BufferHealth
from companion.vehicle.pad import FrameOffset, PadPath, pad_path
from companion.vehicle.pad_reach import cone_radius_at_pad_m, is_unseen
from link.messages import PadGeometry
from link.records import replace
from tests.companion.facts import CONFIG, LONG_HEARD, braking_pad, changed, decided, pad_at, progress, situation
from tests.companion.health import health_of
from tests.companion.vehicle.drives import NOMINAL, Sensors, circle
from tests.companion.vehicle.rides import arrivals, estimator, now_ns

AUTO = CONFIG
ONE = CompanionConfig(integrity=IntegrityConfig(receiver_frames=ReceiverFrames.ONE))
HALF_M = 0.75
SHARE = CONFIG.integrity.rejected_share_max
RTK = replace(NOMINAL, pad_rate_hz=30.0, frame_offset_m=0.0)


def seen(off_m: float, *, std_m: float = 0.0, fix_std_m: float = 0.02, has_one_frame: bool = True) -> Situation:
    offset = FrameOffset(distance_m=off_m, std_m=std_m)
    pad = replace(pad_at(), frame_offset=offset, has_one_frame=has_one_frame)
    return changed(situation(pad=pad), fix_std_m=fix_std_m)


@pytest.mark.parametrize("is_seen", [True, False])
def test_sightings_are_impossible_only_where_the_pad_has_been_seen(*, is_seen: bool) -> None:
    """A tractor's antenna over furrows, 1.7 m/s to and fro 1.4 times a second at 5 Hz, was taken for a detector."""
    pad = braking_pad(CONFIG.integrity.acceleration_max_m_s2 + 0.1)
    pad = replace(pad, is_coarse=True, frame_offset=FrameOffset(distance_m=0.0, std_m=0.1 if is_seen else 1.0))
    assert are_sightings_impossible(situation(pad=pad), CONFIG) is is_seen


@pytest.mark.parametrize(
    ("config", "harmless_m"), [(ONE, cone_radius_at_pad_m(HALF_M, ONE)), (AUTO, HALF_M)], ids=["known", "taken"]
)
def test_pad_seen_beside_what_both_receivers_say_is_elsewhere(config: CompanionConfig, harmless_m: float) -> None:
    assert not is_seen_elsewhere(seen(harmless_m - 0.01), config)
    assert is_seen_elsewhere(seen(harmless_m + 0.01), config)


def test_pad_is_elsewhere_once_sightings_are_sure_that_its_offset_does_harm() -> None:
    assert not is_seen_elsewhere(seen(HALF_M + 0.02, std_m=0.13), AUTO)
    assert is_seen_elsewhere(seen(HALF_M + 0.4, std_m=0.13), AUTO)
    assert is_seen_elsewhere(seen(HALF_M + 0.2, std_m=0.05), AUTO)


@given(off_m=st.floats(0.0, 50.0), std_m=st.floats(0.0, 10.0), fix_std_m=st.floats(0.0, 10.0))
@pytest.mark.parametrize("config", [ONE, AUTO])
def test_nothing_is_elsewhere_by_less_than_three_deviations_of_what_is_stated(
    config: CompanionConfig, off_m: float, std_m: float, fix_std_m: float
) -> None:
    facts = seen(off_m, std_m=std_m, fix_std_m=fix_std_m)
    if is_seen_elsewhere(facts, config):
        assert off_m > 3.0 * math.hypot(std_m, *2 * [max(fix_std_m, FIXED_STD_MAX_M)])
        assert is_seen_elsewhere(seen(off_m + 1.0, std_m=std_m, fix_std_m=fix_std_m), config)


def test_between_two_frames_any_offset_may_be_true() -> None:
    assert not is_seen_elsewhere(seen(5.0, has_one_frame=False), AUTO)


@pytest.mark.parametrize(("since_origin_m", "is_elsewhere"), [(2.0, False), (0.0, True)])
def test_step_of_its_own_place_explains_as_much_until_its_origin_moves(
    since_origin_m: float, is_elsewhere: bool
) -> None:
    facts = seen(HALF_M + 1.9)
    assert is_seen_elsewhere(facts, AUTO)
    moved = FrameMoves(shift_enu_m=(2.0, 0.0, 3.0), since_origin_enu_m=(since_origin_m, 0.0, 3.0))
    facts = replace(facts, autopilot=replace(facts.autopilot, frame_moves=moved))
    assert is_seen_elsewhere(facts, AUTO) is is_elsewhere


def test_what_no_sighting_has_shown_is_nowhere_else() -> None:
    assert not is_seen_elsewhere(situation(), ONE)
    assert not is_seen_elsewhere(seen(0.9, std_m=1.0), ONE)


@pytest.mark.parametrize("off_m", [HALF_M - 0.01, HALF_M + 0.01])
def test_receiver_that_states_nothing_is_taken_for_one_with_fixed_phases(off_m: float) -> None:
    assert is_seen_elsewhere(changed(seen(off_m), fix_std_m=None), AUTO) is (off_m > HALF_M)


def beside(measurement: Measurement, off_m: float) -> Measurement:
    if measurement.quantity is not Quantity.PAD:
        return measurement
    return replace(measurement, value=measurement.value + np.array([0.6 * off_m, -0.8 * off_m, 0.0]))


@pytest.mark.parametrize(("off_m", "is_elsewhere"), [(1.0, True), (0.0, False)])
def test_estimate_shows_a_detector_that_is_off(off_m: float, *, is_elsewhere: bool) -> None:
    facts = after_ride(RTK, off_m)
    assert facts.pad is not None
    assert facts.pad.frame_offset.distance_m == pytest.approx(off_m, abs=0.1)
    assert is_seen_elsewhere(facts, ONE) is is_elsewhere
    assert is_seen_elsewhere(facts, AUTO) is is_elsewhere


def after_ride(sensors: Sensors, off_m: float) -> Situation:
    chosen = estimator(EstimatorKind.IMM)
    memory = chosen.fuse(None, [])
    for measurement in arrivals(circle(), sensors, 5):
        if measurement.t_ns < now_ns(5.0):
            memory = chosen.fuse(memory, [beside(measurement, off_m)])
    forecast = chosen.forecast(memory, now_ns(5.0), np.arange(0.0, 1.0, 0.2))
    assert forecast is not None
    described = PadGeometry(size_m=(2.0 * HALF_M, 2.0 * HALF_M), height_m=1.5, antenna_to_pad_m=(0.0, 0.0, 0.0))
    return changed(situation(pad=pad_path(forecast, described)), fix_std_m=0.02)


def health(accepted: int, rejected: int, moves: int = 0) -> BufferHealth:
    return health_of({Quantity.PAD: (accepted, rejected)}, moves_to_sightings=moves)


@given(
    before=st.tuples(st.integers(0, 500), st.integers(0, 500)), now=st.tuples(st.integers(0, 99), st.integers(0, 99))
)
def test_sightings_are_mixed_while_more_than_the_share_of_those_that_came_is_rejected(
    before: tuple[int, int], now: tuple[int, int]
) -> None:
    then = SightingWatch(counted=before)
    watch = update_sightings(then, health(before[0] + now[0], before[1] + now[1]), 0, CONFIG)
    assert watch.are_mixed is (now[1] > SHARE * sum(now))


@pytest.mark.parametrize(("silent_s", "is_sighted"), [(0.0, True), (1.5, True), (2.5, False)])
def test_pad_is_sighted_while_single_sightings_are_accepted(silent_s: float, *, is_sighted: bool) -> None:
    seen_once = update_sightings(SightingWatch(), health(1, 0), 7_000_000_000, CONFIG)
    now_ns = 7_000_000_000 + round(silent_s * 1e9)
    watch = forget_step(update_sightings(seen_once, health(1, 3), now_ns, CONFIG))
    assert is_pad_sighted(watch, now_ns) is is_sighted
    assert not is_pad_sighted(update_sightings(SightingWatch(), health(0, 3), now_ns, CONFIG), now_ns)


def test_estimate_that_begins_anew_is_counted_anew() -> None:
    assert not update_sightings(SightingWatch(counted=(90, 9)), health(3, 8), 0, CONFIG).are_mixed


def watched(*counts: tuple[int, int]) -> SightingWatch:
    """The watch after so many were accepted and rejected in each half second."""
    watch, total = SightingWatch(), (0, 0)
    for number, (accepted, rejected) in enumerate(counts):
        total = (total[0] + accepted, total[1] + rejected)
        watch = update_sightings(watch, health(*total), number * 500_000_000, CONFIG)
    return watch


@pytest.mark.parametrize(
    ("counts", "is_confirmed"),
    [
        ([(1, 0)], False),
        ([(1, 0), *6 * [(0, 0)]], False),
        ([(15, 0), (15, 0)], False),
        ([(15, 0), (15, 0), (15, 0)], True),
        ([(1, 0), (0, 9), (9, 0), (9, 0)], False),
        ([(2, 0), (2, 0), (2, 0), (0, 9)], True),
    ],
    ids=["one", "one, and no more", "half a second", "a second", "one that others contradict", "contradicted later"],
)
def test_sightings_confirm_a_place_after_a_second_of_agreement(
    counts: list[tuple[int, int]], *, is_confirmed: bool
) -> None:
    assert watched(*counts).is_confirmed is is_confirmed


def test_pad_that_is_seen_where_it_was_has_not_stepped_and_few_sightings_are_enough() -> None:
    watch = watched(*6 * [(1, 0)])
    assert watch.is_confirmed
    assert watch.agreeing == 6
    assert not watch.has_stepped
    assert not watch.are_mixed


@pytest.mark.parametrize(("lasts_ns", "is_confirmed"), [(999_999_999, False), (1_000_000_000, True)])
def test_agreement_of_less_than_a_second_confirms_nothing(lasts_ns: int, *, is_confirmed: bool) -> None:
    watch = update_sightings(SightingWatch(), health(9, 0), 0, CONFIG)
    assert update_sightings(watch, health(18, 0), lasts_ns, CONFIG).is_confirmed is is_confirmed


@pytest.mark.parametrize(
    ("news", "expected"), [({}, False), ({"are_sightings_mixed": True}, True), ({"has_pad_stepped": True}, True)]
)
def test_sightings_disagree_with_each_other_or_with_those_before(news: dict[str, bool], *, expected: bool) -> None:
    assert do_sightings_disagree(changed(situation(), **news), CONFIG) is expected


def test_place_that_was_lost_has_to_be_confirmed_anew() -> None:
    watch = forget_agreement(watched(*4 * [(9, 0)]))
    assert not watch.is_confirmed
    assert watch == forget_agreement(watch)
    for accepted, is_confirmed in ((37, False), (41, True)):
        assert update_sightings(watch, health(accepted, 0), 0, CONFIG).is_confirmed is is_confirmed


def test_confirmed_pad_that_is_seen_elsewhere_has_stepped_however_long_it_stays_there() -> None:
    watch = update_sightings(watched(*4 * [(9, 0)]), health(40, 12, moves=1), 0, CONFIG)
    for accepted in (60, 80, 100):
        watch = update_sightings(watch, health(accepted, 12, moves=1), 0, CONFIG)
        assert watch.has_stepped
        assert not watch.are_mixed


def test_place_that_was_not_confirmed_may_be_seen_elsewhere() -> None:
    watch = update_sightings(watched((9, 0)), health(9, 12, moves=1), 0, CONFIG)
    assert not update_sightings(watch, health(30, 12, moves=1), 0, CONFIG).has_stepped


def test_step_counts_for_an_approach_and_the_pad_has_to_be_confirmed_after_it() -> None:
    stepped = update_sightings(watched(*4 * [(9, 0)]), health(40, 12, moves=1), 0, CONFIG)
    forgotten = forget_step(stepped)
    assert not forgotten.has_stepped
    assert not forgotten.is_confirmed
    again = update_sightings(forgotten, health(49, 12, moves=1), 0, CONFIG)
    assert not again.has_stepped
    assert not again.is_confirmed
    assert forget_step(again) is again


def test_new_frame_of_the_drone_has_nothing_step() -> None:
    stepped = update_sightings(watched(*4 * [(9, 0)]), health(40, 12, moves=1), 0, CONFIG)
    assert not update_sightings(stepped, health(3, 0), 0, CONFIG).has_stepped


def moved(off_m: float, *, is_confirmed: bool, has_one_frame: bool) -> PadPath:
    offset = FrameOffset(distance_m=off_m, std_m=0.01, is_confirmed=is_confirmed)
    return replace(pad_at(), frame_offset=offset, has_one_frame=has_one_frame)


@given(off_m=st.floats(0.0, HALF_M), has_one_frame=st.booleans())
def test_unconfirmed_sightings_bring_no_drone_farther_off_than_its_cone(off_m: float, *, has_one_frame: bool) -> None:
    if not is_unseen(moved(off_m, is_confirmed=False, has_one_frame=has_one_frame), CONFIG):
        assert has_one_frame
        assert off_m <= cone_radius_at_pad_m(HALF_M, CONFIG)
    assert not is_unseen(moved(off_m, is_confirmed=True, has_one_frame=has_one_frame), CONFIG)


def test_estimator_counts_what_it_rejects_of_two_detectors() -> None:
    chosen = estimator(EstimatorKind.IMM)
    memory = chosen.fuse(None, [])
    sightings = 0
    for measurement in arrivals(circle(), RTK, 5):
        if measurement.t_ns < now_ns(4.0):
            sightings += measurement.quantity is Quantity.PAD
            memory = chosen.fuse(memory, [beside(measurement, 2.0 * (sightings % 3 == 0))])
    accepted, rejected = chosen.health(memory).counts(Quantity.PAD)
    assert accepted + rejected == sightings
    assert rejected > SHARE * sightings


def test_estimator_counts_that_all_sightings_have_left_the_pad_once() -> None:
    chosen = estimator(EstimatorKind.IMM)
    memory = chosen.fuse(None, [])
    for measurement in arrivals(circle(), RTK, 5):
        if measurement.t_ns < now_ns(4.0):
            memory = chosen.fuse(memory, [beside(measurement, 2.0 * (measurement.t_ns > now_ns(2.0)))])
    assert chosen.health(memory).moves_to_sightings == 1


@pytest.mark.parametrize("reason", [Reason.SEEN_ELSEWHERE, Reason.SIGHTINGS_DISAGREE])
def test_no_other_approach_is_made_by_the_same_sightings(reason: Reason) -> None:
    climbed = replace(progress(Phase.ABORT, CONFIG.abort.time_limit_s + 0.1), cause=Cause(reason))
    assert decided(climbed, situation(CONFIG.abort.height_m), LONG_HEARD) == (Event.CLEAR_TO_HOLD, Cause(reason))
