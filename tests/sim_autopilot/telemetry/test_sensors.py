import numpy as np
import pytest

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.telemetry.sensors import pressure_hpa
from tests.sim_autopilot.pilot import Pilot, command


def requested(pilot: Pilot, message_id: int) -> Message:
    pilot.acknowledged(command(mavlink.MAV_CMD_REQUEST_MESSAGE, float(message_id)))
    return next(m for _, m in reversed(pilot.received) if m.get_msgId() == message_id)


@pytest.mark.parametrize(
    ("altitude_m", "expected_hpa"), [(0.0, 1013.25), (500.0, 954.61), (2000.0, 794.95), (5000.0, 540.20)]
)
def test_the_pressure_is_that_of_the_standard_atmosphere(altitude_m: float, expected_hpa: float) -> None:
    assert pressure_hpa(altitude_m) == pytest.approx(expected_hpa, abs=0.05)  # ICAO Doc 7488, table 1


def test_a_drone_at_rest_feels_its_weight_and_the_field_down() -> None:
    pilot = Pilot()
    pilot.run(0.5)
    imu = requested(pilot, mavlink.MAVLINK_MSG_ID_SCALED_IMU)
    assert (imu.xacc, imu.yacc, imu.zacc) == pytest.approx((0, 0, -1000), abs=3)
    assert np.hypot(imu.xmag, imu.ymag) == pytest.approx(190.0, abs=2.0)
    assert imu.zmag == pytest.approx(450, abs=2)


@pytest.mark.slow
def test_altitude_tells_heights_above_sea_origin_home_and_ground() -> None:
    pilot = Pilot()
    pilot.take_off(6.0)
    told = requested(pilot, mavlink.MAVLINK_MSG_ID_ALTITUDE)
    assert told.altitude_amsl == pytest.approx(95.0, abs=0.2)
    assert told.altitude_local == pytest.approx(6.0, abs=0.2)
    assert told.altitude_relative == pytest.approx(6.0 - 0.12, abs=0.2)
    assert told.altitude_local - told.bottom_clearance == pytest.approx(told.altitude_terrain, abs=0.01)


def test_rc_channels_tell_what_the_pilot_holds() -> None:
    pilot = Pilot()
    pilot.run(0.1)
    assert not pilot.all("RC_CHANNELS")
    pilot.step(mavlink.MAVLink_manual_control_message(1, 400, -200, 500, 1000, 0))
    pilot.run(0.1)
    told = pilot.last("RC_CHANNELS")
    assert (told.chan1_raw, told.chan2_raw, told.chan3_raw, told.chan4_raw) == (1400, 1300, 1500, 2000)
    assert (told.chancount, told.chan9_raw) == (8, 65535)
