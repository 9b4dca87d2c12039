"""The flight without the services: it knows none of them, and answers as an autopilot that has none."""

import ast
from pathlib import Path

from link.mavlink.dialect import mavlink
from sim_autopilot.interfaces import NO_SERVICES
from sim_autopilot.runtime.build import autopilot_config
from sim_autopilot.runtime.config import SimAutopilotConfig
from tests.sim_autopilot.pilot import Pilot, command, px4

PACKAGE = Path(__file__).parents[3] / "sim_autopilot"
SERVICES = "sim_autopilot.ground_station"
PLUGGED_IN_BY = {"runtime/build.py"}


def imported(path: Path) -> set[str]:
    """The modules that a file imports from."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return {node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}


def without_services() -> Pilot:
    return Pilot(px4(services=NO_SERVICES))


def test_nothing_of_the_flight_imports_the_services_but_the_configuration_that_plugs_them_in() -> None:
    flight = [path for path in PACKAGE.rglob("*.py") if "ground_station" not in path.parts]
    users = {
        path.relative_to(PACKAGE).as_posix()
        for path in flight
        if any(module.startswith(SERVICES) for module in imported(path))
    }
    assert users == PLUGGED_IN_BY


def test_the_configuration_leaves_the_services_out() -> None:
    assert autopilot_config(SimAutopilotConfig(core=True)).services is NO_SERVICES
    assert autopilot_config(SimAutopilotConfig()).services is not NO_SERVICES


def test_without_services_their_commands_are_unsupported() -> None:
    pilot = without_services()
    for number in (mavlink.MAV_CMD_PREFLIGHT_CALIBRATION, mavlink.MAV_CMD_DO_GRIPPER, mavlink.MAV_CMD_LOGGING_START):
        assert pilot.acknowledged(command(number)) == [mavlink.MAV_RESULT_UNSUPPORTED]


def test_without_services_plans_logs_and_files_get_no_answer() -> None:
    pilot = without_services()
    questions = (
        mavlink.MAVLink_mission_request_list_message(1, 1, 0),
        mavlink.MAVLink_log_request_list_message(1, 1, 0, 65535),
        mavlink.MAVLink_file_transfer_protocol_message(0, 1, 1, [0] * 251),
    )
    pilot.step(*questions)
    pilot.run(0.1)
    assert not any(pilot.all(name) for name in ("MISSION_COUNT", "LOG_ENTRY", "FILE_TRANSFER_PROTOCOL"))


def test_it_flies_without_services() -> None:
    pilot = without_services()
    pilot.take_off(4.0)
    assert pilot.is_armed()
    assert abs(pilot.position[2] - 4.0) < 0.2
