from math import degrees, pi, radians

import numpy as np
import pymap3d
import pytest
from scipy.spatial.transform import Rotation

from link.frames.geodesy import LocalFrame, Projection, local_from_geodetic
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.modes import Mode
from sim_autopilot.core.places import chart_at, geodetic, near
from sim_autopilot.firmware.px4.px4 import PX4
from sim_autopilot.plant.own_state import OwnStateModel
from sim_autopilot.runtime.node import AutopilotNode
from tests.sim_autopilot.pilot import DATUM, START_NS, STILL_AIR, Pilot, command, px4, setpoint

NED_FROM_ENU = np.array(((0.0, 1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0)))
FRD_FROM_FLU = np.diag((1.0, -1.0, -1.0))


@pytest.fixture(scope="module")
def flying() -> Pilot:
    """A drone in a fast turn, with every message asked for at the last instant."""
    pilot = Pilot(px4(yaw_rad=0.4))
    pilot.take_off(8.0)
    pilot.run(1.0, lambda _t: setpoint((30.0, -17.0, -6.0), yaw=2.1))
    for message_id in PX4.streams.messages:
        pilot.step(command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, float(message_id), 10_000.0))
    pilot.run(0.1, lambda _t: setpoint((30.0, -17.0, -6.0), yaw=2.1))
    return pilot


def ned(pilot: Pilot) -> tuple[np.ndarray, np.ndarray]:
    state = pilot.node.state
    return NED_FROM_ENU @ state.position_enu_m, NED_FROM_ENU @ state.velocity_enu_m_s


def attitude(pilot: Pilot) -> Rotation:
    """Rotation from FRD to NED, by matrices."""
    w, x, y, z = pilot.node.state.orientation_wxyz
    return Rotation.from_matrix(NED_FROM_ENU @ Rotation.from_quat((x, y, z, w)).as_matrix() @ FRD_FROM_FLU.T)


@pytest.mark.slow
def test_local_position_is_the_true_place_on_px4s_sphere_and_velocity_the_truth_in_ned(flying: Pilot) -> None:
    message, (_, velocity) = flying.last("LOCAL_POSITION_NED"), ned(flying)
    datum_deg = (degrees(DATUM.latitude_rad), degrees(DATUM.longitude_rad), DATUM.altitude_m)
    latitude_deg, longitude_deg, altitude_m = map(float, pymap3d.enu2geodetic(*flying.position, *datum_deg))
    frame = LocalFrame(origin=DATUM, projection=Projection.PX4)
    place = local_from_geodetic(frame, radians(latitude_deg), radians(longitude_deg), altitude_m)
    assert np.allclose((message.x, message.y, message.z), NED_FROM_ENU @ place, atol=1e-4)
    assert np.allclose((message.vx, message.vy, message.vz), velocity, atol=1e-5)
    assert message.time_boot_ms == round(flying.t_s * 1000)


def test_attitude_agrees_with_scipy(flying: Pilot) -> None:
    yaw, pitch, roll = attitude(flying).as_euler("ZYX")
    message = flying.last("ATTITUDE")
    assert abs(pitch) + abs(roll) > 0.1
    assert np.allclose((message.roll, message.pitch, message.yaw), (roll, pitch, yaw), atol=1e-5)
    rates = FRD_FROM_FLU @ flying.node.state.angular_velocity_flu_rad_s
    assert np.allclose((message.rollspeed, message.pitchspeed, message.yawspeed), rates, atol=1e-5)


def test_the_quaternion_is_the_same_rotation(flying: Pilot) -> None:
    message = flying.last("ATTITUDE_QUATERNION")
    sent = Rotation.from_quat((message.q2, message.q3, message.q4, message.q1))
    assert (sent * attitude(flying).inv()).magnitude() < 1e-5
    assert flying.last("ODOMETRY").q == pytest.approx([message.q1, message.q2, message.q3, message.q4])


def test_global_position_agrees_with_pymap3d(flying: Pilot) -> None:
    message, (_, velocity) = flying.last("GLOBAL_POSITION_INT"), ned(flying)
    datum = (degrees(DATUM.latitude_rad), degrees(DATUM.longitude_rad), DATUM.altitude_m)
    latitude, longitude, altitude = pymap3d.enu2geodetic(*flying.position, *datum)
    assert message.lat == pytest.approx(latitude * 1e7, abs=1.0)
    assert message.lon == pytest.approx(longitude * 1e7, abs=1.0)
    assert message.alt == pytest.approx(altitude * 1e3, abs=1.5)
    assert message.relative_alt == pytest.approx(1e3 * (flying.position[2] - 0.12), abs=5.0)
    assert np.allclose((message.vx, message.vy, message.vz), 100.0 * velocity, atol=0.6)
    raw = flying.last("GPS_RAW_INT")
    assert (raw.fix_type, raw.lat, raw.lon) == (3, message.lat, message.lon)


@pytest.mark.parametrize(
    ("accuracy_m", "fix", "h_acc_mm"), [(None, 3, 900), (0.02, 6, 20), (0.1, 5, 100), (1.2, 3, 1200)]
)
def test_receiver_states_the_accuracy_that_it_is_given(accuracy_m: float | None, fix: int, h_acc_mm: int) -> None:
    pilot = Pilot(px4(own_state=OwnStateModel(receiver_accuracy_m=accuracy_m)))
    pilot.step(command(mavlink.MAV_CMD_REQUEST_MESSAGE, float(mavlink.MAVLINK_MSG_ID_GPS_RAW_INT)))
    raw = pilot.last("GPS_RAW_INT")
    assert (raw.fix_type, raw.h_acc) == (fix, h_acc_mm)


def test_the_chart_follows_the_drone_and_stays_exact() -> None:
    chart = chart_at(DATUM, (0.0, 0.0, 0.0))
    datum = (DATUM.latitude_rad, DATUM.longitude_rad, DATUM.altitude_m)
    for step in range(200):
        position = (7.0 * step, -11.0 * step, 3.0 + 0.1 * step)
        chart = near(chart, position)
        there = pymap3d.geodetic2enu(*geodetic(chart, position), *datum, deg=False)
        assert np.allclose(there, position, atol=1e-3)


def test_the_origin_and_home_are_where_it_started(flying: Pilot) -> None:
    origin, home = flying.last("GPS_GLOBAL_ORIGIN"), flying.last("HOME_POSITION")
    assert origin.latitude == round(degrees(DATUM.latitude_rad) * 1e7)
    assert origin.altitude == 89_000
    assert (home.latitude, home.longitude) == (origin.latitude, origin.longitude)
    assert home.z == pytest.approx(-0.12, abs=0.01)


def test_the_heading_is_clockwise_from_north() -> None:
    pilot = Pilot(px4(yaw_rad=-0.3))
    pilot.run(0.3)
    assert pilot.last("VFR_HUD").heading == round(degrees(pi / 2.0 + 0.3))
    assert pilot.last("GLOBAL_POSITION_INT").hdg == pytest.approx(100.0 * degrees(pi / 2.0 + 0.3), abs=1.0)


def test_the_accelerometer_at_rest_feels_the_ground_push() -> None:
    pilot = Pilot()
    pilot.run(3.0)
    message = pilot.last("HIGHRES_IMU")
    assert np.allclose((message.xacc, message.yacc, message.zacc), (0.0, 0.0, -9.81), atol=0.05)


def test_position_target_tells_what_is_followed(flying: Pilot) -> None:
    message = flying.last("POSITION_TARGET_LOCAL_NED")
    assert (message.x, message.y, message.z) == pytest.approx((30.0, -17.0, -6.0))
    assert message.yaw == pytest.approx(2.1)
    assert message.type_mask == 0b1001_1111_1000


@pytest.mark.parametrize(
    ("mode", "base_mode", "custom_mode"),
    [
        (Mode.HOLD, 29, 50593792),  # both read off a recording of PX4
        (Mode.OFFBOARD, 17, 393216),
        (Mode.LAND, 29, 0x06040000),
        (Mode.TAKEOFF, 29, 0x02040000),
        (Mode.RTL, 29, 0x05040000),
        (Mode.POSITION, 81, 0x00030000),
    ],
)
def test_a_modes_codes_are_px4s(mode: Mode, base_mode: int, custom_mode: int) -> None:
    assert (PX4.modes.codes[mode].base_mode, PX4.modes.codes[mode].custom_mode) == (base_mode, custom_mode)


def test_the_heartbeat_is_a_px4_quadrotors() -> None:
    pilot = Pilot()
    pilot.run(0.1)
    message = pilot.last("HEARTBEAT")
    assert (message.type, message.autopilot, message.base_mode, message.system_status) == (2, 12, 29, 3)
    assert (message.get_srcSystem(), message.get_srcComponent()) == (1, 1)


def test_the_battery_drains_while_the_motors_run() -> None:
    pilot = Pilot(px4(endurance_s=20.0))
    pilot.run(1.0)
    full = pilot.last("SYS_STATUS").battery_remaining
    pilot.take_off(3.0)
    pilot.run(1.0, lambda _t: setpoint((0.0, 0.0, -3.0)))
    assert full == 100
    assert 40 < pilot.last("SYS_STATUS").battery_remaining < 80
    assert pilot.last("SYS_STATUS").voltage_battery < 16_000


def test_messages_wait_for_the_boot_and_the_origin_is_told_once() -> None:
    pilot = Pilot(px4(instant=False))
    pilot.run(6.0)

    def first_s(name: str) -> float:
        return next(t_s for t_s, message in pilot.received if message.get_type() == name)

    assert first_s("LOCAL_POSITION_NED") < 0.1
    assert first_s("ATTITUDE") == pytest.approx(1.8, abs=0.02)
    assert first_s("GLOBAL_POSITION_INT") == pytest.approx(2.9, abs=0.03)
    assert len(pilot.all("GPS_GLOBAL_ORIGIN")) == 1


def test_system_time_ties_the_boot_clock_to_utc() -> None:
    pilot = Pilot()
    pilot.run(2.1)
    message = pilot.last("SYSTEM_TIME")
    assert message.time_unix_usec * 1000 - message.time_boot_ms * 1_000_000 == START_NS


def timesync(tc1: int, ts1: int) -> bytes:
    return MavlinkCodec(1, 191).encode(mavlink.MAVLink_timesync_message(tc1, ts1))


def answers(node: AutopilotNode, data: bytes, t_ns: int) -> list[Message]:
    return MavlinkCodec(1, 191).decode(node.receive(data, t_ns)[0])


def test_a_question_for_the_time_is_answered_at_once_with_the_boot_clock() -> None:
    node = AutopilotNode(px4(), START_NS)
    node.step(None, STILL_AIR)
    (answer,) = answers(node, timesync(0, 123_456_789), START_NS + 17_300_000)
    assert (answer.tc1, answer.ts1) == (17_300_000, 123_456_789)
