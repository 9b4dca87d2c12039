from collections.abc import Callable

import numpy as np
import pytest

from link.frames.geodesy import enu_from_geodetic
from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.plant.own_state import OwnStateModel
from sim_autopilot.telemetry.sensors import hil_state_quaternion, pressure_hpa
from tests.sim_autopilot.copter import ardupilot
from tests.sim_autopilot.pilot import DATUM, Pilot, command, px4


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


@pytest.mark.parametrize(
    ("plugged_in", "message_id", "axes"),
    [
        (px4, mavlink.MAVLINK_MSG_ID_HIL_STATE_QUATERNION, ("lat", "lon")),
        (ardupilot, mavlink.MAVLINK_MSG_ID_SIM_STATE, ("lat", "lon")),
        (ardupilot, mavlink.MAVLINK_MSG_ID_SIMSTATE, ("lat", "lng")),
    ],
)
def test_a_simulations_truth_is_not_what_its_autopilot_believes(
    plugged_in: Callable[..., AutopilotConfig], message_id: int, axes: tuple[str, str]
) -> None:
    pilot = Pilot(plugged_in(own_state=OwnStateModel(seed=3, position_std_m=2.0, velocity_std_m_s=0.5)))
    pilot.run(0.1)
    told = requested(pilot, message_id).to_dict()
    latitude, longitude = (np.radians(1e-7 * told.get(f"{axis}_int", told.get(axis))) for axis in axes)
    place = enu_from_geodetic(DATUM, latitude, longitude, DATUM.altitude_m)
    assert place[:2] == pytest.approx((0.0, 0.0), abs=0.02)
    assert np.hypot(*pilot.node.memory.now.position_enu_m[:2]) > 0.5
    assert told.get("vx", told.get("vn", 0.0)) == pytest.approx(0.0, abs=0.01)


def test_a_drone_on_the_ground_feels_the_wind_as_airspeed() -> None:
    pilot = Pilot()
    pilot.step()
    memory = pilot.node.memory
    windy = replace(memory, world=replace(memory.world, wind_enu_m_s=(3.0, -4.0, 0.0)))
    told = hil_state_quaternion(windy, px4())
    assert (told.true_airspeed, told.ind_airspeed) == (500, 500)
