"""A vehicle that tells nothing is flown over so high that it is seen; out of sight the chase goes on for a while."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.companion import CompanionConfig, SilentVehicleConfig
from companion.core.reasons import Cause, Reason
from companion.landing.commands import missing_for_sortie
from companion.landing.decisions.entries import Decision, update_held
from companion.landing.decisions.events import decide
from companion.landing.decisions.feasibility import OBSTACLES, obstacle
from companion.landing.state.memory import ControlMemory, Held
from companion.landing.steering.following_height import chase_height_m
from companion.situation.phases import Event, Phase
from companion.situation.situation import VehicleNews
from link.records import replace
from tests.companion.facts import CONFIG, TICK_NS, changed, later, pad_at, progress, reference_at, situation

SILENT = CONFIG.model_copy(update={"silent_vehicle": SilentVehicleConfig()})
HIGHEST_M = CONFIG.chase.unseen_height_max_m


def decision_within(
    phase: Phase, std_m: float, limit_s: float, config: CompanionConfig, *, away_m: float = 0.0
) -> Decision | None:
    """The first decision over, or beside, a pad that was seen 2 s ago, or told of, and is not seen again."""
    facts = situation(HIGHEST_M, away_m, pad=replace(pad_at(std_m=std_m), is_coarse=True))
    facts = changed(facts, vehicle=VehicleNews(fix_age_s=2.0, is_alive=None))
    held: Held = {}
    for tick in range(round(limit_s * 1e9 / TICK_NS) + 1):
        now = later(facts, tick * TICK_NS)
        held = update_held(held, phase, now, config)
        decision = decide(replace(progress(phase, 0.0), held=held), ControlMemory(), now, config)
        if decision is not None:
            return decision
    return None


def test_a_chase_goes_on_out_of_sight_where_one_by_telemetry_breaks_off() -> None:
    assert decision_within(Phase.CHASE, 1.0, 5.0, SILENT) is None
    told = decision_within(Phase.CHASE, 1.0, 5.0, CONFIG)
    assert told == (Event.UNSAFE, Cause(Reason.VEHICLE_DATA_OLD))


def test_a_chase_that_looks_for_too_long_says_that_the_pad_is_not_seen() -> None:
    decision = decision_within(Phase.CHASE, 3.0, CONFIG.chase.unseen_hold_s + 1.0, SILENT)
    assert decision == (Event.UNSAFE, Cause(Reason.PAD_NOT_SEEN))


def test_a_vehicle_out_of_sight_that_is_believed_far_away_is_not_chased_for_longer() -> None:
    for std_m in (0.1, 30.0):
        decision = decision_within(Phase.CHASE, std_m, CONFIG.chase.unseen_hold_s + 1.0, SILENT, away_m=50.0)
        assert decision == (Event.UNSAFE, Cause(Reason.PAD_NOT_SEEN))


@pytest.mark.parametrize("phase", [Phase.ALIGN, Phase.DESCEND])
def test_near_the_pad_it_has_to_be_seen(phase: Phase) -> None:
    decision = decision_within(phase, 1.0, 5.0, SILENT)
    assert decision is not None
    assert decision[0] is Event.OUT_OF_ALIGNMENT


@given(away_m=st.floats(0.0, 30.0), std_m=st.floats(0.01, 10.0))
def test_height_keeps_the_pad_in_a_view_of_45_degrees_as_far_as_a_detector_sees(away_m: float, std_m: float) -> None:
    pad = replace(pad_at(std_m=std_m), is_coarse=True)
    at = reference_at(HIGHEST_M)
    at = replace(at, position_enu_m=at.position_enu_m + np.array([away_m, 0.0, 0.0]))
    height_m = chase_height_m(pad, at, SILENT)
    assert CONFIG.descent.alignment.height_m <= height_m <= HIGHEST_M
    assert height_m > min(away_m + 2.0 * std_m, HIGHEST_M) - 1e-9


@pytest.mark.parametrize(
    ("is_unplaced", "reason"), [(False, Reason.PAD_NOT_SEEN), (True, Reason.SIGHTINGS_UNPLACED)], ids=["unseen", "late"]
)
def test_a_climb_without_a_sighting_ends_with_what_to_see_to_and_not_with_data_that_nobody_sends(
    is_unplaced: bool, reason: Reason
) -> None:
    facts = changed(situation(CONFIG.abort.height_m), fix_age_s=CONFIG.abort.fix_age_max_s + 0.1)
    facts = changed(facts, has_unplaced_sightings=is_unplaced)
    climb = progress(Phase.ABORT, CONFIG.abort.time_limit_s + 0.1)
    assert decide(climb, ControlMemory(), facts, SILENT) == (Event.CLEAR_TO_HOLD, Cause(reason))
    assert missing_for_sortie(Event.RETURN, None, facts, SILENT, None) == Cause(reason)
    told = decide(climb, ControlMemory(), facts, CONFIG)
    assert told == (Event.CLEAR_TO_HOLD, Cause(Reason.NO_VEHICLE_DATA))


@pytest.mark.parametrize("reason", [Reason.SIGHTINGS_IMPOSSIBLE, Reason.SIGHTINGS_DISAGREE, Reason.PAD_NOT_SEEN])
def test_climb_from_wrong_sightings_ends_with_what_they_were_wrong_by_though_the_pad_is_out_of_sight(
    reason: Reason,
) -> None:
    facts = changed(situation(CONFIG.abort.height_m), fix_age_s=CONFIG.abort.fix_age_max_s + 0.1)
    climb = replace(progress(Phase.ABORT, CONFIG.abort.time_limit_s + 0.1), cause=Cause(reason))
    assert decide(climb, ControlMemory(), facts, SILENT) == (Event.CLEAR_TO_HOLD, Cause(reason))


@pytest.mark.parametrize(("is_silent", "told"), [(True, Cause(Reason.SIGHTINGS_UNPLACED)), (False, None)])
def test_drone_that_waits_for_a_vehicle_whose_sightings_are_stamped_wrong_says_so(
    told: Cause | None, *, is_silent: bool
) -> None:
    facts, config = changed(situation(), has_unplaced_sightings=True), SILENT if is_silent else CONFIG
    held = {one.reason: 0 for one in OBSTACLES if Phase.WAITING in one.phases and one.is_true(facts, config)}
    assert obstacle(held, facts, config) == told


@pytest.mark.parametrize(
    ("config", "is_sighted", "reason"),
    [
        (CONFIG, False, Reason.VEHICLE_UNCERTAIN),
        (SILENT, False, Reason.PAD_NOT_SEEN),
        (SILENT, True, Reason.SIGHTINGS_VAGUE),
    ],
)
def test_place_that_nobody_tells_is_uncertain_because_it_is_not_seen(
    config: CompanionConfig, reason: Reason, *, is_sighted: bool
) -> None:
    facts = changed(situation(pad=pad_at(std_m=CONFIG.abort.position_std_max_m + 0.1)), is_pad_sighted=is_sighted)
    held = update_held({}, Phase.ALIGN, facts, config)
    now = later(facts, round(config.abort.cone_hold_s * 1e9))
    held = update_held(held, Phase.ALIGN, now, config)
    decision = decide(replace(progress(Phase.ALIGN, 0.0), held=held), ControlMemory(), now, config)
    assert decision == (Event.UNSAFE, Cause(reason))
