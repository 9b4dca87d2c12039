"""What a rollout expects of the deck: its slope is the road's and the swing's, whatever the pad's height does.

And what may be off of it: as much of slope and shake as of the tilt.
"""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.autopilots.response import ResponseModel
from companion.core.data import Array
from companion.landing.state.memory import ForecastMemory, ModelMemory, StepMemory
from companion.landing.state.step_data import StepInputs
from companion.landing.touchdown.rollout_errors import draw_deck
from companion.landing.touchdown.rollout_inputs import course_of, follower_of, way_to_contact
from companion.vehicle.pad import PadMounting, PadPath
from companion.vehicle.shake import PadSwing, tilted_deck
from link.records import replace
from tests.companion.autopilots.test_response import CASCADES, OFFSET_S
from tests.companion.facts import CONFIG, NOW_NS, pad_at, reference_at, situation

HEIGHT_M = 1.2
GRADE = 0.08
RESPONSE = ResponseModel(next(iter(CASCADES.values())), OFFSET_S)


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
    swing = PadSwing(
        slope=np.tile([0.0, 0.05], (n, 1)),
        shake_enu=shake,
        tilt_std_rad=np.zeros((n, 4)),
        above_m=1.5,
        heave_rad_s=1.0,
    )
    slope = slope_over(replace(pad, swing=swing))
    np.testing.assert_allclose(slope, np.tile([GRADE, 0.05], (len(slope), 1)))


@given(
    yaw_rad=st.floats(-3.0, 3.0),
    tilt=st.tuples(*4 * [st.floats(-0.2, 0.2)]),
    above_m=st.floats(0.0, 3.0),
)
def test_deck_that_tilts_otherwise_is_off_by_what_the_tilt_makes_of_it(
    yaw_rad: float, tilt: tuple[float, float, float, float], above_m: float
) -> None:
    n = 3
    axis = (1.0, 0.1, above_m)
    slope, shake = tilted_deck(np.full(n, yaw_rad), np.tile(tilt, (n, 1)), axis, axis)
    swing = PadSwing(
        slope=np.zeros((n, 2)),
        shake_enu=np.zeros((3, n, 2)),
        tilt_std_rad=np.outer([0.0, 1.0, 2.0], np.abs(tilt)),
        above_m=above_m,
        heave_rad_s=1.0,
    )
    pad = replace(pad_at(), offset_s=np.array([0.0, 0.5, 1.0]), yaw_rad=yaw_rad, swing=swing)
    expected = np.stack([slope[0], shake[0, 0], shake[1, 0]])
    for contact_s, size in ((0.0, 0.0), (0.5, 1.0), (0.75, 1.5)):
        off = draw_deck(pad, contact_s, np.sign(tilt)[None])
        np.testing.assert_allclose(off, size * expected[None], atol=1e-12)


def test_deck_that_tells_no_tilt_is_off_by_nothing() -> None:
    assert not draw_deck(pad_at(), 0.5, np.ones((4, 4))).any()


@pytest.mark.parametrize(("speed_m_s", "told", "trails_s"), [(6.0, False, 0.2), (-6.0, False, -0.2), (6.0, True, 0.0)])
def test_antenna_trails_the_pad_unless_a_sensor_tells_how_the_vehicle_turns(
    speed_m_s: float, trails_s: float, *, told: bool
) -> None:
    pad = replace(pad_at((speed_m_s, 0.0, 0.0)), yaw_rad=0.0, mounting=PadMounting(arm_m=1.2, ahead_m=1.2))
    facts = situation(HEIGHT_M, pad=pad)
    memory = StepMemory(forecast=ForecastMemory(turning_ns=NOW_NS - 10**8 if told else NOW_NS - 10**10))
    inputs = StepInputs(t_ns=NOW_NS, monotonic_ns=NOW_NS, limits=CONFIG.limits.flight_limits(), response=RESPONSE)
    drone = follower_of(memory, facts, inputs, CONFIG, relearns_hz=0.0, error_std_m_s=0.05)
    assert drone.trails_s == pytest.approx(trails_s)
