"""Over a link with jitter a landing drone is asked for velocities and a height: a late place would lean it."""

import numpy as np
import pytest

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.autopilots.driver import Driver
from companion.autopilots.px4 import Px4Driver
from companion.landing.memory import StepMemory
from companion.landing.outputs import has_free_place, setpoint
from companion.landing.step_data import LinkDelay, StepInputs
from companion.landing.virtual_model import Tracking
from companion.planning.guidance import ReferenceState
from companion.runtime.response_models import response_to
from companion.situation.phases import Phase
from link.records import replace
from tests.companion.facts import CONFIG, NOW_NS, PAD_ENU_M, changed, situation
from tests.companion.world import configured

LIMITS = CONFIG.limits.flight_limits()
JITTER_S = 0.04
RESPONSE = response_to(Px4Driver().cascade({"MPC_XY_P": 1.3}))
SITUATION = situation()


def _memory(phase: Phase, speed_m_s: float = 8.0) -> StepMemory:
    """The drone is 0.3 m behind the virtual model."""
    return changed(
        StepMemory(),
        phase=phase,
        reference=ReferenceState(
            position_enu_m=PAD_ENU_M,
            velocity_enu_m_s=np.array([0.6, -0.8, 0.0]) * speed_m_s,
            acceleration_enu_m_s2=np.zeros(3),
        ),
        reference_ns=NOW_NS,
        tracking=Tracking(behind_enu_m=np.array([0.3, 0.0, 0.1])),
    )


def _inputs(std_s: float, driver: Driver | None = None) -> StepInputs:
    driver = Px4Driver() if driver is None else driver
    return StepInputs(
        t_ns=NOW_NS,
        monotonic_ns=NOW_NS,
        limits=LIMITS,
        response=RESPONSE,
        driver=driver,
        link_delay=LinkDelay(mean_s=0.1, std_s=std_s),
    )


@pytest.mark.parametrize(
    ("phase", "speed_m_s", "std_s", "is_free"),
    [
        (Phase.DESCEND, 8.0, JITTER_S, True),
        (Phase.ALIGN, 8.0, JITTER_S, True),
        (Phase.TOUCHDOWN, 8.0, JITTER_S, True),
        (Phase.CHASE, 8.0, JITTER_S, False),
        (Phase.ABORT, 8.0, JITTER_S, False),
        (Phase.DESCEND, 2.0, JITTER_S, False),
        (Phase.DESCEND, 25.0, 0.002, False),
        (Phase.DESCEND, 25.0, 0.005, True),
    ],
)
def test_place_is_free_where_jitter_would_move_it_by_a_tenth_of_a_metre(
    phase: Phase, speed_m_s: float, std_s: float, *, is_free: bool
) -> None:
    assert has_free_place(_memory(phase, speed_m_s), _inputs(std_s), CONFIG) is is_free


def test_place_is_held_for_an_autopilot_that_takes_it_as_a_whole_and_where_nothing_but_it_is_sent() -> None:
    memory = _memory(Phase.DESCEND)
    assert not has_free_place(memory, _inputs(JITTER_S, ArduPilotDriver()), CONFIG)
    assert not has_free_place(memory, replace(_inputs(JITTER_S), driver=None), CONFIG)
    position_only = configured({"setpoints": {"position_only": True}})
    assert not has_free_place(memory, _inputs(JITTER_S), position_only)


def test_drone_behind_its_free_place_is_asked_to_fly_faster_and_one_with_a_held_place_is_not() -> None:
    free, held = (setpoint(_memory(Phase.DESCEND), _inputs(std_s), SITUATION, CONFIG) for std_s in (JITTER_S, 0.0))
    assert free is not None
    assert held is not None
    assert (free.is_place_free, held.is_place_free) == (True, False)
    assert held.velocity_enu_m_s == pytest.approx((4.8, -6.4, 0.0))
    assert free.velocity_enu_m_s == pytest.approx((4.8 + 0.3 * 1.3, -6.4, 0.0))
    assert free.position_enu_m[2] == held.position_enu_m[2]
