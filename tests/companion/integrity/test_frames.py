"""Two receivers have one frame while both say that their phases are fixed, or where somebody knows it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.autopilots.driver import Receiver
from companion.autopilots.frame_moves import NO_MOVES, FrameMoves
from companion.config.companion import CompanionConfig
from companion.config.integrity import IntegrityConfig, ReceiverFrames
from companion.core.data import FIXED_STD_MAX_M, Measurement, Quantity
from companion.core.reasons import Cause, Reason, sentence
from companion.integrity.frames import (
    FixedPhases,
    are_frames_one,
    has_lost_fix,
    tell_unseen,
    update_fixed_phases,
    with_place_step,
    without_place_step,
)
from companion.integrity.sightings import SightingWatch
from companion.integrity.way import WayError
from companion.landing.state.vehicle_update import predict_pad, update_vehicle
from companion.situation.phases import Phase
from link.messages import Vector3
from link.records import replace
from tests.companion.facts import changed, situation
from tests.companion.world import CONFIG, Flight, reached

STEP_NS = 100_000_000
HOLD_STEPS = 20
AUTO = ReceiverFrames.AUTO


def fix(std_m: float, t_ns: int = 0, quantity: Quantity = Quantity.POSITION) -> Measurement:
    covariance = np.diag([0.5 * std_m, std_m, 10.0 * std_m]) ** 2
    return Measurement(t_ns=t_ns, quantity=quantity, value=np.zeros(3), covariance=covariance)


def update(
    before: FixedPhases,
    measurements: list[Measurement],
    monotonic_ns: int,
    *,
    drone_is_fixed: bool = True,
    has_fix: bool | None = True,
    moves: FrameMoves = NO_MOVES,
) -> FixedPhases:
    drone = Receiver(is_fixed=drone_is_fixed, has_fix=has_fix)
    return update_fixed_phases(before, measurements, monotonic_ns, drone=drone, moves=moves)


def after(steps: list[tuple[float, bool]]) -> FixedPhases:
    """What is known after a fix of such a deviation, and such a state of the drone's receiver, in each step."""
    phases = FixedPhases()
    for step, (std_m, drone_is_fixed) in enumerate(steps):
        phases = update(phases, [fix(std_m)], step * STEP_NS, drone_is_fixed=drone_is_fixed)
    return phases


@given(steps=st.lists(st.tuples(st.sampled_from([0.01, 0.3]), st.booleans()), min_size=1, max_size=80))
def test_frames_are_one_while_both_have_had_fixed_phases_for_the_hold_time(steps: list[tuple[float, bool]]) -> None:
    newest = steps[-HOLD_STEPS - 1 :]
    held = len(newest) > HOLD_STEPS and all(std_m == 0.01 and drone_is_fixed for std_m, drone_is_fixed in newest)
    assert are_frames_one(after(steps), AUTO, (len(steps) - 1) * STEP_NS) is held


@pytest.mark.parametrize(("steps", "is_one"), [(HOLD_STEPS, False), (HOLD_STEPS + 1, True)])
def test_frames_are_one_from_the_hold_time_on(steps: int, *, is_one: bool) -> None:
    assert are_frames_one(after([(0.01, True)] * steps), AUTO, (steps - 1) * STEP_NS) is is_one


@pytest.mark.parametrize(("std_m", "is_one"), [(FIXED_STD_MAX_M - 1e-4, True), (FIXED_STD_MAX_M + 1e-4, False)])
def test_phases_of_a_vehicle_that_states_more_than_a_quarter_of_a_wavelength_are_not_fixed(
    std_m: float, *, is_one: bool
) -> None:
    assert are_frames_one(after([(std_m, True)] * 30), AUTO, 29 * STEP_NS) is is_one
    assert pytest.approx(0.19 / 4.0, abs=1e-3) == FIXED_STD_MAX_M


def test_a_step_without_fixes_and_other_measurements_change_nothing() -> None:
    phases = after([(0.01, True)] * 30)
    for measurements in ([], [fix(5.0, quantity=Quantity.PAD)]):
        assert update(phases, measurements, 10**10) == phases


FIXED, LATER_NS = [(0.01, True)] * 30, 100 * STEP_NS


@pytest.mark.parametrize("configured", [AUTO, ReceiverFrames.ONE])
@pytest.mark.parametrize(("moved_m", "is_one"), [(0.08, True), (0.12, False), (5.0, False)])
def test_vehicle_that_steps_by_more_than_two_fixed_phases_err_has_no_frame_any_more(
    configured: ReceiverFrames, moved_m: float, *, is_one: bool
) -> None:
    stepped = with_place_step(after(FIXED), (1, moved_m))
    assert are_frames_one(stepped, configured, LATER_NS) is is_one
    going_on = update(with_place_step(stepped, (1, moved_m)), [fix(0.01)], LATER_NS)
    assert are_frames_one(going_on, configured, 2 * LATER_NS) is is_one


def test_receiver_that_has_fixed_its_phases_anew_has_a_frame_again() -> None:
    phases = with_place_step(after(FIXED), (1, 5.0))
    for step, std_m in enumerate([0.3, *[0.01] * 30]):
        phases = update(phases, [fix(std_m)], LATER_NS + step * STEP_NS)
    assert are_frames_one(phases, AUTO, LATER_NS + 30 * STEP_NS)


def on_way(ahead_s: float) -> WayError:
    return WayError(ahead_s=ahead_s, across_m=0.02, speed_m_s=9.0)


def test_vehicle_whose_stamps_step_has_no_frame_until_they_have_gone_back() -> None:
    phases = with_place_step(after(FIXED), (1, 0.7), on_way(-0.078))
    assert not are_frames_one(phases, AUTO, LATER_NS)
    farther = with_place_step(phases, (2, 0.7), on_way(-0.076))
    assert not are_frames_one(farther, AUTO, LATER_NS)
    back = with_place_step(phases, (1, 0.7), on_way(0.071))  # so soon that the filter was open still
    assert are_frames_one(back, AUTO, LATER_NS)
    assert not are_frames_one(with_place_step(back, (2, 0.7), on_way(0.071)), AUTO, LATER_NS)


@pytest.mark.parametrize("of_stamps", [None, on_way(-0.078)])
def test_step_of_an_estimate_that_was_led_astray_takes_no_frame_for_good(of_stamps: WayError | None) -> None:
    phases = without_place_step(with_place_step(after(FIXED), (1, 0.7), of_stamps))
    assert are_frames_one(phases, AUTO, LATER_NS)
    assert not are_frames_one(with_place_step(phases, (2, 0.7), of_stamps), AUTO, LATER_NS)


def test_inertial_unit_that_is_found_to_be_wrong_takes_no_frame_for_good() -> None:
    flight = reached(Phase.CHASE)
    flight.sends_fixes = False
    led_astray = replace(flight.memory.vehicle, phases=with_place_step(after(FIXED), (1, 0.7)))
    inputs = flight.inputs()
    found = replace(inputs, vehicle=replace(inputs.vehicle, has_doubted_unit=True))
    for given_inputs, has_stepped in ((inputs, True), (found, False)):
        assert update_vehicle(led_astray, given_inputs, flight.system).phases.has_vehicle_stepped is has_stepped


@pytest.mark.parametrize(
    ("config", "is_placed", "is_one"),
    [(CompanionConfig(), True, True), (CompanionConfig(), False, False), (CONFIG, False, True)],
    ids=["phases alone", "phases beside a detector of wrong stamps", "configured"],
)
def test_phases_alone_vouch_for_no_frame_beside_a_detector_whose_sightings_cannot_be_placed(
    config: CompanionConfig, *, is_placed: bool, is_one: bool
) -> None:
    flight = reached(Phase.CHASE)
    fixed, inputs = replace(flight.memory.vehicle, phases=after(FIXED)), flight.inputs()
    inputs = replace(inputs, vehicle=replace(inputs.vehicle, has_unplaced_sightings=not is_placed))
    _, pad = predict_pad(Phase.CHASE, fixed, inputs, replace(flight.system, config=config))
    assert pad is not None
    assert pad.has_one_frame is is_one


def test_stamps_that_go_back_vouch_for_no_receiver_that_has_stepped() -> None:
    phases = with_place_step(with_place_step(after(FIXED), (1, 0.7)), (2, 0.7), on_way(-0.078))
    assert not are_frames_one(with_place_step(phases, (3, 0.7), on_way(0.078)), AUTO, LATER_NS)


def test_drones_receiver_that_is_fixed_anew_vouches_for_no_vehicle_that_has_stepped() -> None:
    phases = with_place_step(after(FIXED), (1, 5.0))
    for step, drone_is_fixed in enumerate([False, *[True] * 30]):
        phases = update(phases, [fix(0.01)], LATER_NS + step * STEP_NS, drone_is_fixed=drone_is_fixed)
    assert not are_frames_one(phases, AUTO, LATER_NS + 30 * STEP_NS)


def moved(shift_enu_m: Vector3, origin_m: Vector3 = (0.0, 0.0, 0.0), std_m: float = 0.0) -> FrameMoves:
    """The drone's place has stepped so far, and its origin has moved."""
    return FrameMoves(shift_enu_m=shift_enu_m, origin_shift_enu_m=origin_m, shift_variance_m2=std_m**2)


@pytest.mark.parametrize("configured", [AUTO, ReceiverFrames.ONE])
@pytest.mark.parametrize(
    ("moves", "is_one"),
    [
        (moved((0.05, -0.06, 0.0)), True),
        (moved((0.09, -0.08, 0.0)), False),
        (moved((-0.6, 0.4, 0.0), std_m=0.07), False),
        (moved((0.15, -0.13, 0.0), std_m=0.07), True),  # the drone may have flown so far
        (moved((0.0, 0.0, 3.0)), True),
        (moved((-2.3, 0.9, 0.4), (-2.22, 0.86, 0.4), std_m=0.07), True),
        (moved((-2.3, 0.9, 0.4), (-2.3, 0.3, 0.4), std_m=0.07), False),
    ],
)
def test_drone_that_steps_by_more_than_two_fixed_phases_err_and_its_origin_does_has_no_frame_any_more(
    configured: ReceiverFrames, moves: FrameMoves, *, is_one: bool
) -> None:
    stepped = update(after(FIXED), [fix(0.01)], LATER_NS, moves=moves)
    assert are_frames_one(stepped, configured, LATER_NS) is is_one
    assert are_frames_one(update(stepped, [], LATER_NS, moves=moves), configured, 2 * LATER_NS) is is_one


def test_place_that_steps_before_its_origin_does_has_a_frame_again_with_it() -> None:
    step_m = (3.0, -1.2, 0.0)
    stepped = update(after(FIXED), [], LATER_NS, moves=moved(step_m))
    told = update(stepped, [], LATER_NS, moves=moved(step_m, step_m))
    assert (stepped.has_stepped, told.has_stepped) == (True, False)


def test_autopilot_that_restarts_and_counts_no_steps_any_more_raises_nothing() -> None:
    restarted = update(replace(after(FIXED), fixed_moves=moved((0.7, 0.0, 0.0), std_m=0.1)), [], LATER_NS)
    assert restarted.has_stepped


@pytest.mark.parametrize(("anew", "is_one"), [("drone", True), ("vehicle", False)])
def test_only_the_receiver_that_has_stepped_vouches_for_itself_by_being_fixed_anew(anew: str, *, is_one: bool) -> None:
    moves = moved((0.5, -0.4, 0.0))
    phases = update(after(FIXED), [], LATER_NS, moves=moves)
    std_m = 0.3 if anew == "vehicle" else 0.01
    phases = update(phases, [fix(std_m)], LATER_NS, drone_is_fixed=anew != "drone", moves=moves)
    for step in range(30):
        phases = update(phases, [fix(0.01)], LATER_NS + step * STEP_NS, moves=moves)
    assert are_frames_one(phases, AUTO, LATER_NS + 30 * STEP_NS) is is_one


def test_drone_that_steps_before_both_have_fixed_phases_has_a_frame() -> None:
    phases = FixedPhases()
    for step in range(30):
        moves = moved((0.1 * min(step, 8), 0.0, 0.0))
        phases = update(phases, [fix(0.3 if step < 9 else 0.01)], step * STEP_NS, moves=moves)
    assert are_frames_one(phases, AUTO, 29 * STEP_NS)


@pytest.mark.parametrize("step_m", [0.0, 0.7])
def test_step_of_the_drones_place_in_flight_takes_the_frames_apart(step_m: float) -> None:
    flight = Flight()
    vehicle = flight.memory.vehicle
    for step, east_m in enumerate([0.0, 0.0, step_m]):
        inputs = flight.inputs()
        moves = FrameMoves(origin_count=1, shift_enu_m=(east_m, 0.0, 0.0), stepped_ns=inputs.t_ns)
        view = replace(inputs.autopilot, receiver=Receiver(is_fixed=True, knows_geoid=True), frame_moves=moves)
        told = replace(inputs.vehicle, measurements=(fix(0.01, inputs.t_ns + step),))
        vehicle = update_vehicle(vehicle, replace(inputs, autopilot=view, vehicle=told), flight.system)
    assert vehicle.phases.has_stepped is (step_m > 0.0)


def test_step_of_phases_that_are_not_fixed_and_a_filter_that_counts_anew_are_none() -> None:
    floats = with_place_step(after([(0.3, True)] * 30), (1, 5.0))
    assert not floats.has_stepped
    counted = with_place_step(after(FIXED), (3, 0.01))
    assert not with_place_step(counted, (1, 5.0)).has_stepped


def test_the_newest_fix_of_a_step_counts() -> None:
    fixes = [fix(0.01, t_ns=2), fix(0.3, t_ns=1)]
    assert update(FixedPhases(), fixes, 0).since_ns == 0


@pytest.mark.parametrize(("configured", "is_one"), [(ReceiverFrames.ONE, True), (ReceiverFrames.APART, False)])
def test_who_flies_knows_better(configured: ReceiverFrames, *, is_one: bool) -> None:
    told = [(0.3, False)] * 30 if is_one else [(0.01, True)] * 30
    assert are_frames_one(after(told), configured, 29 * STEP_NS) is is_one


@given(fixes=st.lists(st.sampled_from([True, False, None]), min_size=1, max_size=80))
def test_frames_that_are_said_to_be_one_are_so_while_the_drone_has_not_been_without_a_fix_for_the_hold_time(
    fixes: list[bool | None],
) -> None:
    phases = FixedPhases()
    for step, has_fix in enumerate(fixes):
        phases = update(phases, [fix(0.3)], step * STEP_NS, drone_is_fixed=False, has_fix=has_fix)
    is_one = are_frames_one(phases, ReceiverFrames.ONE, (len(fixes) - 1) * STEP_NS)
    assert is_one is (False not in fixes[-HOLD_STEPS:])


@pytest.mark.parametrize(("has_fix", "phase"), [(None, Phase.DESCEND), (True, Phase.DESCEND), (False, Phase.ALIGN)])
def test_descent_onto_an_unseen_pad_is_broken_off_where_the_drone_has_lost_its_fix(
    phase: Phase, *, has_fix: bool | None
) -> None:
    flight = reached(Phase.DESCEND)
    flight.view = replace(flight.view, receiver=replace(flight.view.receiver, has_fix=has_fix))
    flight.run(0.1)
    assert flight.phase is phase


@pytest.mark.parametrize(
    ("fixes", "lost_in"),
    [
        ([None] * 30, []),
        ([True, False, False, False], [1]),
        ([False] * 30, [0]),
        ([False, True, False], [0]),
        ([False, *[True] * HOLD_STEPS, False, False], [0, HOLD_STEPS + 1]),
    ],
)
def test_fix_is_lost_once_until_there_was_one_for_the_hold_time(fixes: list[bool | None], lost_in: list[int]) -> None:
    phases, lost = FixedPhases(), []
    for step, has_fix in enumerate(fixes):
        if has_lost_fix(phases, Receiver(has_fix=has_fix), step * STEP_NS):
            lost.append(step)
        phases = update(phases, [], step * STEP_NS, has_fix=has_fix)
    assert lost == lost_in


def test_lost_fix_takes_what_sightings_have_told_until_others_agree() -> None:
    flight = Flight()
    flight.step()
    inputs = flight.inputs()
    view = replace(inputs.autopilot, receiver=Receiver(has_fix=False, knows_geoid=True))
    confirmed = SightingWatch(is_confirmed=True, was_confirmed=True)
    vehicle = replace(flight.memory.vehicle, sightings=confirmed)
    lost = update_vehicle(vehicle, replace(inputs, autopilot=view), flight.system)
    assert lost.sightings == SightingWatch(was_confirmed=True)
    again = replace(lost, sightings=confirmed)
    assert update_vehicle(again, replace(inputs, autopilot=view), flight.system).sightings.is_confirmed


@pytest.mark.parametrize(("configured", "useless"), [(ReceiverFrames.ONE, "--receiver-frames"), (AUTO, "frames auto")])
def test_unseen_pad_is_told_with_no_setting_that_is_set_already(configured: ReceiverFrames, useless: str) -> None:
    config = CompanionConfig(integrity=IntegrityConfig(receiver_frames=configured))
    told = sentence(tell_unseen(situation(), config))
    assert "use a pattern detector" in told
    assert useless not in told


def test_pad_of_which_all_sightings_are_refused_is_told_with_the_detectors_clock() -> None:
    told = tell_unseen(changed(situation(), has_unplaced_sightings=True), CompanionConfig())
    assert told == Cause(Reason.SIGHTINGS_UNPLACED)
    assert "detector's clock" in sentence(told)


def test_pad_that_is_seen_too_seldom_is_not_told_as_unseen() -> None:
    told = tell_unseen(changed(situation(), is_pad_sighted=True), CompanionConfig())
    assert told == Cause(Reason.SIGHTINGS_VAGUE)
    assert "not seen" not in sentence(told)
