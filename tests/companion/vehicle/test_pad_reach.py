"""A pad's own size decides what is touched of it: smaller pads are kept to more narrowly, too small ones refused."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.landing.decisions.contact import Verdict, verdict
from companion.landing.decisions.contact_signs import signs_of
from companion.landing.decisions.events import is_over_pad
from companion.situation.phases import Phase
from companion.situation.situation import Situation
from companion.vehicle.pad_reach import (
    cone_radius_at_pad_m,
    cone_radius_m,
    is_too_small,
    is_unseen,
    over_pad_radius_m,
    pad_width_min_m,
    unseen_std_max_m,
)
from link.messages import Command
from link.records import replace
from tests.companion.facts import CONFIG, changed, pad_at, reference_at, situation
from tests.companion.world import PAD, Flight

SMALL_M = 0.7


def standing(beside_m: float, width_m: float) -> Situation:
    """A drone at rest on what is `beside_m` from the middle of a pad that is `width_m` wide."""
    facts = situation(0.0, beside_m, pad=replace(pad_at(), half_width_m=0.5 * width_m))
    return changed(facts, reference=reference_at(-0.5 * CONFIG.descent.sink.press_depth_m))


@given(half_width_m=st.floats(0.75, 10.0))
def test_benchmarks_pad_and_larger_ones_keep_the_configured_radii(half_width_m: float) -> None:
    assert cone_radius_at_pad_m(half_width_m, CONFIG) == 0.3
    assert over_pad_radius_m(half_width_m, CONFIG) == 0.6
    assert unseen_std_max_m(half_width_m, CONFIG) == 0.25


@given(half_width_m=st.floats(0.05, 0.74), height_m=st.floats(0.0, 5.0))
def test_all_that_is_taken_for_a_small_pad_lies_on_it(half_width_m: float, height_m: float) -> None:
    assert over_pad_radius_m(half_width_m, CONFIG) < half_width_m
    assert cone_radius_at_pad_m(half_width_m, CONFIG) < over_pad_radius_m(half_width_m, CONFIG)
    assert cone_radius_m(height_m, half_width_m, CONFIG) < cone_radius_m(height_m, 0.75, CONFIG)


@pytest.mark.parametrize(("width_m", "expected"), [(1.5, Verdict.CONTACT), (SMALL_M, Verdict.AIRBORNE)])
def test_what_is_beside_a_small_pad_is_no_contact_with_it(width_m: float, expected: Verdict) -> None:
    facts = standing(0.3, width_m)
    assert verdict(signs_of(facts, CONFIG.touchdown), CONFIG) is expected
    relative = facts.approach
    assert relative is not None
    assert is_over_pad(relative, CONFIG) is (expected is Verdict.CONTACT)


def test_middle_of_a_small_pad_is_a_contact() -> None:
    assert verdict(signs_of(standing(0.1, SMALL_M), CONFIG.touchdown), CONFIG) is Verdict.CONTACT


def test_small_pad_has_to_be_seen_more_exactly() -> None:
    pad = replace(pad_at(std_m=0.15), is_coarse=True)
    assert not is_unseen(pad, CONFIG)
    assert is_unseen(replace(pad, half_width_m=0.5 * SMALL_M), CONFIG)


@given(foot_radius_m=st.floats(0.0, 1.0))
def test_pad_has_room_for_the_feet_beside_two_deviations_of_both_places(foot_radius_m: float) -> None:
    """Of 0.04 m of the drone's, and 0.0476 m of a vehicle's with fixed phases: 0.1243 m on each side."""
    touchdown = CONFIG.touchdown.model_copy(update={"foot_radius_m": foot_radius_m})
    config = CONFIG.model_copy(update={"touchdown": touchdown})
    width_m = 2.0 * foot_radius_m + 0.2486
    assert pad_width_min_m(config) == pytest.approx(width_m, abs=2e-4)
    for more_m, expected in ((-1e-3, True), (1e-3, False)):
        assert is_too_small(replace(pad_at(), half_width_m=0.5 * (width_m + more_m)), config) is expected


def test_start_over_a_pad_that_is_too_small_is_refused_with_its_width() -> None:
    flight = Flight(pad=replace(PAD, size_m=(2.0, 0.4)))
    flight.run(0.1)
    reply = flight.step(Command.START).reply
    assert reply is not None
    assert not reply.accepted
    assert reply.reason == "pad is 0.40 m wide, 0.65 m are needed for feet 0.20 m about the axis: use a larger pad"
    assert flight.phase is Phase.IDLE
