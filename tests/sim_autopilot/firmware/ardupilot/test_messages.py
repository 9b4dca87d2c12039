from dataclasses import replace
from math import atan2, degrees, isfinite

import pytest

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.firmware.ardupilot.ardupilot import ARDUPILOT
from sim_autopilot.firmware.ardupilot.messages import wind
from sim_autopilot.memory import World
from tests.sim_autopilot.copter import ardupilot, copter_in_the_air, every
from tests.sim_autopilot.pilot import Pilot, command


def one(pilot: Pilot, name: str) -> Message:
    pilot.acknowledged(command(mavlink.MAV_CMD_REQUEST_MESSAGE, getattr(mavlink, f"MAVLINK_MSG_ID_{name}")))
    return pilot.last(name)


def test_a_data_stream_of_everything_brings_what_ground_stations_show() -> None:
    pilot = copter_in_the_air()
    pilot.received.clear()
    pilot.step(mavlink.MAVLink_request_data_stream_message(1, 1, mavlink.MAV_DATA_STREAM_ALL, 4, 1))
    pilot.run(2.0)
    names = {message.get_type() for _, message in pilot.received}
    assert names >= {"EKF_STATUS_REPORT", "AHRS2", "WIND", "MEMINFO", "VFR_HUD", "RC_CHANNELS", "NAV_CONTROLLER_OUTPUT"}
    assert len(pilot.all("AHRS2")) == pytest.approx(8, abs=1)
    assert all(isfinite(v) for m in pilot.all("NAV_CONTROLLER_OUTPUT") for v in (m.nav_roll, m.alt_error))


def test_every_message_of_the_table_can_be_asked_for_in_flight() -> None:
    pilot = copter_in_the_air()
    for message_id in ARDUPILOT.streams.messages:
        if message_id != mavlink.MAVLINK_MSG_ID_TIMESYNC:
            one(pilot, mavlink.mavlink_map[message_id].msgname)


def test_the_estimator_tells_when_it_knows_where_it_is() -> None:
    pilot = Pilot(ardupilot(instant=False))
    pilot.step(every(mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT, 1.0))
    assert not one(pilot, "EKF_STATUS_REPORT").flags & mavlink.EKF_POS_HORIZ_ABS
    assert one(Pilot(ardupilot()), "EKF_STATUS_REPORT").flags & mavlink.EKF_POS_HORIZ_ABS


def test_wind_is_told_by_where_it_comes_from() -> None:
    memory = replace(Pilot(ardupilot()).node.memory, world=World(wind_enu_m_s=(3.0, 4.0, 0.0)))
    told = wind(memory, ardupilot())
    assert told.speed == pytest.approx(5.0)
    assert told.direction == pytest.approx(180.0 + degrees(atan2(3.0, 4.0)))


def test_the_summary_for_satellites_says_what_the_other_messages_say() -> None:
    pilot = copter_in_the_air()
    summary, beat, place = one(pilot, "HIGH_LATENCY2"), pilot.last("HEARTBEAT"), one(pilot, "GLOBAL_POSITION_INT")
    assert (summary.type, summary.autopilot, summary.custom_mode) == (beat.type, beat.autopilot, beat.custom_mode)
    assert summary.custom0 % 256 == beat.base_mode
    assert (summary.latitude, summary.longitude) == pytest.approx((place.lat, place.lon), abs=2)
    assert summary.altitude == pytest.approx(place.alt / 1000.0, abs=0.6)
    assert summary.heading * 2 == pytest.approx(place.hdg / 100.0, abs=1.1)
    assert summary.battery > 95


def test_the_simulations_truth_is_told_whole_and_short_alike() -> None:
    pilot = copter_in_the_air()
    whole, short = one(pilot, "SIM_STATE"), one(pilot, "SIMSTATE")
    assert (whole.roll, whole.pitch, whole.yaw) == pytest.approx((short.roll, short.pitch, short.yaw), abs=1e-3)
    assert (whole.lat_int, whole.lon_int) == pytest.approx((short.lat, short.lng), abs=2)
    assert whole.alt == pytest.approx(pilot.position[2] + 89.0, abs=0.1)


def test_the_motors_tell_how_fast_they_turn_only_while_they_do() -> None:
    assert set(one(Pilot(ardupilot()), "ESC_TELEMETRY_1_TO_4").rpm) == {0}
    speeds = one(copter_in_the_air(), "ESC_TELEMETRY_1_TO_4").rpm
    assert min(speeds) > 1000
    assert max(speeds) / min(speeds) < 1.2


def test_the_battery_tells_the_current_that_empties_its_capacity_in_its_endurance() -> None:
    assert one(Pilot(ardupilot()), "BATTERY_STATUS").current_battery == 0
    pilot = copter_in_the_air(ardupilot(endurance_s=600.0))
    battery = one(pilot, "BATTERY_STATUS")
    assert battery.current_battery == pytest.approx(100.0 * 3.3 * 3600.0 / 600.0, abs=1)  # BATT_CAPACITY 3300 mAh
    before_s = pilot.t_s
    pilot.run(20.0)
    given_mah = one(pilot, "BATTERY_STATUS").current_consumed - battery.current_consumed
    assert given_mah == pytest.approx(19.8 * (pilot.t_s - before_s) / 3.6, abs=2)
    assert one(pilot, "SYS_STATUS").current_battery == battery.current_battery
