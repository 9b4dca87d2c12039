"""What is simulated with ArduPilot flies with the parameters that `companion check` advises."""

import pytest

from companion.check.findings import Level
from companion.check.firmwares import FIRMWARES
from companion.check.rules import judge, names_of
from companion.config.companion import CompanionConfig
from link.mavlink.dialect import mavlink
from scenarios.catalogue.catalogue import load_scenario
from scenarios.config import Scenario
from scenarios.worlds.world import draw_world
from sim_autopilot.firmware.ardupilot.parameters import OBEYED

SPEED_M_S = 10.0
RULES = FIRMWARES[mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA].rules_for(CompanionConfig().descent.sink.rate_max_m_s)


@pytest.mark.parametrize("scenario", [load_scenario("straight_10"), draw_world("world", 10_007).scenario])
def test_simulated_ardupilot_has_the_advised_parameters(scenario: Scenario) -> None:
    defaults = {parameter.name: float(parameter.default) for parameter in OBEYED}
    parameters = defaults | scenario.system.parameters["ardupilot"]
    told = [one for one in judge(RULES, parameters, SPEED_M_S) if one.name in parameters]
    assert len(told) == len(set(names_of(RULES)) & set(parameters)) >= 10
    assert [(one.name, one.found) for one in told if one.level is not Level.PASS] == []
