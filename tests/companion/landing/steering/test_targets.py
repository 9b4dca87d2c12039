"""The aims of the phases: hovering, following the pad, and the way down to it."""

import numpy as np
import pytest

from companion.config.companion import CompanionConfig
from companion.landing.steering.targets import HORIZON_OFFSETS_S, hover_aim, pad_aim, stopping_point, way_down
from companion.planning.guidance import ReferenceState
from companion.situation.phases import Phase
from companion.vehicle.pad import FrameOffset, PadPath
from link.records import replace

CONFIG = CompanionConfig()
DESCENT = CONFIG.descent
LIMITS = CONFIG.limits.flight_limits()
FEET_M = 0.12


def _pad_path(speed_m_s: float) -> PadPath:
    n = len(HORIZON_OFFSETS_S)
    velocity = np.tile([speed_m_s, 0.7, 0.0], (n, 1))
    return PadPath(
        offset_s=HORIZON_OFFSETS_S,
        position_enu_m=np.array([3.0, -2.0, 1.5]) + velocity * HORIZON_OFFSETS_S[:, None],
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=np.zeros((n, 3)),
        yaw_rad=0.1,
        position_std_m=np.full((n, 3), 0.05),
    )


def _at(x: float, y: float, z: float) -> ReferenceState:
    return ReferenceState(
        position_enu_m=np.array([x, y, z]), velocity_enu_m_s=np.zeros(3), acceleration_enu_m_s2=np.zeros(3)
    )


def test_hover_aim_stays_at_its_point() -> None:
    aim = hover_aim(np.array([1.0, 2.0, 3.0]))
    assert np.all(aim.target.position_enu_m == [1.0, 2.0, 3.0])
    assert not np.any(aim.target.velocity_enu_m_s)


@pytest.mark.parametrize("phase", [Phase.ALIGN, Phase.DESCEND, Phase.TOUCHDOWN, Phase.ABORT])
def test_pad_aim_follows_the_pad_horizontally(phase: Phase) -> None:
    pad = _pad_path(5.0)
    aim = pad_aim(phase, pad, _at(0.0, -2.0, 5.0), FEET_M, CONFIG, limits=LIMITS)
    np.testing.assert_array_equal(aim.target.position_enu_m[:, :2], pad.position_enu_m[:, :2])
    np.testing.assert_array_equal(aim.target.velocity_enu_m_s[:, :2], pad.velocity_enu_m_s[:, :2])


@pytest.mark.parametrize(
    ("std_m", "short_m"), [(0.05, 0.05), (0.4, 0.4), (2.0, 0.5 * DESCENT.alignment.begin_distance_m)]
)
def test_chase_aims_short_of_a_pad_by_what_its_place_is_unsure(std_m: float, short_m: float) -> None:
    pad = replace(_pad_path(5.0), position_std_m=np.full((len(HORIZON_OFFSETS_S), 3), std_m))
    aim = pad_aim(Phase.CHASE, pad, _at(9.0, -10.0, 5.0), FEET_M, CONFIG, limits=LIMITS)
    shift = aim.target.position_enu_m[:, :2] - pad.position_enu_m[:, :2]
    np.testing.assert_allclose(shift, np.tile([0.6 * short_m, -0.8 * short_m], (len(shift), 1)))
    np.testing.assert_array_equal(aim.target.velocity_enu_m_s[:, :2], pad.velocity_enu_m_s[:, :2])


def test_chase_that_is_as_near_as_the_pad_is_unsure_stays_where_it_is() -> None:
    pad = replace(_pad_path(5.0), position_std_m=np.full((len(HORIZON_OFFSETS_S), 3), 0.6))
    aim = pad_aim(Phase.CHASE, pad, _at(3.3, -2.2, 5.0), FEET_M, CONFIG, limits=LIMITS)
    np.testing.assert_allclose(aim.target.position_enu_m[0, :2], [3.3, -2.2])


@pytest.mark.parametrize("phase", [Phase.CHASE, Phase.ALIGN, Phase.ABORT])
def test_phases_before_the_descent_keep_the_feet_above_the_pad(phase: Phase) -> None:
    pad = _pad_path(5.0)
    aim = pad_aim(phase, pad, _at(0.0, -2.0, 5.0), FEET_M, CONFIG, limits=LIMITS)
    assert np.all(aim.floor_enu_m > pad.position_enu_m[:, 2] + FEET_M)
    assert np.all(aim.target.position_enu_m[:, 2] >= aim.floor_enu_m)
    higher = replace(pad, frame_offset=FrameOffset(higher_m=2.3))
    raised = pad_aim(phase, higher, _at(0.0, -2.0, 5.0), FEET_M, CONFIG, limits=LIMITS)
    np.testing.assert_allclose(raised.floor_enu_m, aim.floor_enu_m + 2.3)
    np.testing.assert_allclose(raised.target.position_enu_m[:, 2], aim.target.position_enu_m[:, 2] + 2.3)


def test_climb_after_an_abort_leads_clear_of_the_waves_crest() -> None:
    pad = _pad_path(5.0)
    calm, heaving = (
        pad_aim(Phase.ABORT, one, _at(0.0, -2.0, 5.0), FEET_M, CONFIG, limits=LIMITS).target.position_enu_m[:, 2]
        for one in (pad, replace(pad, crest_above_m=4.6))
    )
    np.testing.assert_allclose(heaving, calm + 4.6)


def test_chase_comes_lower_as_the_distance_closes() -> None:
    pad = _pad_path(5.0)
    far = pad_aim(Phase.CHASE, pad, _at(-20.0, -2.0, 5.0), FEET_M, CONFIG, limits=LIMITS).target.position_enu_m[0, 2]
    near = pad_aim(Phase.CHASE, pad, _at(1.0, -2.0, 5.0), FEET_M, CONFIG, limits=LIMITS).target.position_enu_m[0, 2]
    assert near < far


def test_chase_stays_high_over_a_vehicle_whose_place_is_vague() -> None:
    known = _pad_path(5.0)
    vague = replace(known, position_std_m=np.full_like(known.position_std_m, CONFIG.abort.position_std_max_m + 0.01))
    near = _at(3.1, -2.0, 1.5 + CONFIG.descent.alignment.height_m)
    heights = [
        pad_aim(Phase.CHASE, pad, near, FEET_M, CONFIG, limits=LIMITS).target.position_enu_m[:, 2]
        for pad in (known, vague)
    ]
    np.testing.assert_allclose(heights[0], 1.5 + FEET_M + CONFIG.descent.alignment.height_m)
    np.testing.assert_allclose(heights[1], 1.5 + FEET_M + CONFIG.chase.height_m)


def _over_pad(height_m: float, sink_m_s: float, pad: PadPath) -> ReferenceState:
    up = np.array([0.0, 0.0, height_m + FEET_M])
    return ReferenceState(
        position_enu_m=pad.position_enu_m[0] + up,
        velocity_enu_m_s=pad.velocity_enu_m_s[0] - np.array([0.0, 0.0, sink_m_s]),
        acceleration_enu_m_s2=pad.acceleration_enu_m_s2[0],
    )


def _heaving_pad() -> PadPath:
    pad = _pad_path(5.0)
    rises = np.array([0.0, 0.0, 0.2])
    return replace(
        pad,
        position_enu_m=pad.position_enu_m + rises * pad.offset_s[:, None],
        velocity_enu_m_s=pad.velocity_enu_m_s + rises,
    )


@pytest.mark.parametrize("lowest_m", [None, DESCENT.commit_height_m])
@pytest.mark.parametrize(("height_m", "sink_m_s"), [(1.5, 0.0), (0.9, 0.8), (0.2, -0.3)])
def test_descent_begins_where_the_model_is_and_as_it_moves(
    height_m: float, sink_m_s: float, lowest_m: float | None
) -> None:
    pad = _heaving_pad()
    model = _over_pad(height_m, sink_m_s, pad)
    aim = pad_aim(Phase.DESCEND, pad, model, FEET_M, CONFIG, limits=LIMITS, lowest_m=lowest_m).target
    np.testing.assert_allclose(aim.position_enu_m[0, 2], model.position_enu_m[2])
    np.testing.assert_allclose(aim.velocity_enu_m_s[0, 2], model.velocity_enu_m_s[2])


@pytest.mark.parametrize("height_m", [1.5, 0.5, 0.2])
def test_descent_that_waits_ends_at_the_height_where_it_is_to_wait(height_m: float) -> None:
    pad, waits_m = _heaving_pad(), DESCENT.commit_height_m
    aim = pad_aim(
        Phase.DESCEND, pad, _over_pad(height_m, 0.0, pad), FEET_M, CONFIG, limits=LIMITS, lowest_m=waits_m
    ).target
    over_pad_m = aim.position_enu_m[:, 2] - pad.position_enu_m[:, 2] - FEET_M
    assert over_pad_m.min() >= min(height_m, waits_m) - 0.02
    assert over_pad_m[-1] == pytest.approx(waits_m, abs=0.05)


def test_descent_that_goes_on_ends_below_the_pad() -> None:
    pad = _heaving_pad()
    aim = pad_aim(Phase.DESCEND, pad, _over_pad(1.5, 0.0, pad), FEET_M, CONFIG, limits=LIMITS).target
    assert aim.position_enu_m[-1, 2] < pad.position_enu_m[-1, 2] + FEET_M


@pytest.mark.parametrize(("height_m", "rate_m_s", "braking_m_s2"), [(2.0, -1.2, 1.5), (1.3, -2.3, 3.0)])
def test_sink_is_braked_with_all_there_is_where_half_would_come_too_late(
    height_m: float, rate_m_s: float, braking_m_s2: float
) -> None:
    heights_m, rates_m_s, accelerations_m_s2 = way_down(
        (height_m, rate_m_s, 0.0), np.arange(0.0, 4.0, 0.01), LIMITS, DESCENT
    )
    assert LIMITS.vertical_acceleration_max_m_s2 == 3.0
    assert braking_m_s2 - 1.5 < accelerations_m_s2.max() <= braking_m_s2 + 1e-9
    at_contact = int(np.argmax(heights_m <= 0.0))
    assert -0.7 <= rates_m_s[at_contact] <= -DESCENT.sink.contact_rate_m_s + 0.05  # S2 allows 0.7


def test_stopping_point_is_the_closed_form_of_even_braking() -> None:
    moving = ReferenceState(
        position_enu_m=np.array([1.0, 2.0, 3.0]),
        velocity_enu_m_s=np.array([6.0, 0.0, 0.0]),
        acceleration_enu_m_s2=np.zeros(3),
    )
    np.testing.assert_allclose(stopping_point(moving), [1.0 + 6.0**2 / (2.0 * 2.0), 2.0, 3.0])


def test_fast_flight_with_a_little_sink_stops_no_lower_than_the_sink_takes() -> None:
    moving = ReferenceState(
        position_enu_m=np.array([1.0, 2.0, 3.0]),
        velocity_enu_m_s=np.array([12.0, 16.0, -1.0]),
        acceleration_enu_m_s2=np.zeros(3),
    )
    np.testing.assert_allclose(stopping_point(moving), [1.0 + 12.0 * 5.0, 2.0 + 16.0 * 5.0, 3.0 - 0.25])
