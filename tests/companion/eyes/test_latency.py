"""How late pictures are stamped, from a drone that turns over a pad that stands."""

import math

import numpy as np
import pytest

from companion.eyes.attitude import Attitude
from companion.eyes.latency import SIGHTINGS_MIN, fit_latency
from link.errors import UserError
from link.frames.rotations import conjugate, multiply, normalized, quaternion_from_roll_pitch_yaw
from link.messages import PadSighting, Quaternion

EPOCH_NS = 10**18
NOISE_RAD = 0.01
PAD_WXYZ = quaternion_from_roll_pitch_yaw(0.02, 0.01, 2.0)


def attitude_at(t_s: float, share: float) -> Quaternion:
    roll, pitch = 0.25 * math.sin(4.4 * t_s), 0.2 * math.sin(3.1 * t_s + 1.0)
    return quaternion_from_roll_pitch_yaw(share * roll, share * pitch, 0.1 * math.sin(t_s))


def flown(late_s: float, *, share: float = 1.0, count: int = 240) -> tuple[list[Attitude], list[PadSighting]]:
    """What is told of a drone that rolls and pitches: attitudes at 25 Hz, sightings at 30 Hz, some of them mirrored."""
    rng = np.random.default_rng(round(1e3 * late_s) + 99)
    attitudes = [
        Attitude(t_ns=EPOCH_NS + round(t_s * 1e9), orientation_wxyz=attitude_at(t_s, share))
        for t_s in np.arange(0.0, 10.0, 0.04).tolist()
    ]
    sightings = []
    for index in range(count):
        t_s = 0.6 + index / 30.0
        seen = multiply(conjugate(attitude_at(t_s, share)), PAD_WXYZ)
        x, y, z = (0.5 * NOISE_RAD * rng.standard_normal(3)).tolist()
        mirrored = (0.0, 0.4, 0.0) if index % 20 == 7 else (0.0, 0.0, 0.0)
        turn = normalized((1.0, x + mirrored[0], y + mirrored[1], z + mirrored[2]))
        sightings.append(
            PadSighting(
                t_ns=EPOCH_NS + round((t_s + late_s) * 1e9),
                position_flu_m=(0.0, 0.0, -3.0),
                orientation_wxyz=normalized(multiply(seen, turn)),
                position_covariance_m2=(1e-4, 0.0, 0.0, 0.0, 1e-4, 0.0, 0.0, 0.0, 1e-4),
            )
        )
    return attitudes, sightings


@pytest.mark.slow
@pytest.mark.parametrize("late_s", [-0.03, 0.0, 0.043, 0.31])
def test_rotation_tells_the_latency_to_its_own_deviation(late_s: float) -> None:
    found = fit_latency(*flown(late_s))
    assert abs(found.latency_s - late_s) < 4.0 * found.std_s
    assert found.std_s < 0.002


def test_a_drone_that_hardly_turns_tells_nothing() -> None:
    with pytest.raises(UserError, match="roll and pitch it"):
        fit_latency(*flown(0.04, share=0.05))


def test_too_few_sightings_tell_nothing() -> None:
    with pytest.raises(UserError, match="keep it in view"):
        fit_latency(*flown(0.04, count=SIGHTINGS_MIN - 1))


@pytest.mark.slow
def test_stamps_of_another_clock_are_named() -> None:
    attitudes, _ = flown(0.04)
    with pytest.raises(UserError, match="clocks"):
        fit_latency(attitudes, flown(0.9)[1])
