import pytest

from link.mavlink.dialect import mavlink
from tests.sim_autopilot.copter import (
    ALT_HOLD,
    AUTO,
    AVOID,
    BRAKE,
    DRIFT,
    GUIDED,
    LAND,
    LOITER,
    NO_GPS,
    POSHOLD,
    RTL,
    SMART_RTL,
    STABILIZE,
    THROW,
    ZIGZAG,
    ardupilot,
    copter_in_the_air,
    every,
    heartbeat,
    mode,
)
from tests.sim_autopilot.pilot import Pilot, arm, command

ACCEPTED, DENIED, UNSUPPORTED, FAILED = 0, 2, 3, 4
ODOMETRY, LOCAL_POSITION, QUATERNION = 331, 32, 31


def texts(pilot: Pilot) -> list[str]:
    return [message.text for message in pilot.all("STATUSTEXT")]


def booted(duration_s: float) -> Pilot:
    pilot = Pilot(ardupilot(instant=False))
    pilot.step(mavlink.MAVLink_heartbeat_message(18, 8, 0, 0, 4, 3))
    pilot.run(duration_s)
    return pilot


def test_it_streams_nothing_unasked_but_the_heartbeat() -> None:
    pilot = Pilot(ardupilot(instant=False))
    pilot.run(5.0)
    assert {message.get_type() for _, message in pilot.received} == {"HEARTBEAT"}
    assert len(pilot.all("HEARTBEAT")) == pytest.approx(5, abs=1)


def test_texts_and_timesync_begin_with_the_first_contact() -> None:
    pilot = booted(11.0)
    assert "ArduPilot Ready" in texts(pilot)
    assert pilot.all("TIMESYNC")


def test_the_heartbeat_says_type_2_autopilot_3_and_stabilize_at_boot() -> None:
    pilot = Pilot(ardupilot())
    assert heartbeat(pilot) == (81, STABILIZE, 3)
    beat = pilot.last("HEARTBEAT")
    assert (beat.type, beat.autopilot) == (2, 3)


def test_the_heartbeat_is_89_4_3_in_guided_and_217_4_3_armed_on_the_ground() -> None:
    pilot = Pilot(ardupilot())
    pilot.step(mode(GUIDED))
    assert heartbeat(pilot) == (89, GUIDED, 3)
    pilot.step(arm())
    assert heartbeat(pilot) == (217, GUIDED, 3)


def test_every_mode_number_is_acknowledged_once_and_reported() -> None:
    pilot = Pilot(ardupilot())
    for number in (ALT_HOLD, GUIDED, LOITER, RTL, LAND, DRIFT, POSHOLD, BRAKE, THROW, AVOID, NO_GPS, SMART_RTL, ZIGZAG):
        assert pilot.acknowledged(mode(number)) == [ACCEPTED]
        assert heartbeat(pilot)[1] == number


def test_a_mode_that_there_is_not_fails() -> None:
    pilot = Pilot(ardupilot())
    assert pilot.acknowledged(mode(99)) == [FAILED]
    assert heartbeat(pilot)[1] == STABILIZE


def test_auto_without_a_mission_waits_for_one_on_the_ground_and_fails_in_flight() -> None:
    pilot = Pilot(ardupilot())
    assert pilot.acknowledged(mode(AUTO)) == [ACCEPTED]
    assert heartbeat(pilot)[1] == AUTO
    assert copter_in_the_air().acknowledged(mode(AUTO)) == [FAILED]


def test_a_change_of_mode_is_told_by_a_heartbeat_at_once() -> None:
    pilot = Pilot(ardupilot())
    pilot.run(0.5)
    before = len(pilot.all("HEARTBEAT"))
    pilot.step(mode(GUIDED))
    told = pilot.all("HEARTBEAT")
    assert (len(told) - before, told[-1].custom_mode) == (1, GUIDED)


def test_the_number_of_px4s_offboard_means_rtl() -> None:
    pilot = Pilot(ardupilot())
    assert pilot.acknowledged(mode(6)) == [ACCEPTED]
    assert heartbeat(pilot)[1] == RTL


@pytest.mark.slow
def test_readiness_comes_in_the_measured_order() -> None:
    pilot = booted(2.0)
    asked = (mavlink.MAVLINK_MSG_ID_GPS_RAW_INT, LOCAL_POSITION)
    pilot.step(*(every(message_id, 10.0) for message_id in asked))
    pilot.run(40.5)

    def first(name: str, **fields: int) -> float:
        return next(
            t_s
            for t_s, message in pilot.received
            if message.get_type() == name and all(getattr(message, field) == value for field, value in fields.items())
        )

    assert first("GPS_RAW_INT", fix_type=6) == pytest.approx(10.0, abs=0.2)
    assert first("GPS_GLOBAL_ORIGIN") == pytest.approx(20.0, abs=0.1)
    assert first("HOME_POSITION") == pytest.approx(20.0, abs=0.1)
    assert first("LOCAL_POSITION_NED") == pytest.approx(41.4, abs=0.2)
    pilot.step(mode(GUIDED))
    assert pilot.acknowledged(arm()) == [ACCEPTED]


@pytest.mark.parametrize(
    ("at_s", "text"),
    [(5.0, "Arm: Gyros inconsistent"), (15.0, "Arm: AHRS: waiting for home"), (30.0, "Arm: Need Position Estimate")],
)
@pytest.mark.slow
def test_arming_too_early_fails_and_says_why(at_s: float, text: str) -> None:
    pilot = booted(at_s)
    assert pilot.acknowledged(arm()) == [FAILED]
    assert texts(pilot)[-1] == text


@pytest.mark.parametrize("number", [LAND, RTL, BRAKE])
def test_it_does_not_arm_in_a_mode_that_flies_by_itself(number: int) -> None:
    pilot = Pilot(ardupilot())
    pilot.step(mode(number))
    assert pilot.acknowledged(arm()) == [FAILED]
    assert texts(pilot)[-1].endswith("mode not armable")


def test_armed_and_idle_it_disarms_after_10_seconds_and_says_so() -> None:
    pilot = Pilot(ardupilot())
    pilot.step(mode(GUIDED), arm())
    assert pilot.run_until(lambda: not pilot.is_armed(), 12.0) == pytest.approx(10.0, abs=0.1)
    assert texts(pilot) == ["Arming motors", "Disarming motors"]


@pytest.mark.parametrize(("message_id", "hz"), [(LOCAL_POSITION, 50.0), (QUATERNION, 100.0)])
def test_set_message_interval_gives_the_exact_rate(message_id: int, hz: float) -> None:
    pilot = Pilot(ardupilot())
    assert pilot.acknowledged(every(message_id, hz)) == [ACCEPTED]
    before = len(pilot.received)
    pilot.run(2.0)
    name = "LOCAL_POSITION_NED" if message_id == LOCAL_POSITION else "ATTITUDE_QUATERNION"
    assert sum(message.get_type() == name for _, message in pilot.received[before:]) == pytest.approx(2.0 * hz, abs=1)


def test_odometry_is_denied_and_an_unknown_message_fails() -> None:
    pilot = Pilot(ardupilot())
    assert pilot.acknowledged(every(ODOMETRY, 10.0)) == [DENIED]
    assert pilot.acknowledged(command(mavlink.MAV_CMD_REQUEST_MESSAGE, 9999.0)) == [FAILED]


def test_nothing_follows_an_accepted_request_for_the_origin_before_there_is_one() -> None:
    pilot = booted(2.0)
    assert pilot.acknowledged(command(mavlink.MAV_CMD_REQUEST_MESSAGE, 49.0)) == [ACCEPTED]
    assert not pilot.all("GPS_GLOBAL_ORIGIN")


def test_request_data_stream_starts_and_stops_a_group() -> None:
    pilot = Pilot(ardupilot())
    pilot.step(mavlink.MAVLink_request_data_stream_message(1, 1, mavlink.MAV_DATA_STREAM_EXTRA1, 10, 1))
    pilot.run(1.0)
    started = len(pilot.all("ATTITUDE"))
    pilot.step(mavlink.MAVLink_request_data_stream_message(1, 1, mavlink.MAV_DATA_STREAM_EXTRA1, 10, 0))
    stopped = len(pilot.all("ATTITUDE"))
    pilot.run(1.0)
    assert started == pytest.approx(10, abs=1)
    assert len(pilot.all("ATTITUDE")) == stopped


def test_commands_for_another_component_are_answered() -> None:
    pilot = Pilot(ardupilot())
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, float(GUIDED), component=42)) == [ACCEPTED]


def test_failure_injection_is_unsupported() -> None:
    assert Pilot(ardupilot()).acknowledged(command(mavlink.MAV_CMD_INJECT_FAILURE, 0.0, 1.0)) == [UNSUPPORTED]
