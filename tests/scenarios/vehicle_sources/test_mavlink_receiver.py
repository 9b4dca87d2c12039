"""An autopilot's receiver read: the fields of GPS_RAW_INT, stamps by SYSTEM_TIME, and what is missing."""

from math import cos, degrees, pi, radians, sin
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.frames.rotations import yaw_of
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.messages import Fix, FixVelocity, VehicleImu
from scenarios.vehicle_sources.mavlink import MavlinkReceiver
from scenarios.vehicle_sources.receiver import Reading

BOOT_UTC_NS = 1_794_225_600_000_000_000
HEARTBEAT = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GROUND_ROVER, 3, 0, 0, 4, 3)


def gps(boot_s: float = 100.0, **changes: Any) -> Message:
    fields: dict[str, Any] = {
        "time_usec": round(boot_s * 1e6),
        "fix_type": mavlink.GPS_FIX_TYPE_RTK_FIXED,
        "lat": 472_852_332,
        "lon": -85_652_650,
        "alt": 499_600,
        "eph": 80,
        "epv": 120,
        "vel": 500,
        "cog": 7752,
        "satellites_visible": 17,
        "alt_ellipsoid": 547_600,
        "h_acc": 14,
        "v_acc": 20,
        "vel_acc": 50,
        "hdg_acc": 0,
        "yaw": 0,
    }
    return mavlink.MAVLink_gps_raw_int_message(**(fields | changes))


class Rover:
    """An autopilot that has been heard, with a receiver listening to it."""

    def __init__(self) -> None:
        self.receiver = MavlinkReceiver()
        self._codec = MavlinkCodec(7, 1)

    def says(self, *messages: Message, t_ns: int = 10**9) -> list[Reading]:
        return self.receiver.take(b"".join(self._codec.encode(message) for message in messages), t_ns)


def rover_with_time() -> Rover:
    rover = Rover()
    system_time = mavlink.MAVLink_system_time_message((BOOT_UTC_NS + 99 * 10**9) // 1000, 99_000)
    assert rover.says(HEARTBEAT, system_time, t_ns=0) == []
    return rover


def test_gps_raw_int_tells_place_velocity_and_the_receivers_accuracy() -> None:
    fix, velocity = rover_with_time().says(gps())
    assert isinstance(fix, Fix)
    assert fix.t_ns == BOOT_UTC_NS + 100 * 10**9
    assert (degrees(fix.latitude_rad), degrees(fix.longitude_rad)) == pytest.approx((47.2852332, -8.565265))
    assert fix.altitude_m == 547.6
    assert fix.covariance_enu_m2 == pytest.approx((0.014**2, 0, 0, 0, 0.014**2, 0, 0, 0, 0.02**2))
    assert isinstance(velocity, FixVelocity)
    assert velocity.velocity_enu_m_s == pytest.approx((5.0 * sin(radians(77.52)), 5.0 * cos(radians(77.52)), 0.0))
    assert velocity.velocity_covariance_enu_m2_s2 is not None
    assert velocity.velocity_covariance_enu_m2_s2[0] == pytest.approx(0.05**2)
    assert not velocity.is_vertical_measured


def test_accuracy_that_is_not_stated_is_unknown() -> None:
    fix, velocity = rover_with_time().says(gps(h_acc=0, v_acc=0, vel_acc=0))
    assert isinstance(fix, Fix)
    assert isinstance(velocity, FixVelocity)
    assert (fix.covariance_enu_m2, velocity.velocity_covariance_enu_m2_s2) == (None, None)


def test_a_stamp_that_is_utc_already_needs_no_system_time() -> None:
    rover = Rover()
    rover.says(HEARTBEAT)
    assert rover.says(gps(time_usec=BOOT_UTC_NS // 1000))[0].t_ns == BOOT_UTC_NS


def test_a_double_antenna_goes_before_the_autopilots_attitude() -> None:
    rover = rover_with_time()
    level_north = mavlink.MAVLink_attitude_quaternion_message(100_020, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -0.2)
    assert rover.says(level_north) == []  # not before there is a place
    rover.says(gps())
    (attitude,) = rover.says(level_north)
    assert isinstance(attitude, VehicleImu)
    assert attitude.t_ns == BOOT_UTC_NS + 100_020_000_000
    assert attitude.orientation_wxyz is not None
    assert yaw_of(attitude.orientation_wxyz) == pytest.approx(pi / 2)
    assert attitude.angular_velocity_flu_rad_s == pytest.approx((0.0, 0.0, 0.2))
    *_, measured = rover.says(gps(100.2, yaw=36_000, hdg_acc=50_000))
    assert isinstance(measured, VehicleImu)
    assert measured.orientation_covariance_rad2 is not None
    assert measured.orientation_covariance_rad2[8] == pytest.approx(radians(0.5) ** 2)
    assert rover.says(level_north) == []


def test_an_instant_sent_twice_is_told_once() -> None:
    rover = rover_with_time()
    assert len(rover.says(gps(), gps())) == 2


def test_an_instant_sent_twice_is_told_once_though_the_clock_was_set_forward_in_between() -> None:
    rover = rover_with_time()
    assert len(rover.says(gps())) == 2
    set_forward = mavlink.MAVLink_system_time_message((BOOT_UTC_NS + 99 * 10**9 + 3 * 10**6) // 1000, 99_000)
    again = rover.says(set_forward, gps())
    later = rover.says(gps(100.2))
    assert later[0].t_ns > BOOT_UTC_NS + 100_200_000_000
    assert again == []


@pytest.mark.parametrize(
    ("messages", "words"),
    [
        ([], "heartbeat"),
        ([HEARTBEAT], "GPS_RAW_INT"),
        ([HEARTBEAT, gps(fix_type=mavlink.GPS_FIX_TYPE_2D_FIX)], "no fix"),
        ([HEARTBEAT, gps(alt_ellipsoid=0)], "alt_ellipsoid"),
        ([HEARTBEAT, gps()], "SYSTEM_TIME"),
    ],
)
def test_what_makes_no_fix_is_said(messages: list[Message], words: str) -> None:
    rover = Rover()
    assert rover.says(*messages) == []
    assert rover.receiver.complaint is not None
    assert words in rover.receiver.complaint


def test_streams_are_asked_for_once_the_autopilot_is_heard() -> None:
    rover = Rover()
    rover.says(HEARTBEAT)
    asked = [
        message.param1
        for message in MavlinkCodec(9, 9).decode(rover.receiver.to_send(1))
        if message.get_type() == "COMMAND_LONG"
    ]
    assert mavlink.MAVLINK_MSG_ID_GPS_RAW_INT in asked


@given(st.binary(max_size=300))
def test_no_bytes_whatever_make_it_raise(data: bytes) -> None:
    rover = rover_with_time()
    rover.receiver.take(data, 1)
    assert isinstance(rover.receiver.counts["bad"], int)
