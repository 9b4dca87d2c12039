"""The plan onto a deck that heaves, as the virtual model flies it: how hard it touches."""

import math

import numpy as np
import pytest

from companion.config.companion import CompanionConfig
from companion.landing.steering.targets import HORIZON_OFFSETS_S, pad_aim
from companion.planning.guidance import PlanRequest, PlanStatus, ReferenceState
from companion.planning.mpc import Mpc
from companion.situation.phases import Phase
from companion.vehicle.pad import PadPath

CONFIG = CompanionConfig()
LIMITS = CONFIG.limits.flight_limits()
MPC = Mpc(CONFIG.guidance.mpc)
FEET_M, BEGINS_M, PERIOD_S, LONGEST_S = 0.12, 2.5, 0.02, 20.0


def _deck(t_s: float, amplitude_m: float, period_s: float, phase_rad: float) -> PadPath:
    """A deck that heaves evenly, forecast exactly."""
    rate, angle = 2.0 * math.pi / period_s, 2.0 * math.pi / period_s * (t_s + HORIZON_OFFSETS_S) + phase_rad
    level = np.zeros((len(angle), 2))
    return PadPath(
        offset_s=HORIZON_OFFSETS_S,
        position_enu_m=np.column_stack([level, amplitude_m * np.sin(angle)]),
        velocity_enu_m_s=np.column_stack([level, amplitude_m * rate * np.cos(angle)]),
        acceleration_enu_m_s2=np.column_stack([level, -amplitude_m * rate**2 * np.sin(angle)]),
        yaw_rad=0.0,
        position_std_m=np.full((len(angle), 3), 0.05),
    )


def _above(pad: PadPath) -> ReferenceState:
    velocity = np.clip(pad.velocity_enu_m_s[0], -LIMITS.descent_max_m_s, LIMITS.climb_max_m_s)
    up = np.array([0.0, 0.0, FEET_M + BEGINS_M])
    return ReferenceState(
        position_enu_m=pad.position_enu_m[0] + up, velocity_enu_m_s=velocity, acceleration_enu_m_s2=np.zeros(3)
    )


def _sink_at_contact_m_s(amplitude_m: float, period_s: float, phase_rad: float) -> float:
    model = _above(_deck(0.0, amplitude_m, period_s, phase_rad))
    for step in range(round(LONGEST_S / PERIOD_S)):
        pad = _deck(step * PERIOD_S, amplitude_m, period_s, phase_rad)
        if model.position_enu_m[2] - FEET_M <= pad.position_enu_m[0, 2]:
            return float(pad.velocity_enu_m_s[0, 2] - model.velocity_enu_m_s[2])
        aim = pad_aim(Phase.DESCEND, pad, model, FEET_M, CONFIG, limits=LIMITS)
        request = PlanRequest(
            state=model,
            target=aim.target,
            limits=LIMITS,
            floor_enu_m=aim.floor_enu_m,
            touched_enu_m=aim.touched_enu_m,
            dt_s=PERIOD_S,
        )
        plan = MPC.plan(None, request)[1]
        assert plan.status is PlanStatus.SOLVED
        model = plan.next_state
    raise AssertionError("it never touched")


@pytest.mark.slow
@pytest.mark.parametrize("phase_rad", np.linspace(0.0, 2.0 * math.pi, 6, endpoint=False).tolist())
@pytest.mark.parametrize(("amplitude_m", "period_s"), [(0.1, 1.3), (1.5, 9.0), (3.5, 8.0)])
def test_deck_that_comes_up_faster_than_it_can_be_followed_is_touched_no_harder_than_s2_allows(
    amplitude_m: float, period_s: float, phase_rad: float
) -> None:
    """At 3.5 m and 8 s the deck sinks at 2.7 m/s, the drone at 1.5 m/s at most; it takes 2.2 of its 3 m/s^2."""
    assert _sink_at_contact_m_s(amplitude_m, period_s, phase_rad) < CONFIG.touchdown.sink_max_m_s + 0.01


def test_level_pad_is_touched_at_the_rate_of_contact() -> None:
    assert _sink_at_contact_m_s(0.0, 10.0, 0.0) == pytest.approx(CONFIG.descent.sink.contact_rate_m_s, abs=0.01)
