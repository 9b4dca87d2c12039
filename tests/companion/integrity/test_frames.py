"""Two receivers have one frame while both say that their phases are fixed, or where somebody knows it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.integrity import ReceiverFrames
from companion.core.data import Measurement, Quantity
from companion.integrity.sightings import FIXED_STD_MAX_M, FixedPhases, are_frames_one, update_fixed_phases

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


def test_the_newest_fix_of_a_step_counts() -> None:
    fixes = [fix(0.01, t_ns=2), fix(0.3, t_ns=1)]
    assert update_fixed_phases(FixedPhases(), fixes, 0, drone_is_fixed=True).since_ns == 0


@pytest.mark.parametrize(("configured", "is_one"), [(ReceiverFrames.ONE, True), (ReceiverFrames.APART, False)])
def test_who_flies_knows_better(configured: ReceiverFrames, *, is_one: bool) -> None:
    told = [(0.3, False)] * 30 if is_one else [(0.01, True)] * 30
    assert are_frames_one(after(told), configured, 29 * STEP_NS) is is_one
