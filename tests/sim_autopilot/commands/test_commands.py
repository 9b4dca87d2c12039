from math import nan

import pytest

from link.mavlink.dialect import Message, mavlink
from link.mavlink.event_ids import event_id
from sim_autopilot.core.modes import Mode
from sim_autopilot.firmware.px4.px4 import PX4
from tests.sim_autopilot.pilot import (
    HOLD,
    LAND,
    OFFBOARD,
    POSITION,
    RTL,
    Pilot,
    arm,
    command,
    px4,
    set_mode,
    setpoint,
)

ACCEPTED, REJECTED, DENIED, UNSUPPORTED, FAILED = 0, 1, 2, 3, 4
SET_INTERVAL = mavlink.MAV_CMD_SET_MESSAGE_INTERVAL
REQUEST = mavlink.MAV_CMD_REQUEST_MESSAGE


def rate_hz(pilot: Pilot, name: str, duration_s: float = 4.0) -> float:
    pilot.received.clear()
    pilot.run(duration_s)
    return len(pilot.all(name)) / duration_s


def setpoints_for(pilot: Pilot, duration_s: float) -> None:
    pilot.run(duration_s, lambda _t: setpoint((0.0, 0.0, 5.0)))


def test_an_unknown_command_is_unsupported() -> None:
    assert Pilot().acknowledged(command(mavlink.MAV_CMD_DO_FOLLOW)) == [UNSUPPORTED]


def test_commands_about_what_it_has_not_are_answered_as_px4_does() -> None:
    pilot = Pilot()
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_ROI_LOCATION)) == [ACCEPTED]
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_WINCH)) == []


@pytest.mark.parametrize(("system", "component"), [(2, 1), (255, 1), (0, 1), (1, 2), (1, 191)])
def test_a_command_for_somebody_else_is_not_even_answered(system: int, component: int) -> None:
    pilot = Pilot()
    message = command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, system=system, component=component)
    assert pilot.acknowledged(message) == []
    assert not pilot.is_armed()


def test_an_answer_names_who_asked() -> None:
    pilot = Pilot()
    pilot.acknowledged(arm())
    answer = pilot.last("COMMAND_ACK")
    assert (answer.command, answer.target_system, answer.target_component) == (400, 1, 191)


def test_a_command_as_integers_does_the_same() -> None:
    pilot = Pilot()
    message = mavlink.MAVLink_command_int_message(1, 1, 0, 400, 0, 0, 1.0, 0.0, 0.0, 0.0, 0, 0, 0.0)
    assert pilot.acknowledged(message) == [ACCEPTED]
    assert pilot.is_armed()


@pytest.mark.parametrize(("main", "sub", "mode"), [(3, 0, POSITION), (4, 3, HOLD), (4, 5, RTL), (4, 6, LAND)])
def test_a_mode_is_answered_twice_and_entered(main: int, sub: int, mode: int) -> None:
    pilot = Pilot()
    first = [m.result for m in pilot.step(set_mode(main, sub)) if m.get_type() == "COMMAND_ACK"]
    second = [m.result for m in pilot.step() if m.get_type() == "COMMAND_ACK"]
    assert (first, second) == ([ACCEPTED], [ACCEPTED])
    assert pilot.custom_mode() == mode


def test_offboard_without_setpoints_is_accepted_first_and_refused_after() -> None:
    pilot = Pilot()
    pilot.step(arm())
    assert pilot.acknowledged(set_mode(6)) == [ACCEPTED, REJECTED]
    assert pilot.custom_mode() == HOLD


def test_disarmed_every_mode_can_be_chosen_but_offboard_does_not_arm_without_setpoints() -> None:
    pilot = Pilot()
    for code in PX4.modes.codes.values():
        assert pilot.acknowledged(set_mode(*code.request)) == [ACCEPTED, ACCEPTED]
        assert pilot.custom_mode() == code.custom_mode
    pilot.acknowledged(set_mode(6))
    assert pilot.acknowledged(arm()) == [REJECTED]


@pytest.mark.parametrize(
    ("flags", "mode"),
    [
        (mavlink.MAV_MODE_MANUAL_ARMED, Mode.MANUAL),
        (mavlink.MAV_MODE_STABILIZE_ARMED, Mode.STABILIZED),
        (mavlink.MAV_MODE_GUIDED_DISARMED, Mode.POSITION),
        (mavlink.MAV_MODE_AUTO_DISARMED, Mode.MISSION),
    ],
)
def test_a_client_without_custom_modes_asks_by_flags(flags: int, mode: Mode) -> None:
    pilot = Pilot()
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_MODE, float(flags))) == [ACCEPTED, ACCEPTED]
    assert pilot.custom_mode() == PX4.modes.codes[mode].custom_mode


def test_offboard_is_entered_after_three_tenths_of_a_second_of_setpoints() -> None:
    pilot = Pilot()
    setpoints_for(pilot, 0.3)
    assert pilot.acknowledged(set_mode(6)) == [ACCEPTED, ACCEPTED]
    assert pilot.custom_mode() == OFFBOARD


def test_one_fresh_setpoint_is_enough_for_offboard() -> None:
    pilot = Pilot()
    pilot.step(setpoint((0.0, 0.0, -5.0)))
    assert pilot.acknowledged(set_mode(6)) == [ACCEPTED, ACCEPTED]


def test_offboard_is_refused_once_the_setpoints_are_stale() -> None:
    pilot = Pilot()
    pilot.step(arm())
    setpoints_for(pilot, 0.5)
    pilot.run(1.1)
    assert pilot.acknowledged(set_mode(6)) == [ACCEPTED, REJECTED]


def test_an_unknown_mode_is_accepted_and_nothing_happens() -> None:
    pilot = Pilot()
    assert pilot.acknowledged(set_mode(9, 9)) == [ACCEPTED]
    assert pilot.custom_mode() == HOLD


def test_it_arms_from_three_and_a_half_seconds_after_boot_on() -> None:
    pilot = Pilot(px4(instant=False))
    pilot.run(2.0)
    assert pilot.acknowledged(arm()) == [REJECTED]
    assert pilot.last("HEARTBEAT").system_status == mavlink.MAV_STATE_UNINIT
    assert not pilot.last("SYS_STATUS").onboard_control_sensors_health & 0x10000000
    pilot.run(2.5)
    assert pilot.last("HEARTBEAT").system_status == mavlink.MAV_STATE_STANDBY
    assert pilot.last("SYS_STATUS").onboard_control_sensors_health & 0x10000000
    assert pilot.acknowledged(arm()) == [ACCEPTED]


@pytest.mark.parametrize("sub", [5, 6])
def test_it_does_not_arm_in_the_mode_that_a_landing_leaves(sub: int) -> None:
    pilot = Pilot()
    pilot.acknowledged(set_mode(4, sub))
    assert pilot.acknowledged(arm()) == [REJECTED]
    pilot.acknowledged(set_mode(4, 3))
    assert pilot.acknowledged(arm()) == [ACCEPTED]


def test_it_does_not_arm_in_offboard_without_setpoints() -> None:
    pilot = Pilot()
    setpoints_for(pilot, 0.5)
    pilot.acknowledged(set_mode(6))
    pilot.run(1.5)
    assert pilot.acknowledged(arm()) == [REJECTED]


def test_arming_by_force_skips_the_checks() -> None:
    pilot = Pilot(px4(instant=False))
    assert pilot.acknowledged(arm(force=True)) == [ACCEPTED]
    assert pilot.is_armed()


@pytest.mark.parametrize("number", [2.0, -1.0, nan])
def test_an_arming_command_that_says_neither_is_not_answered_but_in_words(number: float) -> None:
    pilot = Pilot()
    pilot.step(mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3))
    assert pilot.acknowledged(command(400, number)) == []
    assert pilot.last("STATUSTEXT").text == f"Unsupported ARM_DISARM param: {number:.3f}\t"
    assert not pilot.is_armed()


def test_it_disarms_on_the_ground() -> None:
    pilot = Pilot()
    pilot.acknowledged(arm())
    assert pilot.acknowledged(arm(armed=False)) == [ACCEPTED]
    assert not pilot.is_armed()


def test_the_heartbeat_stays_at_one_hertz_whatever_is_asked_for() -> None:
    pilot = Pilot()
    heartbeat = mavlink.MAVLINK_MSG_ID_HEARTBEAT
    assert pilot.acknowledged(command(SET_INTERVAL, heartbeat, 50_000.0)) == [4]
    pilot.received.clear()
    pilot.run(5.0)
    assert len(pilot.all("HEARTBEAT")) == 5


def test_a_takeoff_while_disarmed_is_accepted_and_begins_with_arming() -> None:
    pilot = Pilot()
    assert pilot.acknowledged(command(mavlink.MAV_CMD_NAV_TAKEOFF, *(nan,) * 7)) == [ACCEPTED]
    pilot.run(5.0)
    assert pilot.position[2] < 0.13
    assert pilot.acknowledged(arm()) == [ACCEPTED]
    pilot.run_until(lambda: pilot.custom_mode() == HOLD, 10.0)
    pilot.run(2.0)
    assert pilot.position[2] == pytest.approx(2.5, abs=0.2)  # MIS_TAKEOFF_ALT


@pytest.mark.parametrize("wanted_hz", [1.0, 7.0, 20.0, 30.0, 50.0, 100.0])
def test_a_message_comes_at_the_rate_that_was_asked_for(wanted_hz: float) -> None:
    pilot = Pilot()
    message_id = mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED
    assert pilot.acknowledged(command(SET_INTERVAL, message_id, round(1e6 / wanted_hz))) == [ACCEPTED]
    assert rate_hz(pilot, "LOCAL_POSITION_NED") == pytest.approx(wanted_hz, abs=0.25)


def test_a_message_stops_and_comes_back_at_its_default_rate() -> None:
    pilot, attitude = Pilot(), float(mavlink.MAVLINK_MSG_ID_ATTITUDE)
    pilot.acknowledged(command(SET_INTERVAL, attitude, -1.0))
    assert rate_hz(pilot, "ATTITUDE") == 0.0
    pilot.acknowledged(command(SET_INTERVAL, attitude, 0.0))
    assert rate_hz(pilot, "ATTITUDE") == pytest.approx(100.0, abs=0.25)


@pytest.mark.parametrize(
    ("name", "expected_hz"),
    [
        ("HEARTBEAT", 1.0),
        ("ATTITUDE", 100.0),
        ("ATTITUDE_QUATERNION", 50.0),
        ("GLOBAL_POSITION_INT", 50.0),
        ("HIGHRES_IMU", 50.0),
        ("LOCAL_POSITION_NED", 30.0),
        ("ODOMETRY", 30.0),
        ("DISTANCE_SENSOR", 10.0),
        ("VFR_HUD", 10.0),
        ("TIMESYNC", 10.0),
        ("EXTENDED_SYS_STATE", 5.0),
        ("SYS_STATUS", 5.0),
        ("SYSTEM_TIME", 1.0),
        ("CURRENT_MODE", 0.5),
    ],
)
def test_a_default_rate_is_px4s(name: str, expected_hz: float) -> None:
    pilot = Pilot()
    pilot.run(1.0)
    assert rate_hz(pilot, name, 10.0) == pytest.approx(expected_hz, abs=0.11)


@pytest.mark.parametrize("parameters", [(9999.0, 1e5), (nan, 1e5), (32.0, nan), (32.0, -7.0)])
def test_an_interval_that_cannot_be_fails(parameters: tuple[float, float]) -> None:
    assert Pilot().acknowledged(command(SET_INTERVAL, *parameters)) == [FAILED]


def test_the_interval_can_be_asked_for() -> None:
    pilot = Pilot()
    assert pilot.acknowledged(command(mavlink.MAV_CMD_GET_MESSAGE_INTERVAL, 30.0)) == [ACCEPTED]
    answer = pilot.last("MESSAGE_INTERVAL")
    assert (answer.message_id, answer.interval_us) == (30, 10_000)


@pytest.mark.parametrize("message_id", sorted(PX4.streams.messages.keys() - {mavlink.MAVLINK_MSG_ID_RC_CHANNELS}))
def test_every_message_it_knows_can_be_requested(message_id: int) -> None:
    pilot = Pilot()
    pilot.take_off(1.0)
    pilot.received.clear()
    assert pilot.acknowledged(command(REQUEST, float(message_id))) == [ACCEPTED]
    assert message_id in {message.get_msgId() for _, message in pilot.received}


@pytest.mark.parametrize("kind", [mavlink.MAVLINK_MSG_ID_ADSB_VEHICLE, mavlink.MAVLINK_MSG_ID_SCALED_IMU2])
def test_a_rate_is_taken_for_a_message_without_its_hardware_and_a_request_is_denied(kind: int) -> None:
    pilot = Pilot()
    assert pilot.acknowledged(command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, float(kind), 1e5)) == [ACCEPTED]
    assert pilot.acknowledged(command(mavlink.MAV_CMD_REQUEST_MESSAGE, float(kind))) == [mavlink.MAV_RESULT_DENIED]
    pilot.run(1.0)
    assert not any(message.get_msgId() == kind for _, message in pilot.received)


def test_a_request_for_a_message_it_does_not_know_is_denied() -> None:
    assert Pilot().acknowledged(command(REQUEST, 12345.0)) == [DENIED]


def test_it_says_why_it_does_not_arm_only_where_a_ground_station_listens() -> None:
    def refused(pilot: Pilot) -> list[Message]:
        pilot.acknowledged(arm())
        return pilot.all("STATUSTEXT")

    deaf, heard = Pilot(px4(instant=False)), Pilot(px4(instant=False))
    heard.step(mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3))
    assert not refused(deaf)
    pieces = refused(heard)
    assert "".join(text.text for text in pieces) == "Arming denied: Resolve system health failures first\t"
    assert [(text.id, text.chunk_seq) for text in pieces] == [(1, 0), (1, 1)]


def test_a_companion_is_told_by_event_why_it_does_not_arm() -> None:
    pilot = Pilot(px4(instant=False))
    pilot.acknowledged(arm())
    pilot.acknowledged(arm())
    told = pilot.all("EVENT")
    assert [event.id for event in told] == [event_id("commander_arm_denied_resolve_failures")] * 2
    assert [event.sequence for event in told] == [0, 1]
    assert {event.log_levels & 0x0F for event in told} == {mavlink.MAV_SEVERITY_CRITICAL}


def test_modes_are_listed_all_or_one_by_one() -> None:
    pilot = Pilot()
    assert pilot.acknowledged(command(REQUEST, 435.0, 0.0)) == [ACCEPTED]
    listed = pilot.all("AVAILABLE_MODES")
    assert [mode.mode_index for mode in listed] == list(range(1, listed[0].number_modes + 1))
    assert {mode.custom_mode for mode in listed} == {code.custom_mode for code in PX4.modes.codes.values()}
    pilot.received.clear()
    assert pilot.acknowledged(command(REQUEST, 435.0, 3.0)) == [ACCEPTED]
    assert [mode.standard_mode for mode in pilot.all("AVAILABLE_MODES")] == [mavlink.MAV_STANDARD_MODE_POSITION_HOLD]
    assert pilot.acknowledged(command(REQUEST, 435.0, 99.0)) == [DENIED]


def test_a_manual_mode_arms_only_with_sticks() -> None:
    pilot = Pilot()
    pilot.acknowledged(set_mode(3))
    assert pilot.acknowledged(arm()) == [mavlink.MAV_RESULT_TEMPORARILY_REJECTED]
    pilot.step(mavlink.MAVLink_manual_control_message(1, 0, 0, 500, 0, 0))
    assert pilot.acknowledged(arm()) == [ACCEPTED]
