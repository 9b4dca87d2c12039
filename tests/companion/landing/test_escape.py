"""An abort just above the roof turns the virtual model at once; one that has room keeps it."""

import numpy as np
import pytest

from companion.config.companion import CompanionConfig
from companion.landing.state.memory import StepMemory
from companion.landing.state.step_data import StepInputs
from companion.landing.transitions import take_events
from companion.situation.phases import Phase
from link.messages import Command
from link.records import replace
from tests.companion.facts import FLIES, NOW_NS, changed, drone_at, pad_at, reference_at, situation

CONFIG = CompanionConfig()
LIMITS = CONFIG.limits.flight_limits()
SINK_M_S = 0.45
AHEAD_M_S = 0.1  # the model sinks faster than the drone that follows it


def broken_off(height_m: float, roof_m_s: float) -> tuple[StepMemory, StepMemory]:
    """Return the memory before and after an abort of a drone that sinks towards a roof that moves by `roof_m_s`."""
    pad = pad_at((4.0, 1.0, roof_m_s))
    drone = drone_at(height_m, 0.0, (0.0, 0.0, -SINK_M_S), pad=pad)
    facts = replace(situation(height_m, pad=pad), drone=drone, limits=LIMITS)
    ahead = np.array([0.0, 0.0, -AHEAD_M_S])
    reference = replace(reference_at(height_m), velocity_enu_m_s=drone.velocity_enu_m_s + ahead)
    before = changed(
        StepMemory(), phase=Phase.DESCEND, reference=reference, reference_ns=NOW_NS, was_in_control=True, was_armed=True
    )
    inputs = StepInputs(t_ns=NOW_NS, monotonic_ns=NOW_NS, autopilot=FLIES, limits=LIMITS, command=Command.ABORT)
    after, _ = take_events(before, facts, inputs, CONFIG)
    assert after.progress.phase is Phase.ABORT
    return before, after


@pytest.mark.parametrize("roof_m_s", [0.0, 0.3, -0.2])
def test_abort_near_the_roof_sinks_no_further_towards_it(roof_m_s: float) -> None:
    before, after = broken_off(0.9 * CONFIG.descent.wait.height_m, roof_m_s)
    assert before.model.reference is not None
    assert after.model.reference is not None
    assert after.model.reference.velocity_enu_m_s[2] == pytest.approx(roof_m_s)
    assert after.model.reference.acceleration_enu_m_s2[2] == LIMITS.vertical_acceleration_max_m_s2
    np.testing.assert_array_equal(
        after.model.reference.velocity_enu_m_s[:2], before.model.reference.velocity_enu_m_s[:2]
    )
    np.testing.assert_array_equal(after.model.reference.position_enu_m, before.model.reference.position_enu_m)


def test_abort_higher_up_goes_on_from_the_plan() -> None:
    before, after = broken_off(1.1 * CONFIG.descent.wait.height_m, 0.0)
    assert after.model.reference is before.model.reference
