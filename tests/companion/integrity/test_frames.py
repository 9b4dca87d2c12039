"""Two receivers have one frame while both say that their phases are fixed, or where somebody knows it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.integrity import ReceiverFrames
from companion.core.data import FIXED_STD_MAX_M, Measurement, Quantity
from companion.integrity.sightings import (
    FixedPhases,
    are_frames_one,
    update_fixed_phases,
    with_place_step,
)

STEP_NS = 100_000_000
HOLD_STEPS = 20
AUTO = ReceiverFrames.AUTO


def fix(std_m: float, t_ns: int = 0, quantity: Quantity = Quantity.POSITION) -> Measurement:
    covariance = np.diag([0.5 * std_m, std_m, 10.0 * std_m]) ** 2
    return Measurement(t_ns=t_ns, quantity=quantity, value=np.zeros(3), covariance=covariance)


def after(steps: list[tuple[float, bool]]) -> FixedPhases:
    """What is known after a fix of such a deviation, and such a state of the drone's receiver, in each step."""
    phases = FixedPhases()
    for step, (std_m, drone_is_fixed) in enumerate(steps):
        phases = update_fixed_phases(phases, [fix(std_m)], step * STEP_NS, drone_is_fixed=drone_is_fixed)
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
        assert update_fixed_phases(phases, measurements, 10**10, drone_is_fixed=True) == phases


FIXED, LATER_NS = [(0.01, True)] * 30, 100 * STEP_NS


@pytest.mark.parametrize("configured", [AUTO, ReceiverFrames.ONE])
@pytest.mark.parametrize(("moved_m", "is_one"), [(0.08, True), (0.12, False), (5.0, False)])
def test_vehicle_that_steps_by_more_than_two_fixed_phases_err_has_no_frame_any_more(
    configured: ReceiverFrames, moved_m: float, *, is_one: bool
) -> None:
    stepped = with_place_step(after(FIXED), (1, moved_m))
    assert are_frames_one(stepped, configured, LATER_NS) is is_one
    going_on = update_fixed_phases(with_place_step(stepped, (1, moved_m)), [fix(0.01)], LATER_NS, drone_is_fixed=True)
    assert are_frames_one(going_on, configured, 2 * LATER_NS) is is_one


def test_receiver_that_has_fixed_its_phases_anew_has_a_frame_again() -> None:
    phases = with_place_step(after(FIXED), (1, 5.0))
    for step, std_m in enumerate([0.3, *[0.01] * 30]):
        phases = update_fixed_phases(phases, [fix(std_m)], LATER_NS + step * STEP_NS, drone_is_fixed=True)
    assert are_frames_one(phases, AUTO, LATER_NS + 30 * STEP_NS)


def test_drones_receiver_that_is_fixed_anew_vouches_for_no_vehicle_that_has_stepped() -> None:
    phases = with_place_step(after(FIXED), (1, 5.0))
    for step, drone_is_fixed in enumerate([False, *[True] * 30]):
        phases = update_fixed_phases(phases, [fix(0.01)], LATER_NS + step * STEP_NS, drone_is_fixed=drone_is_fixed)
    assert not are_frames_one(phases, AUTO, LATER_NS + 30 * STEP_NS)


def test_step_of_phases_that_are_not_fixed_and_a_filter_that_counts_anew_are_none() -> None:
    floats = with_place_step(after([(0.3, True)] * 30), (1, 5.0))
    assert not floats.has_stepped
    counted = with_place_step(after(FIXED), (3, 0.01))
    assert not with_place_step(counted, (1, 5.0)).has_stepped


def test_the_newest_fix_of_a_step_counts() -> None:
    fixes = [fix(0.01, t_ns=2), fix(0.3, t_ns=1)]
    assert update_fixed_phases(FixedPhases(), fixes, 0, drone_is_fixed=True).since_ns == 0


@pytest.mark.parametrize(("configured", "is_one"), [(ReceiverFrames.ONE, True), (ReceiverFrames.APART, False)])
def test_who_flies_knows_better(configured: ReceiverFrames, *, is_one: bool) -> None:
    told = [(0.3, False)] * 30 if is_one else [(0.01, True)] * 30
    assert are_frames_one(after(told), configured, 29 * STEP_NS) is is_one
