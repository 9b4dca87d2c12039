import math

import numpy as np
import pytest

from companion.config.estimation import ImmConfig, SwingConfig
from companion.core.data import Array
from companion.vehicle.deck_motion import first_motion, learn, passed
from companion.vehicle.imm_swing import heave_step

AFLOAT, ON_ROAD = ImmConfig().afloat, ImmConfig().on_road
STEP_S = 0.02


def watched(swing: SwingConfig, seconds: float, truth: tuple[float, float, float], *, list_m: float = 0.0) -> Array:
    """What is learnt of an oscillator of frequency (rad/s), damping and deviation on all three axes."""
    A, noise = heave_step(STEP_S, *truth)
    root, rng = np.linalg.cholesky(noise), np.random.default_rng(4)
    z, motion = np.zeros((3, 2)), first_motion(swing)
    for _ in range(round(seconds / STEP_S)):
        z = z @ A.T + rng.standard_normal((3, 2)) @ root.T
        motion = learn(passed(motion, STEP_S), (z + np.array([list_m, 0.0])).ravel().tolist(), swing.lag_s)
    return np.asarray(motion.oscillators.reshape(3, 3))


def test_deck_that_was_not_watched_swings_as_it_is_configured() -> None:
    heave, roll, pitch = first_motion(AFLOAT).oscillators.reshape(3, 3)
    assert heave == pytest.approx([2.0 * math.pi * 0.1, 0.2, 2.0 * math.pi * 0.1 * 0.8])
    assert roll == pytest.approx([2.0 * math.pi * 0.1, 0.2, 0.03])
    assert pitch == pytest.approx(roll)


@pytest.mark.parametrize(("swing", "truth"), [(AFLOAT, (0.8, 0.15, 0.5)), (ON_ROAD, (2.0 * math.pi * 1.6, 0.3, 0.02))])
def test_frequency_damping_and_size_are_learnt(swing: SwingConfig, truth: tuple[float, float, float]) -> None:
    found = watched(swing, 120.0, truth).mean(axis=0)
    assert found[0] == pytest.approx(truth[0], rel=0.1)
    assert found[1] == pytest.approx(truth[1], abs=0.08)
    assert found[2] == pytest.approx(truth[2], rel=0.3)


def test_list_is_no_swinging() -> None:
    level, listing = (watched(AFLOAT, 180.0, (0.8, 0.15, 0.5), list_m=m) for m in (0.0, 3.0))
    assert listing[:, 2].mean() < 2.0 * level[:, 2].mean()


def test_silence_makes_no_pair() -> None:
    motion = learn(passed(first_motion(AFLOAT), 0.5), (1.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.5)
    after = learn(passed(motion, 30.0), (-1.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.5)
    assert after.oscillators == pytest.approx(motion.oscillators)
    assert after.axes[0].last == (-1.0, 0.0)


def test_deck_that_lies_still_for_hours_keeps_what_was_learnt_last() -> None:
    swing = ON_ROAD.model_copy(update={"lag_s": 10.0})
    motion = first_motion(swing)
    for _ in range(3_000):  # the sums fade to nothing within six hours
        motion = learn(passed(motion, 10.0), (0.0, 0.0, 0.02, 0.0, 0.0, 0.0), 10.0)
    assert motion.axes[0].at_once[0] * motion.axes[0].at_once[2] == 0.0
    assert np.isfinite(motion.oscillators).all()
