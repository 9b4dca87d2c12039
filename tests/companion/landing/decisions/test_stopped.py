"""A drone that the pad stops: a contact, not an abort."""

import math

import numpy as np
import pytest

from companion.core.reasons import Cause, Reason
from companion.landing.decisions.entries import update_held
from companion.landing.state.memory import Held
from companion.situation.phases import Event, Phase
from companion.vehicle.pad_reach import cone_radius_m
from link.records import replace
from tests.companion.facts import (
    CONFIG,
    TICK_NS,
    changed,
    decided,
    drone_at,
    first_decision,
    later,
    pad_at,
    progress,
    reference_at,
    situation,
)
from tests.companion.landing.decisions.unsafe_facts import HALF_M, LOW_M, OVER_PAD_M, jolted


def test_drone_beside_the_pad_below_the_commit_height_aborts_and_is_not_taken_for_landed() -> None:
    beside = situation(0.0, OVER_PAD_M + 0.05)
    beside = changed(beside, autopilot=replace(beside.autopilot, landed=True), reference=reference_at(-0.4))
    decision, _ = first_decision(Phase.DESCEND, beside, 3.0)
    assert decision == (Event.UNSAFE, Cause(Reason.OUTSIDE_CONE))


def test_drone_that_is_stopped_while_the_pad_drives_on_has_landed_and_does_not_climb_away() -> None:
    stopped = changed(
        situation(0.0),
        drone=drone_at(0.0, 0.3, (-4.0, -1.0, 0.0), pad=pad_at((4.0, 1.0, 0.0))),
        reference=reference_at(-CONFIG.touchdown.blocked_depth_m - 0.01),
    )
    decision, ticks = first_decision(Phase.DESCEND, jolted(stopped), 1.0)
    assert decision is not None
    assert (decision[0], ticks) == (Event.CONTACT, 0)
    unexplained, _ = first_decision(Phase.DESCEND, stopped, CONFIG.abort.near_speed_hold_s + 0.02)
    assert unexplained == (Event.UNSAFE, Cause(Reason.TOO_FAST_NEAR_PAD))


def test_jolt_with_the_pad_in_the_range_finders_sight_needs_no_sunken_setpoint() -> None:
    stopped = jolted(changed(situation(0.0), reference=reference_at(0.05), range_height_m=0.03))
    decision, _ = first_decision(Phase.DESCEND, stopped, 0.0)
    assert decision is not None
    assert decision[0] is Event.CONTACT
    far = changed(stopped, range_height_m=CONFIG.touchdown.range_finder.contact_height_max_m + 0.01)
    assert first_decision(Phase.DESCEND, far, 0.0)[0] is None


@pytest.mark.parametrize(("seen_last_m", "wanted"), [(0.0, Event.CONTACT), (0.15, Event.CONTACT), (0.16, Event.UNSAFE)])
def test_drone_that_is_stopped_after_its_range_finder_fell_blind_has_landed_where_it_was_sinking_to(
    seen_last_m: float, wanted: Event
) -> None:
    pad = pad_at((4.0, 1.0, 0.0))
    stopped = changed(
        situation(-0.3),
        drone=drone_at(-0.3, 0.2, (-4.0, -1.0, -0.25), pad=pad),
        pad=pad,
        reference=reference_at(-0.2),  # it follows its setpoint: no other sign speaks for a contact
        range_carried_m=seen_last_m,
    )
    decision, _ = first_decision(Phase.DESCEND, jolted(stopped), 1.0)
    assert decision is not None
    assert decision[0] is wanted
    in_sight = changed(stopped, range_height_m=2.0)
    assert first_decision(Phase.DESCEND, jolted(in_sight), 1.0)[0] == (Event.UNSAFE, Cause(Reason.TOO_FAST_NEAR_PAD))


@pytest.mark.parametrize(("driven_s", "wanted"), [(0.0, Event.CONTACT), (0.055, Event.CONTACT), (0.16, Event.UNSAFE)])
def test_what_has_stopped_the_drone_was_the_pad_where_it_was_before_it_drove_on(driven_s: float, wanted: Event) -> None:
    pad = pad_at((8.0, 0.0, 0.0))
    before = drone_at(0.02, 0.0, (-8.0, 0.0, 0.0), pad=pad)
    # Beside the pad's centre at the contact; the pad drives on eastwards, and the drone falls behind.
    place = before.position_enu_m + np.array([-0.3 - 8.0 * driven_s, 0.45, 0.0])
    stopped = changed(
        situation(0.02),
        drone=replace(before, position_enu_m=place, age_s=0.0),
        pad=pad,
        reference=reference_at(0.0),
        range_height_m=0.02,
    )
    decision, _ = first_decision(Phase.DESCEND, jolted(stopped), 1.0)
    assert decision is not None
    assert decision[0] is wanted


def test_drone_that_the_pad_stops_beside_the_cone_has_landed_though_the_stop_ends_its_commitment() -> None:
    beside_m = cone_radius_m(0.05, HALF_M, CONFIG) + 0.1
    assert beside_m < OVER_PAD_M
    pad = pad_at((4.0, 1.0, 0.0))
    sinking = changed(
        situation(0.05),
        drone=drone_at(0.05, beside_m, (0.0, 0.0, -0.4), pad=pad),
        pad=pad,
        reference=reference_at(0.0),
        range_height_m=0.05,
    )
    stopped = jolted(replace(sinking, drone=drone_at(0.05, beside_m, (-4.0, -1.0, -0.3), pad=pad)))
    held: Held = {}
    ticks = 2 * math.ceil(CONFIG.abort.cone_hold_s * 1e9 / TICK_NS)
    for tick in range(ticks):
        now = later(sinking, tick * TICK_NS)
        held = update_held(held, Phase.DESCEND, now, CONFIG)
        assert decided(progress(Phase.DESCEND, 0.0), now, held) is None
    now = later(stopped, ticks * TICK_NS)
    held = update_held(held, Phase.DESCEND, now, CONFIG)
    decision = decided(progress(Phase.DESCEND, 0.0), now, held)
    assert decision is not None
    assert decision[0] is Event.CONTACT


@pytest.mark.parametrize(
    ("beside_m", "speed_m_s", "stays"),
    [(0.1, CONFIG.abort.near_speed_max_m_s + 0.1, True), (0.55, 0.1, True), (0.1, 4.0, False)],
    ids=["slides to rest on the pad", "stands beside the cone", "slides off"],
)
def test_drone_that_stands_on_the_pad_does_not_lift_off_for_where_it_stands(
    beside_m: float, speed_m_s: float, *, stays: bool
) -> None:
    standing = changed(
        situation(0.0),
        drone=drone_at(0.0, beside_m, (0.0, speed_m_s, 0.0), pad=pad_at()),
        reference=reference_at(-CONFIG.touchdown.blocked_depth_m - 0.01),
    )
    decision, _ = first_decision(Phase.DESCEND, standing, 1.0)
    assert decision is not None
    assert decision[0] is (Event.CONTACT if stays else Event.UNSAFE)


def test_jolt_in_the_air_is_no_contact() -> None:
    sinking = replace(situation(LOW_M), drone=drone_at(LOW_M, 0.1, (0.0, 0.0, -0.4), pad=pad_at()))
    decision, _ = first_decision(Phase.DESCEND, jolted(changed(sinking, reference=reference_at(LOW_M))), 1.0)
    assert decision is None
