"""What the table of PX4's parameters says beside the firmware's own defaults."""

import pytest

from sim_autopilot.control.geometric import geometric_gains
from sim_autopilot.firmware.px4.px4 import PX4
from sim_autopilot.plant.config import OBSERVER_POLE_RAD_S


def test_stated_gains_are_those_of_the_controller_that_flies() -> None:
    stated = {one.name: one.default for one in PX4.parameters.table}
    flown = geometric_gains()
    assert stated["MPC_XY_P"] == pytest.approx(flown.position[0] / flown.velocity[0], rel=1e-3)
    assert stated["MPC_XY_VEL_P_ACC"] == pytest.approx(flown.velocity[0], rel=1e-3)
    # as the observer of ArduPilot's stand-in takes the place of an integrator
    assert stated["MPC_XY_VEL_I_ACC"] == pytest.approx(0.5 * OBSERVER_POLE_RAD_S * flown.velocity[0], rel=3e-3)
