"""The aims of the phases: the sink profile against its differential equation, hovering and following the pad."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from companion.config.companion import CompanionConfig
from companion.config.landing import DescentConfig
from companion.landing.targets import HORIZON_OFFSETS_S, hover_aim, pad_aim, sink_profile, stopping_point
from companion.planning.guidance import ReferenceState
from companion.situation.phases import Phase
from companion.vehicle.pad import PadPath

CONFIG = CompanionConfig()
DESCENT = DescentConfig()


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


@pytest.mark.slow
@pytest.mark.parametrize("height_m", [5.0, 2.3, 0.8, 0.31, 0.0, -0.2, -0.7])
def test_sink_profile_solves_its_differential_equation(height_m: float) -> None:
    def rate(_: float, h: np.ndarray) -> list[float]:
        if h[0] <= -DESCENT.press_depth_m:
            return [0.0]
        wanted = DESCENT.descent_gain_hz * h[0]
        return [-min(max(wanted, DESCENT.touchdown_sink_rate_m_s), DESCENT.descent_rate_max_m_s)]

    truth = solve_ivp(rate, (0.0, 4.0), [height_m], t_eval=HORIZON_OFFSETS_S, max_step=1e-3)
    height, _ = sink_profile(height_m, HORIZON_OFFSETS_S, DESCENT)
    np.testing.assert_allclose(height, truth.y[0], atol=2e-3)


def test_sink_rate_is_never_above_the_largest_nor_below_the_touchdown_rate_before_the_end() -> None:
    height, rate = sink_profile(4.0, HORIZON_OFFSETS_S, DESCENT)
    before_the_end = height > -DESCENT.press_depth_m + 1e-9
    assert np.all(rate[before_the_end] >= DESCENT.touchdown_sink_rate_m_s)
    assert np.all(rate <= DESCENT.descent_rate_max_m_s)


def test_hover_aim_stays_at_its_point() -> None:
    aim = hover_aim(np.array([1.0, 2.0, 3.0]))
    assert np.all(aim.target.position_enu_m == [1.0, 2.0, 3.0])
    assert not np.any(aim.target.velocity_enu_m_s)


@pytest.mark.parametrize("phase", [Phase.CHASE, Phase.ALIGN, Phase.DESCEND, Phase.TOUCHDOWN, Phase.ABORT])
def test_pad_aim_follows_the_pad_horizontally(phase: Phase) -> None:
    pad = _pad_path(5.0)
    aim = pad_aim(phase, pad, _at(0.0, -2.0, 5.0), 0.12, CONFIG)
    np.testing.assert_array_equal(aim.target.position_enu_m[:, :2], pad.position_enu_m[:, :2])
    np.testing.assert_array_equal(aim.target.velocity_enu_m_s[:, :2], pad.velocity_enu_m_s[:, :2])


@pytest.mark.parametrize("phase", [Phase.CHASE, Phase.ALIGN, Phase.ABORT])
def test_phases_before_the_descent_keep_the_feet_above_the_pad(phase: Phase) -> None:
    pad = _pad_path(5.0)
    aim = pad_aim(phase, pad, _at(0.0, -2.0, 5.0), 0.12, CONFIG)
    assert np.all(aim.floor_enu_m > pad.position_enu_m[:, 2] + 0.12)
    assert np.all(aim.target.position_enu_m[:, 2] >= aim.floor_enu_m)


def test_chase_comes_lower_as_the_distance_closes() -> None:
    pad = _pad_path(5.0)
    far = pad_aim(Phase.CHASE, pad, _at(-20.0, -2.0, 5.0), 0.12, CONFIG).target.position_enu_m[0, 2]
    near = pad_aim(Phase.CHASE, pad, _at(1.0, -2.0, 5.0), 0.12, CONFIG).target.position_enu_m[0, 2]
    assert near < far


def test_chase_stays_high_over_a_vehicle_whose_place_is_vague() -> None:
    known = _pad_path(5.0)
    vague = replace(known, position_std_m=np.full_like(known.position_std_m, CONFIG.abort.position_std_max_m + 0.01))
    near = _at(3.1, -2.0, 1.5 + CONFIG.descent.align_height_m)
    heights = [pad_aim(Phase.CHASE, pad, near, 0.12, CONFIG).target.position_enu_m[:, 2] for pad in (known, vague)]
    np.testing.assert_allclose(heights[0], 1.5 + 0.12 + CONFIG.descent.align_height_m)
    np.testing.assert_allclose(heights[1], 1.5 + 0.12 + CONFIG.chase.height_m)


def test_stopping_point_is_the_closed_form_of_even_braking() -> None:
    moving = ReferenceState(
        position_enu_m=np.array([1.0, 2.0, 3.0]),
        velocity_enu_m_s=np.array([6.0, 0.0, 0.0]),
        acceleration_enu_m_s2=np.zeros(3),
    )
    np.testing.assert_allclose(stopping_point(moving, 2.0), [1.0 + 6.0**2 / (2.0 * 2.0), 2.0, 3.0])


def test_fast_flight_with_a_little_sink_stops_no_lower_than_the_sink_takes() -> None:
    moving = ReferenceState(
        position_enu_m=np.array([1.0, 2.0, 3.0]),
        velocity_enu_m_s=np.array([12.0, 16.0, -1.0]),
        acceleration_enu_m_s2=np.zeros(3),
    )
    np.testing.assert_allclose(stopping_point(moving, 2.0), [1.0 + 12.0 * 5.0, 2.0 + 16.0 * 5.0, 3.0 - 0.25])
