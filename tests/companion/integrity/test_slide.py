"""Fixes that slide away from their velocities are found before they are a metre off; honest ones never slide."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from companion.autopilots.driver import Receiver
from companion.autopilots.frame_moves import NO_MOVES
from companion.config.companion import CompanionConfig
from companion.config.integrity import IntegrityConfig, ReceiverFrames
from companion.core.data import FIXED_STD_MAX_M, Measurement, Quantity
from companion.core.reasons import sentence
from companion.integrity.frames import FixedPhases, are_frames_one, tell_unseen, update_fixed_phases, with_slide
from companion.integrity.sightings import SightingWatch
from companion.integrity.slide import FixSlide, update_slide
from companion.landing.state.vehicle_update import update_vehicle
from companion.vehicle.velocity_lag import VelocityLag, dated_velocities, learn_lag
from companion.vehicle.velocity_point import VelocityPoint, learn_point
from link.records import replace
from tests.companion.facts import situation
from tests.companion.vehicle.drives import (
    EPOCH_NS,
    NOMINAL,
    Drive,
    Sensors,
    circle,
    drive,
    figure_eight,
    random_drive,
    stop_and_go,
    straight,
)
from tests.companion.vehicle.rides import arrivals, now_ns
from tests.companion.world import Flight

SLIDES_FROM_S = 8.0
DRIVES = {
    "straight": straight(8.0),
    "stands": drive(20.0, lambda _: 0.0, lambda _: 0.0),
    "circle": circle(5.0),
    "eight": figure_eight(),
    "stop and go": stop_and_go(),
    "random": random_drive(3),
}
WITH_WANDER = replace(NOMINAL, fix_bias_std_m=FIXED_STD_MAX_M - NOMINAL.fix_std_m)


def moved(sent: Sequence[Measurement], by_m_s: tuple[float, float], from_s: float = SLIDES_FROM_S) -> list[Measurement]:
    """The measurements with places that slide from then on."""

    def slid(one: Measurement) -> Measurement:
        if one.quantity is not Quantity.POSITION or one.t_ns < now_ns(from_s):
            return one
        for_s = (one.t_ns - now_ns(from_s)) * 1e-9
        return replace(one, value=one.value + for_s * np.array([*by_m_s, 0.0]))

    return [slid(one) for one in sent]


def found_s(sent: Sequence[Measurement]) -> float | None:
    """When the slide is found, with all that is learnt of the velocities; None if it never is."""
    lag, point, slide = VelocityLag(), VelocityPoint(), FixSlide()
    for one in sent:
        was_known = lag.is_known, point.is_known
        lag = learn_lag(lag, [one])
        dated = dated_velocities(lag, [one])
        point = learn_point(point, dated)
        is_new = was_known != (lag.is_known, point.is_known)
        slide = update_slide(FixSlide() if is_new else slide, dated, lag, point)
        if slide.has_slid:
            return (one.t_ns - EPOCH_NS) * 1e-9
    return None


def with_velocities(sent: Sequence[Measurement], truth: Drive, *, late_s: float, ahead_m: float) -> list[Measurement]:
    """The measurements with the velocities of some time ago, and of a point ahead of the antenna."""

    def changed(one: Measurement) -> Measurement:
        if one.quantity is not Quantity.VELOCITY:
            return one
        t_s = (one.t_ns - EPOCH_NS) * 1e-9
        _, velocity, yaw, yaw_rate = truth.at(max(t_s - late_s, 0.0))
        swing = yaw_rate * ahead_m * np.array([-math.sin(yaw), math.cos(yaw), 0.0])
        return replace(one, value=one.value + velocity - truth.at(t_s)[1] + swing)

    return [changed(one) for one in sent]


@pytest.mark.parametrize("name", DRIVES)
@pytest.mark.parametrize(("late_s", "ahead_m"), [(0.0, 0.0), (0.3, 0.0), (0.0, 2.0)])
@pytest.mark.parametrize("sensors", [NOMINAL, WITH_WANDER, replace(NOMINAL, rate_hz=5.0)])
def test_fixes_of_an_honest_receiver_never_slide(name: str, late_s: float, ahead_m: float, sensors: Sensors) -> None:
    truth = DRIVES[name]
    for seed in range(6):
        assert found_s(with_velocities(arrivals(truth, sensors, seed), truth, late_s=late_s, ahead_m=ahead_m)) is None


@pytest.mark.parametrize("by_m_s", [(0.1, 0.0), (-0.2, 0.0), (0.0, 0.2), (0.3, -0.3)])
def test_slide_is_found_within_two_seconds_or_before_the_pad_is_two_thirds_of_a_metre_off(
    by_m_s: tuple[float, float],
) -> None:
    for truth, from_s in ((DRIVES["straight"], 8.0), (DRIVES["stands"], 8.0), (circle(5.0, length_s=40.0), 30.0)):
        for seed in range(3):
            at_s = found_s(moved(arrivals(truth, NOMINAL, seed), by_m_s, from_s))
            assert at_s is not None
            assert from_s < at_s
            assert at_s - from_s < 2.1 or (at_s - from_s) * math.hypot(*by_m_s) < 0.67


def test_changes_of_speed_and_place_hide_a_slide_no_longer_than_they_last() -> None:
    for name in ("stop and go", "random", "eight"):
        assert found_s(moved(arrivals(DRIVES[name], NOMINAL, 1), (0.3, 0.0), from_s=4.0)) is not None


def test_one_place_that_is_off_is_no_slide() -> None:
    for off_at in range(80, 110, 3):
        sent = arrivals(DRIVES["straight"], NOMINAL, 2)
        fixes = [k for k, one in enumerate(sent) if one.quantity is Quantity.POSITION]
        bad = sent[fixes[off_at]]
        sent[fixes[off_at]] = replace(bad, value=bad.value + 5.0)
        assert found_s(sent) is None


def test_places_of_phases_that_are_not_fixed_tell_nothing() -> None:
    floats = replace(NOMINAL, fix_std_m=2.0 * FIXED_STD_MAX_M)
    assert found_s(moved(arrivals(DRIVES["straight"], floats, 1), (0.5, 0.0))) is None


def test_seconds_before_a_gap_are_compared_with_none_after_it() -> None:
    sent = arrivals(DRIVES["straight"], NOMINAL, 1)
    gap_ns = now_ns(SLIDES_FROM_S), now_ns(SLIDES_FROM_S + 3.0)
    stepped = [
        replace(one, value=one.value + 2.0) if one.quantity is Quantity.POSITION and one.t_ns >= gap_ns[1] else one
        for one in sent
        if not gap_ns[0] <= one.t_ns < gap_ns[1]
    ]
    assert found_s(stepped) is None


def test_vehicle_that_slides_has_a_frame_again_once_its_phases_are_fixed_anew() -> None:
    fixed = FixedPhases(vehicle_std_m=0.02, since_ns=0)
    slid = with_slide(fixed)
    assert are_frames_one(fixed, ReceiverFrames.AUTO, now_ns(1.0))
    assert not are_frames_one(slid, ReceiverFrames.AUTO, now_ns(1.0))
    assert not are_frames_one(slid, ReceiverFrames.ONE, now_ns(1.0))
    drone = Receiver(is_fixed=True, has_fix=True)
    for std_m, t_s in ((0.02, 2.0), (0.3, 3.0), (0.02, 4.0)):
        fix = Measurement(
            t_ns=now_ns(t_s), quantity=Quantity.POSITION, value=np.zeros(3), covariance=std_m**2 * np.eye(3)
        )
        slid = update_fixed_phases(slid, [fix], now_ns(t_s), drone=drone, moves=NO_MOVES)
        assert slid.has_stepped is (t_s < 3.0)


def test_slide_takes_what_sightings_have_told_until_others_agree() -> None:
    flight = Flight()
    confirmed = SightingWatch(agreeing=40, since_ns=0, is_confirmed=True, was_confirmed=True)
    vehicle = replace(flight.memory.vehicle, slide=FixSlide(has_slid=True), sightings=confirmed)
    slid = update_vehicle(vehicle, flight.inputs(), flight.system)
    assert not slid.sightings.is_confirmed
    again = replace(slid, sightings=confirmed)
    assert update_vehicle(again, flight.inputs(), flight.system).sightings.is_confirmed


@pytest.mark.parametrize("configured", [ReceiverFrames.AUTO, ReceiverFrames.ONE])
def test_pilot_is_told_that_a_receiver_has_stepped_or_slid(configured: ReceiverFrames) -> None:
    config = CompanionConfig(integrity=IntegrityConfig(receiver_frames=configured))
    quiet = situation()
    slid = replace(quiet, vehicle=replace(quiet.vehicle, has_receiver_stepped=True))
    assert "than its velocities say" in sentence(tell_unseen(slid, config))
    assert "than its velocities say" not in sentence(tell_unseen(quiet, config))
