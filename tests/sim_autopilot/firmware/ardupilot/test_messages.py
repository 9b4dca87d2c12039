from math import atan2, degrees, isfinite

import pytest

from link.mavlink.dialect import Message, mavlink
from link.records import replace
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


@pytest.mark.slow
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
