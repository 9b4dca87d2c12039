from math import nan

import pytest

from link.mavlink.dialect import event_id, mavlink
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


@pytest.mark.slow
def test_an_unknown_command_is_unsupported() -> None:
    assert Pilot().acknowledged(command(mavlink.MAV_CMD_DO_FOLLOW)) == [UNSUPPORTED]


@pytest.mark.parametrize(("system", "component"), [(2, 1), (255, 1), (0, 1), (1, 2), (1, 191)])
def test_a_command_for_somebody_else_is_not_even_answered(system: int, component: int) -> None:
    pilot = Pilot()
    message = command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, system=system, component=component)
    assert pilot.acknowledged(message) == []
    assert not pilot.is_armed()


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


def test_arming_by_force_skips_the_checks() -> None:
    pilot = Pilot(px4(instant=False))
    assert pilot.acknowledged(arm(force=True)) == [ACCEPTED]
    assert pilot.is_armed()


def test_the_heartbeat_stays_at_one_hertz_whatever_is_asked_for() -> None:
    pilot = Pilot()
    heartbeat = mavlink.MAVLINK_MSG_ID_HEARTBEAT
    assert pilot.acknowledged(command(SET_INTERVAL, heartbeat, 50_000.0)) == [4]
    pilot.received.clear()
    pilot.run(5.0)
    assert len(pilot.all("HEARTBEAT")) == 5


@pytest.mark.slow
def test_a_takeoff_while_disarmed_is_accepted_and_begins_with_arming() -> None:
    pilot = Pilot()
    assert pilot.acknowledged(command(mavlink.MAV_CMD_NAV_TAKEOFF, *(nan,) * 7)) == [ACCEPTED]
    pilot.run(5.0)
    assert pilot.position[2] < 0.13
    assert pilot.acknowledged(arm()) == [ACCEPTED]
    pilot.run_until(lambda: pilot.custom_mode() == HOLD, 10.0)
    pilot.run(2.0)
    assert pilot.position[2] == pytest.approx(2.5, abs=0.2)  # MIS_TAKEOFF_ALT


def test_a_message_stops_and_comes_back_at_its_default_rate() -> None:
    pilot, attitude = Pilot(), float(mavlink.MAVLINK_MSG_ID_ATTITUDE)
    pilot.acknowledged(command(SET_INTERVAL, attitude, -1.0))
    assert rate_hz(pilot, "ATTITUDE") == 0.0
    pilot.acknowledged(command(SET_INTERVAL, attitude, 0.0))
    assert rate_hz(pilot, "ATTITUDE") == pytest.approx(100.0, abs=0.25)


def test_a_default_rate_is_px4s() -> None:
    pilot = Pilot()
    pilot.run(1.0)
    assert rate_hz(pilot, "LOCAL_POSITION_NED") == pytest.approx(30.0, abs=0.25)
    assert len(pilot.all("ATTITUDE_QUATERNION")) == pytest.approx(200, abs=1)
    assert len(pilot.all("EXTENDED_SYS_STATE")) == pytest.approx(20, abs=1)


@pytest.mark.parametrize("parameters", [(9999.0, 1e5), (nan, 1e5), (32.0, nan), (32.0, -7.0)])
def test_an_interval_that_cannot_be_fails(parameters: tuple[float, float]) -> None:
    assert Pilot().acknowledged(command(SET_INTERVAL, *parameters)) == [FAILED]


@pytest.mark.slow
def test_every_message_it_knows_can_be_requested() -> None:
    pilot = Pilot()
    pilot.take_off(1.0)
    told_later = {mavlink.MAVLINK_MSG_ID_RC_CHANNELS, mavlink.MAVLINK_MSG_ID_ORBIT_EXECUTION_STATUS}  # sticks, a circle
    for message_id in PX4.streams.messages.keys() - told_later:
        pilot.received.clear()
        assert pilot.acknowledged(command(REQUEST, float(message_id))) == [ACCEPTED]
        assert message_id in {message.get_msgId() for _, message in pilot.received}


def test_a_request_for_a_message_it_does_not_know_is_denied() -> None:
    assert Pilot().acknowledged(command(REQUEST, 12345.0)) == [DENIED]


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
