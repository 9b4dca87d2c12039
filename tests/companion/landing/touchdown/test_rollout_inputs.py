"""What a rollout expects of the deck: its slope is the road's and the swing's, whatever the pad's height does."""

import numpy as np
import pytest

from companion.core.data import Array
from companion.landing.state.memory import ModelMemory, StepMemory
from companion.landing.touchdown.rollout_inputs import course_of, way_to_contact
from companion.vehicle.pad import PadPath
from companion.vehicle.shake import PadSwing
from link.records import replace
from tests.companion.facts import CONFIG, pad_at, reference_at, situation

HEIGHT_M = 1.2
GRADE = 0.08


def slope_over(pad: PadPath) -> Array:
    """The deck's slope (m, 2) in W on the way down."""
    facts = situation(HEIGHT_M, pad=pad)
    memory = StepMemory(model=ModelMemory(reference=reference_at(HEIGHT_M)))
    way, relative = way_to_contact(memory, facts, CONFIG), facts.approach
    assert way is not None
    assert relative is not None
    return course_of(memory, relative, pad, way, np.zeros((4, 2))).slope


@pytest.mark.parametrize("heaves_m_s", [-0.7, 0.0, 0.7])
def test_slow_deck_that_heaves_is_no_hill(heaves_m_s: float) -> None:
    assert not slope_over(replace(pad_at((1.3, 0.0, heaves_m_s)), yaw_rad=0.0)).any()


@pytest.mark.parametrize("speed_m_s", [2.0, -2.0])
def test_road_rises_where_the_vehicle_heads_whichever_way_it_drives(speed_m_s: float) -> None:
    slope = slope_over(replace(pad_at((speed_m_s, 0.0, GRADE * speed_m_s)), yaw_rad=0.0, grade=GRADE))
    np.testing.assert_allclose(slope, np.tile([GRADE, 0.0], (len(slope), 1)))


def test_swing_tilts_the_deck_beside_the_road() -> None:
    pad = replace(pad_at((4.0, 0.0, 0.0)), yaw_rad=0.0, grade=GRADE)
    n = len(pad.offset_s)
    shake = np.zeros((3, n, 2))
    swing = PadSwing(slope=np.tile([0.0, 0.05], (n, 1)), shake_enu=shake, climb_std_m_s=np.zeros(n), heave_rad_s=1.0)
    slope = slope_over(replace(pad, swing=swing))
    np.testing.assert_allclose(slope, np.tile([GRADE, 0.05], (len(slope), 1)))
