"""What ground stations ask of either firmware now and then: version, banner, stored parameters, outputs, orbits."""

from math import nan

import pytest

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.interfaces import AutopilotConfig
from tests.sim_autopilot.clients import Clients, beat
from tests.sim_autopilot.copter import ardupilot, copter_in_the_air
from tests.sim_autopilot.pilot import DATUM, TAKEOFF, Pilot, arm, command, px4

ACCEPTED, REJECTED, DENIED, UNSUPPORTED = 0, 1, 2, 3
EXTRA1, ALL = mavlink.MAV_DATA_STREAM_EXTRA1, mavlink.MAV_DATA_STREAM_ALL


def _stream(group: int, rate_hz: int, start: int = 1) -> Message:
    return mavlink.MAVLink_request_data_stream_message(1, 1, group, rate_hz, start)


def _set(name: bytes, value: float, kind: int = mavlink.MAV_PARAM_TYPE_REAL32) -> Message:
    return mavlink.MAVLink_param_set_message(1, 1, name, value, kind)


def _actuator_test(function: float) -> Message:
    return command(mavlink.MAV_CMD_ACTUATOR_TEST, 0.2, 1.0, 0.0, 0.0, function)


def _rates(clients: Clients, names: tuple[str, ...]) -> list[float]:
    return [clients.node.memory.tuning.values[name] for name in names]


def test_the_older_message_that_asks_for_the_version_is_answered_by_ardupilot_only() -> None:
    question = mavlink.MAVLink_autopilot_version_request_message(1, 1)
    answers = [
        [m.flight_sw_version for m in pilot.step(question) if m.get_type() == "AUTOPILOT_VERSION"]
        for pilot in (Pilot(ardupilot()), Pilot())
    ]
    assert answers == [[0x04_06_00_00], []]


def test_the_banner_is_told_to_who_asks_for_it_only() -> None:
    clients = Clients(ardupilot())
    clients.send(0, beat())
    clients.send(1, command(mavlink.MAV_CMD_DO_SEND_BANNER))
    clients.run(0.02)
    texts = [[text.text for text in clients.of(link, "STATUSTEXT")] for link in (0, 1)]
    assert texts[0] == []
    assert texts[1] == list(ardupilot().firmware.parameters.banner)


def test_a_request_for_a_group_sets_its_rate_parameter_of_that_link() -> None:
    clients = Clients(ardupilot())
    names = ("SR0_EXTRA1", "SR1_EXTRA1", "SR1_POSITION")
    clients.send(1, _stream(EXTRA1, 7))
    clients.run(0.02)
    assert _rates(clients, names) == [0.0, 7.0, 0.0]
    clients.send(0, _stream(ALL, 3), _stream(EXTRA1, 9, start=2))
    clients.send(1, _stream(EXTRA1, 7, start=0))
    clients.run(0.02)
    assert _rates(clients, names) == [3.0, 0.0, 0.0]


def test_a_reset_of_px4s_parameters_acts_at_once_and_not_while_armed() -> None:
    pilot = Pilot()
    pilot.step(_set(b"MPC_XY_CRUISE", 7.5))
    before = pilot.node.memory.tuning.values["MPC_XY_CRUISE"]
    storage = mavlink.MAV_CMD_PREFLIGHT_STORAGE
    assert pilot.acknowledged(command(storage, 1.0)) == [ACCEPTED]
    pilot.step(arm())
    assert pilot.acknowledged(command(storage, 2.0)) == [REJECTED]
    assert (before, pilot.node.memory.tuning.values["MPC_XY_CRUISE"]) == (7.5, 7.5)
    pilot.step(arm(armed=False, force=True))
    assert pilot.acknowledged(command(storage, 2.0)) == [ACCEPTED]
    assert pilot.node.memory.tuning.values["MPC_XY_CRUISE"] == 5.0


@pytest.mark.parametrize(
    ("function", "result"), [(1.0, ACCEPTED), (12.0, ACCEPTED), (13.0, 3), (33.0, ACCEPTED), (41.0, 3), (1101.0, 0)]
)
def test_px4_tests_the_motors_and_servos_that_there_can_be(function: float, result: int) -> None:
    assert Pilot().acknowledged(_actuator_test(function)) == [result]


def test_no_actuator_is_tested_while_armed_or_where_a_parameter_forbids_it_or_by_ardupilot() -> None:
    armed, forbidden = Pilot(), Pilot(px4(parameters={"COM_MOT_TEST_EN": 0.0}))
    armed.step(arm())
    results = [pilot.acknowledged(_actuator_test(1.0)) for pilot in (armed, forbidden, Pilot(ardupilot()))]
    assert results == [[DENIED], [DENIED], [UNSUPPORTED]]


def test_an_orbit_is_told_five_times_a_second_while_it_is_flown() -> None:
    pilot = Pilot()
    pilot.take_off()
    assert pilot.all("ORBIT_EXECUTION_STATUS") == []
    pilot.step(command(mavlink.MAV_CMD_DO_ORBIT, -12.0, 3.0, 0.0, 0.0, nan, nan, DATUM.altitude_m + 6.0))
    pilot.run(2.0)
    told = pilot.all("ORBIT_EXECUTION_STATUS")
    assert len(told) == pytest.approx(10, abs=1)
    assert (told[-1].radius, told[-1].frame) == (-12.0, mavlink.MAV_FRAME_GLOBAL)
    assert abs(told[-1].x * 1e-7 - 52.4733) < 1e-5
    assert DATUM.altitude_m + 4.9 < told[-1].z < DATUM.altitude_m + 6.1


@pytest.mark.parametrize("armed_first", [False, True])
def test_px4_takes_off_to_the_height_asked_for_whether_before_arming_or_after(*, armed_first: bool) -> None:
    pilot = Pilot()
    rise = command(mavlink.MAV_CMD_NAV_TAKEOFF, 0.0, 0.0, 0.0, nan, nan, nan, DATUM.altitude_m + 6.0)
    for message in (arm(), rise) if armed_first else (rise, arm()):
        pilot.step(message)
    assert pilot.custom_mode() == TAKEOFF
    pilot.run(12.0)
    assert pilot.position[2] == pytest.approx(6.0, abs=0.4)


@pytest.mark.parametrize("config", [px4(), ardupilot()])
def test_a_parameter_changed_on_one_link_is_told_once_on_each(config: AutopilotConfig) -> None:
    clients = Clients(config)
    name = b"MPC_XY_CRUISE" if config.firmware.name == "px4" else b"WPNAV_SPEED_UP"
    clients.send(0, beat())
    clients.send(1, _set(name, 4.0))
    clients.run(0.05)
    told = [[v.param_id for v in clients.of(link, "PARAM_VALUE")] for link in (0, 1)]
    assert told == [[name.decode()], [name.decode()]]


@pytest.mark.parametrize("config", [px4(instant=False), ardupilot(instant=False)])
def test_a_ground_station_reads_why_a_companions_arming_is_refused_on_another_link(config: AutopilotConfig) -> None:
    clients = Clients(config)
    clients.send(0, beat())
    clients.run(0.05)
    clients.forget()
    clients.send(1, arm())
    clients.run(0.05)
    assert [clients.counts(link)["COMMAND_ACK"] for link in (0, 1)] == [0, 1]
    assert clients.counts(0)["STATUSTEXT"] > 0


def test_the_event_of_a_refusal_is_told_on_every_link_of_px4() -> None:
    clients = Clients(px4(instant=False), links=3)
    clients.send(1, arm())
    clients.run(0.05)
    assert [len([m for m in heard if m.get_msgId() == 410]) for heard in clients.heard] == [1, 1, 1]


def test_a_single_item_does_not_reach_another_system() -> None:
    pilot = copter_in_the_air()
    elsewhere = mavlink.MAVLink_mission_item_int_message(
        9, 1, 0, 6, mavlink.MAV_CMD_NAV_WAYPOINT, 2, 0, 0.0, 0.0, 0.0, 0.0, 524_740_000, 134_020_000, 8.0, 0
    )
    assert [m for m in pilot.step(elsewhere) if m.get_type() == "MISSION_ACK"] == []
