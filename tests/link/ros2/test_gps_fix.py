"""A GPSFix in an independent encoding, as our own fix and velocity."""

from math import nan, radians

import pytest

from link.payloads.checks import PayloadError
from link.ros2.gps_fix import GPS_FIX, fix_of_gps, register, velocity_of_gps
from link.ros2.routes import routes
from link.ros2.topic_map import TopicMap
from link.zenoh.keys import Keys
from tests.link.ros_definitions import GPSFix, GPSStatus, Header, Time

COVARIANCE = [0.04, 0.01, 0.0, 0.01, 0.09, 0.0, 0.0, 0.0, 0.16]


def gps(status: int = 0, **changes: float) -> bytes:
    header = Header(Time(1_700_000_000, 250_000_000), "gps")
    satellites = GPSStatus(header, 3, [4, 9, 21], 2, [4, 9], [30, 60], [120, 240], [40, 41], status, 4, 0, 1)
    values = {
        **dict.fromkeys(("pitch", "roll", "dip", "time", "gdop", "pdop", "hdop", "vdop", "tdop"), 0.0),
        **dict.fromkeys(("err", "err_horz", "err_vert", "err_track", "err_time", "err_pitch", "err_roll"), 0.0),
        "err_dip": 0.0,
        "err_speed": 0.392,
        "err_climb": 0.196,
        "latitude": 47.4,
        "longitude": 8.5,
        "altitude": 431.0,
        "track": 120.0,
        "speed": 7.0,
        "climb": -0.3,
    } | changes
    return bytes(
        GPSFix(header, satellites, position_covariance=COVARIANCE, position_covariance_type=3, **values).serialize()
    )


def test_place_is_that_of_the_antenna_above_the_ellipsoid() -> None:
    fix = fix_of_gps(gps(), 47.3)
    assert fix.t_ns == 1_700_000_000_250_000_000
    assert (fix.latitude_rad, fix.longitude_rad) == (radians(47.4), radians(8.5))
    assert fix.altitude_m == pytest.approx(478.3)
    assert fix.covariance_enu_m2 == pytest.approx(COVARIANCE)


def test_velocity_is_east_north_up_with_the_deviation_of_a_95_percent_bound() -> None:
    velocity = velocity_of_gps(gps())
    assert velocity.velocity_enu_m_s == pytest.approx((7.0 * 0.8660254, -3.5, -0.3))
    assert velocity.velocity_covariance_enu_m2_s2 == pytest.approx((0.04, 0, 0, 0, 0.04, 0, 0, 0, 0.01))


def test_receiver_that_stands_needs_no_course() -> None:
    assert velocity_of_gps(gps(speed=0.02, track=nan)).velocity_enu_m_s == pytest.approx((0.0, 0.02, -0.3))


def test_what_is_not_known_is_not_made_up() -> None:
    assert velocity_of_gps(gps(err_speed=0.0)).velocity_covariance_enu_m2_s2 is None
    assert velocity_of_gps(gps(err_speed=1e200)).velocity_covariance_enu_m2_s2 is None
    assert not velocity_of_gps(gps(climb=nan)).is_vertical_measured
    with pytest.raises(PayloadError):
        velocity_of_gps(gps(track=nan))
    with pytest.raises(PayloadError):
        fix_of_gps(gps(latitude=nan), 0.0)
    for read in (velocity_of_gps, lambda payload: fix_of_gps(payload, 0.0)):
        with pytest.raises(PayloadError):
            read(gps(status=-1))
        with pytest.raises(PayloadError):
            read(gps()[:60])


def test_one_topic_takes_the_place_of_fix_and_velocity() -> None:
    register()
    keys = Keys()
    found = routes(keys, TopicMap.model_validate({"vehicle": {"gps": "/gps/gps"}}))
    assert {found[key].endpoint.name for key in (keys.fix, keys.fix_velocity)} == {"/gps/gps"}
    assert found[keys.fix].endpoint.type_name == GPS_FIX
    assert found[keys.imu].endpoint.name == "/vehicle/imu"
