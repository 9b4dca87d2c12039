"""A vehicle whose clock was never set, or that was switched off long ago, holds no step up: it is forgotten."""

import pytest

from companion.config.companion import CompanionConfig
from tests.companion.peer import Setup
from tests.companion.world import PAD_HEIGHT_M

NOW_S = 1.7e9
"""Since a stamp of 0: predicted over in steps of 0.1 s, a step of the companion would take hours."""
PLACE = (5.0, 0.4, PAD_HEIGHT_M)


def _told_of_a_fix(late_s: float) -> Setup:
    setup = Setup()
    setup.run(1.0)
    setup.fix(late_s=late_s)
    setup.run(0.1)
    return setup


@pytest.mark.parametrize("late_s", [CompanionConfig().estimator.buffer.forget_after_s + 1.0, 1e6, NOW_S])
def test_fix_of_long_ago_places_no_vehicle_and_the_next_one_does(late_s: float) -> None:
    setup = _told_of_a_fix(late_s)
    assert setup.node.vehicle_estimate(setup.utc_ns) is None
    setup.fix(PLACE)
    setup.run(0.1)
    found = setup.node.vehicle_estimate(setup.utc_ns)
    assert found is not None
    assert found.position_enu_m == pytest.approx(PLACE, abs=0.1)


def test_utc_that_leaps_ahead_forgets_the_vehicle_and_keeps_the_steps_going() -> None:
    setup = _told_of_a_fix(0.1)
    setup.autopilot.utc_set_by_ns = round(3e8 * 1e9)
    setup.run(4.0)
    assert setup.node.vehicle_estimate(setup.utc_ns) is None
    assert setup.node.outputs is not None
    assert setup.node.outputs.status.stamp_ns == pytest.approx(setup.utc_ns, abs=1e9)
