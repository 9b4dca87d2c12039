"""Between a vehicle and a drone without corrections lie metres: the pad is landed on only where it was just seen.

Between receivers of two sources of corrections lie metres, too, however little each of them errs: one sighting tells.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.companion import CompanionConfig
from companion.config.estimation import EstimatorKind
from companion.core.data import Quantity
from companion.core.reasons import Reason
from companion.landing.decisions.entries import Decision, update_held
from companion.landing.state.memory import Held
from companion.landing.steering.targets import pad_aim
from companion.situation.phases import Event, Phase
from companion.situation.situation import Situation
from companion.vehicle.pad import PadPath, pad_path
from companion.vehicle.pad_reach import is_unseen
from link.records import replace
from scenarios.config import PatternConfig
from tests.companion.facts import GEAR_M, LONG_HEARD, TICK_NS, decided, later, pad_at, progress, reference_at, situation
from tests.companion.vehicle.drives import DEGRADED, NOMINAL, Sensors, circle
from tests.companion.vehicle.rides import arrivals, estimator, now_ns

CONFIG = CompanionConfig()
LIMITS = CONFIG.limits.flight_limits()
HIGH_M = CONFIG.descent.alignment.height_m
LOW_M = 0.5 * CONFIG.descent.commit_height_m
VAGUE_M = CONFIG.descent.unseen.std_max_m + 0.01
SURE_M = CONFIG.descent.unseen.std_max_m - 0.01
PLAIN = replace(DEGRADED, pad_rate_hz=10.0, pad_delay_s=0.15, frame_offset_m=1.2)
RTK = replace(NOMINAL, pad_rate_hz=30.0, frame_offset_m=0.5)


def above(height_m: float, std_m: float, *, is_coarse: bool) -> Situation:
    return situation(height_m, pad=replace(pad_at(std_m=std_m), is_coarse=is_coarse))


def between_two_frames(height_m: float, std_m: float) -> Situation:
    return situation(height_m, pad=replace(pad_at(std_m=std_m), has_one_frame=False))


def decision_within(phase: Phase, facts: Situation, limit_s: float) -> Decision | None:
    """The first decision on facts that stay as they are."""
    held: Held = {}
    for tick in range(round(limit_s * 1e9 / TICK_NS) + 1):
        now = later(facts, tick * TICK_NS)
        held = update_held(held, phase, now, CONFIG)
        decision = decided(progress(phase, 0.0), now, held)
        if decision is not None:
            return decision
    return None


def event_within(phase: Phase, facts: Situation, limit_s: float) -> Event | None:
    """The first event on facts that stay as they are."""
    decision = decision_within(phase, facts, limit_s)
    return None if decision is None else decision[0]


@pytest.mark.parametrize(("std_m", "event"), [(SURE_M, Event.ALIGNED), (1.0, Event.OUT_OF_ALIGNMENT)])
def test_pad_between_two_frames_is_landed_on_once_it_was_seen(std_m: float, event: Event) -> None:
    assert event_within(Phase.ALIGN, between_two_frames(HIGH_M, std_m), 5.0) is event
    assert event_within(Phase.CHASE, between_two_frames(HIGH_M, std_m), 5.0) is (
        Event.OVER_PAD if event is Event.ALIGNED else None
    )


@pytest.mark.parametrize("is_coarse", [False, True])
def test_approach_to_a_pad_that_nothing_shows_ends_and_says_what_is_missing(*, is_coarse: bool) -> None:
    facts = situation(HIGH_M, pad=replace(pad_at(std_m=1.0), has_one_frame=False, is_coarse=is_coarse))
    hold_s = CONFIG.chase.unseen_hold_s
    assert decision_within(Phase.CHASE, facts, hold_s - 0.1) is None
    decision = decision_within(Phase.CHASE, facts, hold_s + 0.1)
    assert decision is not None
    assert (decision[0], decision[1].reason) == (Event.UNSAFE, Reason.OFFSET_UNKNOWN)
    climbed = replace(progress(Phase.ABORT, CONFIG.abort.time_limit_s + 0.1), cause=decision[1])
    after = decided(climbed, situation(CONFIG.abort.height_m), LONG_HEARD)
    assert after == (Event.CLEAR_TO_HOLD, decision[1])


def test_pad_is_looked_for_where_it_is_said_to_be() -> None:
    far = situation(HIGH_M, CONFIG.chase.height_m + 0.1, pad=between_two_frames(HIGH_M, 1.0).pad)
    assert decision_within(Phase.CHASE, far, CONFIG.chase.unseen_hold_s + 1.0) is None


@pytest.mark.parametrize(
    ("std_m", "is_coarse", "event"),
    [(SURE_M, True, Event.ALIGNED), (VAGUE_M, True, Event.OUT_OF_ALIGNMENT), (1.0, False, Event.ALIGNED)],
    ids=["coarse, just seen", "coarse, long unseen", "rtk, never seen"],
)
def test_descent_begins_over_a_pad_that_fixes_or_a_fresh_sighting_place(
    std_m: float, event: Event, *, is_coarse: bool
) -> None:
    assert event_within(Phase.ALIGN, above(HIGH_M, std_m, is_coarse=is_coarse), 5.0) is event


@pytest.mark.parametrize(
    ("height_m", "std_m", "is_coarse", "event"),
    [
        (HIGH_M, SURE_M, True, None),
        (HIGH_M, VAGUE_M, True, Event.OUT_OF_ALIGNMENT),
        (HIGH_M, 1.0, False, None),
        (LOW_M, VAGUE_M, True, None),
    ],
    ids=["just seen", "long unseen", "rtk", "committed"],
)
def test_descent_goes_below_the_commit_height_only_where_the_pad_was_just_seen(
    height_m: float, std_m: float, event: Event | None, *, is_coarse: bool
) -> None:
    assert event_within(Phase.DESCEND, above(height_m, std_m, is_coarse=is_coarse), 5.0) is event


@pytest.mark.parametrize(("std_m", "aligns"), [(SURE_M, True), (VAGUE_M, False)])
def test_chase_stays_high_until_it_sees_the_pad(std_m: float, *, aligns: bool) -> None:
    facts = above(CONFIG.chase.height_m, std_m, is_coarse=True)
    assert facts.pad is not None
    event = event_within(Phase.CHASE, facts, 5.0)
    height_m = pad_aim(
        Phase.CHASE, facts.pad, reference_at(HIGH_M), GEAR_M, CONFIG, limits=CONFIG.limits.flight_limits()
    ).target.position_enu_m[0, 2]
    over_pad_m = height_m - facts.pad.position_enu_m[0, 2] - GEAR_M
    assert event is (Event.OVER_PAD if aligns else None)
    unsure_m = CONFIG.chase.unseen_height_stds * std_m
    assert over_pad_m == pytest.approx(HIGH_M if aligns else CONFIG.chase.height_m + unsure_m)


@pytest.mark.parametrize("phase", [Phase.CHASE, Phase.ABORT])
def test_drone_stays_higher_by_what_the_height_of_an_unseen_pad_is_unsure(phase: Phase) -> None:
    low, high = (wanted_over_unseen_m(phase, std_m) for std_m in (0.0, 1.1))
    assert high - low == pytest.approx(CONFIG.chase.unseen_height_stds * 1.1)


def wanted_over_unseen_m(phase: Phase, height_std_m: float, config: CompanionConfig = CONFIG) -> float:
    """How high above an unseen pad the drone is to fly whose height is known so well."""
    std_m = np.tile([VAGUE_M, VAGUE_M, height_std_m], (len(pad_at().offset_s), 1))
    pad = replace(pad_at(), is_coarse=True, position_std_m=std_m)
    wanted_m = pad_aim(
        phase, pad, reference_at(HIGH_M), GEAR_M, config, limits=CONFIG.limits.flight_limits()
    ).target.position_enu_m[0, 2]
    return float(wanted_m - pad.position_enu_m[0, 2]) - GEAR_M


@pytest.mark.parametrize("phase", [Phase.CHASE, Phase.ABORT])
@given(height_std_m=st.floats(0.0, 100.0))
def test_drone_stays_where_its_detector_sees_the_pad_however_vague_that_is(phase: Phase, height_std_m: float) -> None:
    base_m = {Phase.CHASE: CONFIG.chase.height_m, Phase.ABORT: CONFIG.abort.height_m}[phase]
    assert base_m - 1e-9 <= wanted_over_unseen_m(phase, height_std_m) <= CONFIG.chase.unseen_height_max_m + 1e-9


def test_abort_that_is_to_climb_higher_than_a_detector_sees_climbs_as_high_as_it_is_told() -> None:
    config = CONFIG.model_copy(update={"abort": CONFIG.abort.model_copy(update={"height_m": 15.0})})
    assert wanted_over_unseen_m(Phase.ABORT, 3.0, config) == pytest.approx(15.0)


def test_scenarios_detector_sees_farther_than_the_drone_stays_above_an_unseen_pad() -> None:
    assert PatternConfig.model_fields["range_max_m"].default > CONFIG.chase.unseen_height_max_m


def pad_after(sensors: Sensors, unseen_s: float) -> PadPath:
    """The pad `unseen_s` after its last sighting, the vehicle's data going on."""
    chosen, until_s = estimator(EstimatorKind.IMM), 10.0 + unseen_s
    memory = chosen.fuse(None, [])
    for measurement in arrivals(circle(), sensors, 5):
        is_seen = measurement.quantity is not Quantity.PAD or measurement.t_ns < now_ns(10.0)
        if is_seen and measurement.t_ns < now_ns(until_s):
            memory = chosen.fuse(memory, [measurement])
    forecast = chosen.forecast(memory, now_ns(until_s), np.arange(0.0, 1.0, 0.2))
    assert forecast is not None
    return pad_path(forecast, None)


@pytest.mark.parametrize(
    ("sensors", "unseen_s", "unseen"),
    [(PLAIN, 0.3, False), (PLAIN, 1.0, False), (PLAIN, 6.0, True), (RTK, 6.0, False)],
    ids=["just seen", "seen a second ago", "seen long ago", "rtk"],
)
def test_sighting_holds_for_seconds_between_coarse_fixes(sensors: Sensors, unseen_s: float, *, unseen: bool) -> None:
    assert is_unseen(pad_after(sensors, unseen_s), CONFIG) is unseen


def test_pad_that_no_sighting_has_placed_is_unseen_between_coarse_fixes() -> None:
    assert is_unseen(pad_after(replace(PLAIN, pad_rate_hz=0.0), 1.0), CONFIG)
    assert not is_unseen(pad_after(replace(RTK, pad_rate_hz=0.0), 1.0), CONFIG)


@pytest.mark.parametrize(("pad_rate_hz", "unseen"), [(0.0, True), (30.0, False)])
def test_sighting_tells_the_offset_of_two_fine_receivers_for_good(pad_rate_hz: float, *, unseen: bool) -> None:
    pad = pad_after(replace(RTK, pad_rate_hz=pad_rate_hz), 6.0)
    assert is_unseen(replace(pad, has_one_frame=False), CONFIG) is unseen
