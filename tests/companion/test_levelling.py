"""Just above the pad the drone is levelled, so that it does not touch down with one foot."""

from dataclasses import replace

import numpy as np
import pytest

from companion.config import CompanionConfig
from companion.data import OwnState
from companion.flying import limits_now
from companion.phases import Phase
from companion.situation import drone_now
from companion.step_data import StepMemory
from tests.companion.facts import NOW_NS, pad_at, situation

CONFIG = CompanionConfig()
LIMITS = CONFIG.limits.flight_limits()
LEVEL_M_S2 = CONFIG.touchdown.level_acceleration_min_m_s2
DESCENDS = replace(StepMemory(), phase=Phase.DESCEND)


def acceleration_max(height_m: float, lean: float, memory: StepMemory = DESCENDS) -> float:
    here = situation(height_m)
    assert here.drone is not None
    leaning = replace(here, drone=replace(here.drone, lean=lean))
    return limits_now(memory, leaning, LIMITS, CONFIG).acceleration_max_m_s2


@pytest.mark.parametrize(
    ("height_m", "lean", "levels"),
    [(0.07, 0.0, True), (0.09, 0.0, False), (0.17, 0.5, True), (0.19, 0.5, False), (1.0, 0.9, False)],
)
def test_a_leaning_drone_is_levelled_as_much_higher_as_its_lowest_foot_hangs_down(
    height_m: float, lean: float, *, levels: bool
) -> None:
    assert acceleration_max(height_m, lean) == (LEVEL_M_S2 if levels else LIMITS.acceleration_max_m_s2)


@pytest.mark.parametrize(
    ("turns_m_s2", "level_m_s2"),
    [
        (0.0, CONFIG.touchdown.level_acceleration_min_m_s2),
        (1.25, CONFIG.touchdown.level_share * 1.25),
        (4.0, CONFIG.touchdown.level_acceleration_max_m_s2),
    ],
    ids=["straight on", "a circle of 20 m at 5 m/s", "harder than it may lean"],
)
def test_a_drone_above_a_turning_pad_is_levelled_by_a_share_of_that_turn(turns_m_s2: float, level_m_s2: float) -> None:
    pad = pad_at()
    turn = np.tile([0.6 * turns_m_s2, -0.8 * turns_m_s2, 0.0], (len(pad.offset_s), 1))
    here = situation(0.05, pad=replace(pad, acceleration_enu_m_s2=turn))
    assert limits_now(DESCENDS, here, LIMITS, CONFIG).acceleration_max_m_s2 == pytest.approx(level_m_s2)


def test_nothing_but_a_descent_and_its_abort_is_levelled() -> None:
    assert acceleration_max(0.05, 0.0, replace(DESCENDS, phase=Phase.ALIGN)) == LIMITS.acceleration_max_m_s2


@pytest.mark.parametrize(("height_m", "lean", "levels"), [(0.4, 0.0, True), (0.44, 0.0, False), (0.5, 0.5, True)])
def test_a_drone_that_breaks_off_climbs_before_it_leans(height_m: float, lean: float, *, levels: bool) -> None:
    limit_m_s2 = acceleration_max(height_m, lean, replace(DESCENDS, phase=Phase.ABORT))
    assert limit_m_s2 == (LEVEL_M_S2 if levels else LIMITS.acceleration_max_m_s2)


@pytest.mark.parametrize(
    ("orientation_wxyz", "lean"),
    [((1.0, 0.0, 0.0, 0.0), 0.0), ((0.9659258, 0.2588190, 0.0, 0.0), 0.5), ((0.7071068, 0.0, 0.0, 0.7071068), 0.0)],
    ids=["level", "rolled by 30 degrees", "turned"],
)
def test_lean_is_the_sine_of_the_tilt(orientation_wxyz: tuple[float, float, float, float], lean: float) -> None:
    own = OwnState(
        t_ns=NOW_NS,
        position_enu_m=(0.0, 0.0, 5.0),
        velocity_enu_m_s=(0.0, 0.0, 0.0),
        orientation_wxyz=orientation_wxyz,
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
    )
    drone = drone_now(own, NOW_NS, 0.0, 1.0)
    assert drone is not None
    assert drone.lean == pytest.approx(lean, abs=1e-6)
