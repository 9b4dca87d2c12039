"""Commands about the autopilot itself that PX4 obeys: tests of its outputs, and its stored parameters.

Source: PX4's Commander::handleCommandActuatorTest, its handling of MAV_CMD_PREFLIGHT_STORAGE, and WorkerThread.
"""

from link.mavlink.dialect import mavlink
from link.records import replace
from sim_autopilot.boot import tune
from sim_autopilot.commands.requests import ACCEPTED, DENIED, UNSUPPORTED, Answer, Request
from sim_autopilot.core.parameters import default_values
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotMemory

_REJECTED = int(mavlink.MAV_RESULT_TEMPORARILY_REJECTED)
_ALLOWS_TESTS = "COM_MOT_TEST_EN"
_MOTORS, _SERVOS = range(1, 13), range(33, 41)
"""ACTUATOR_OUTPUT_FUNCTION."""
_INTERNAL = 1000
"""From here on a function is PX4's own number, and is not checked."""
_LOAD, _SAVE, _RESET, _RESET_SENSORS, _RESET_ALL = range(5)
_OUTLIVES_A_RESET = ("LND_FLIGHT_T_HI", "LND_FLIGHT_T_LO", "COM_FLIGHT_UUID")


def actuator_test(memory: AutopilotMemory, request: Request, _config: AutopilotConfig) -> Answer:
    """Accept the test of a motor or a servo on the ground; nothing turns here."""
    if memory.armed_ns is not None or memory.tuning.values[_ALLOWS_TESTS] != 1.0:
        return Answer(memory=memory, result=DENIED)
    output = request.number(5)
    known = output is not None and (output in _MOTORS or output in _SERVOS or output >= _INTERNAL)
    return Answer(memory=memory, result=ACCEPTED if known else UNSUPPORTED)


def store_parameters(memory: AutopilotMemory, request: Request, config: AutopilotConfig) -> Answer:
    """Reset the parameters at once, or load or save them, which changes nothing here: they are always stored."""
    if memory.armed_ns is not None:
        return Answer(memory=memory, result=_REJECTED)
    wanted = request.number(1)
    if wanted in {_LOAD, _SAVE, _RESET_SENSORS}:
        return Answer(memory=memory, result=ACCEPTED)
    if wanted not in {_RESET, _RESET_ALL}:
        return Answer(memory=memory, result=None)
    parameters = config.firmware.parameters
    values = default_values(parameters.table, {parameters.system_id: config.system_id, **config.parameters})
    if wanted == _RESET:
        values = {**values, **{name: memory.tuning.values[name] for name in _OUTLIVES_A_RESET if name in values}}
    return Answer(memory=replace(memory, tuning=tune(config, values)), result=ACCEPTED)
