"""How low a drone comes that follows a pad which is said to be below the road."""

import numpy as np
import pytest

from companion.config.companion import CompanionConfig
from companion.core.data import FlightLimits
from companion.landing.steering.following_height import chase_floor_m
from companion.landing.steering.seen_floor import keep_above_seen
from companion.landing.steering.targets import Aim, pad_aim
from companion.planning.guidance import ReferenceState
from companion.situation.phases import Phase
from companion.situation.situation import Situation
from link.records import replace
from tests.companion.facts import GEAR_M, changed, pad_at, situation

CONFIG = CompanionConfig()
LIMITS = FlightLimits(
    speed_max_m_s=12.0,
    acceleration_max_m_s2=5.0,
    jerk_max_m_s3=20.0,
    climb_max_m_s=2.0,
    descent_max_m_s=1.5,
    vertical_acceleration_max_m_s2=3.0,
    vertical_jerk_max_m_s3=20.0,
)
FEET_UP_M = 4.0
WAITS_M = CONFIG.takeoff.waiting_height_m


def _over_road(seen_m: float | None, feet_up_m: float = FEET_UP_M) -> tuple[Situation, ReferenceState]:
    """A drone with its feet `feet_up_m` above the road, 20 m from a pad that is said to be 30 m below it."""
    pad = pad_at((4.0, 1.0, -2.0))
    pad = replace(pad, position_enu_m=pad.position_enu_m + np.array([20.0, 0.0, -31.5]))
    facts = changed(situation(pad=pad), range_height_m=seen_m)
    assert facts.drone is not None
    place = np.array([0.0, 0.0, feet_up_m + GEAR_M])
    still = ReferenceState(position_enu_m=place, velocity_enu_m_s=np.zeros(3), acceleration_enu_m_s2=np.zeros(3))
    return replace(facts, drone=replace(facts.drone, position_enu_m=place)), still


def _aims(facts: Situation, reference: ReferenceState, phase: Phase) -> tuple[Aim, Aim]:
    """After the pad alone, and kept above what is seen."""
    assert facts.pad is not None
    aim = pad_aim(phase, facts.pad, reference, GEAR_M, CONFIG, limits=LIMITS)
    return aim, keep_above_seen(aim, phase, reference, facts, CONFIG)


@pytest.mark.parametrize("phase", [Phase.CHASE, Phase.ABORT])
@pytest.mark.parametrize("seen_m", [FEET_UP_M, 2.5])
def test_pad_below_the_road_leads_no_nearer_to_the_road_than_to_a_pad(phase: Phase, seen_m: float) -> None:
    after_pad, kept = _aims(*_over_road(seen_m), phase)
    lowest_m = FEET_UP_M - seen_m + chase_floor_m(CONFIG) + GEAR_M
    assert after_pad.target.position_enu_m[:, 2].max() < 0.0
    assert kept.target.position_enu_m[:, 2] == pytest.approx(lowest_m)
    assert kept.floor_enu_m == pytest.approx(lowest_m)
    assert not kept.target.velocity_enu_m_s[:, 2].any()
    assert np.array_equal(kept.target.position_enu_m[:, :2], after_pad.target.position_enu_m[:, :2])


def test_drone_that_is_too_near_the_road_climbs() -> None:
    _, kept = _aims(*_over_road(0.3, feet_up_m=0.3), Phase.ABORT)
    assert kept.target.position_enu_m[:, 2] == pytest.approx(chase_floor_m(CONFIG) + GEAR_M)


@pytest.mark.parametrize(("feet_up_m", "highest_m"), [(FEET_UP_M, WAITS_M), (9.0, 9.0)])
def test_what_hangs_before_the_range_finder_lifts_it_to_the_height_of_waiting_at_most(
    feet_up_m: float, highest_m: float
) -> None:
    _, kept = _aims(*_over_road(0.0, feet_up_m), Phase.CHASE)
    assert kept.target.position_enu_m[:, 2] == pytest.approx(min(feet_up_m + chase_floor_m(CONFIG), highest_m) + GEAR_M)


@pytest.mark.parametrize("phase", [Phase.ALIGN, Phase.DESCEND, Phase.TOUCHDOWN])
def test_over_the_pad_itself_it_comes_as_low_as_that_says(phase: Phase) -> None:
    facts, reference = _over_road(1.0)
    after_pad, kept = _aims(facts, reference, phase)
    assert kept is after_pad


@pytest.mark.parametrize("seen_m", [None, 100.0])
def test_without_anything_near_below_it_follows_the_pad(seen_m: float | None) -> None:
    after_pad, kept = _aims(*_over_road(seen_m), Phase.CHASE)
    assert kept is after_pad


def test_pad_that_is_where_it_is_seen_is_followed_as_before() -> None:
    facts = changed(situation(height_m=3.5), range_height_m=3.5)
    reference = facts.following.reference
    assert reference is not None
    after_pad, kept = _aims(facts, reference, Phase.CHASE)
    assert kept is after_pad
