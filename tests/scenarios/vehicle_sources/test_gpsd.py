"""gpsd's reports read: recorded lines of gpsd 3.22, made-up ones, and bytes that are none."""

import json
from math import cos, degrees, radians, sin
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.frames.rotations import yaw_of
from link.messages import Fix, FixVelocity, VehicleImu
from scenarios.vehicle_sources.gpsd import GpsdReceiver, utc_ns
from tests.scenarios.vehicle_sources.sentences import ALTITUDE_M, LATITUDE_DEG, LONGITUDE_DEG, UTC_NS

RECORDED_TPV = (
    b'{"class":"TPV","device":"/dev/pts/0","status":3,"mode":3,"time":"2026-11-09T12:00:00.000Z","ept":0.005,'
    b'"lat":47.285233167,"lon":8.565265000,"altHAE":547.6000,"altMSL":499.6000,"alt":499.6000,"track":77.5200,'
    b'"magtrack":80.0976,"magvar":2.6,"speed":5.000,"climb":0.000,"geoidSep":48.000,"eph":15.200,"dgpsAge":1.0,'
    b'"dgpsSta":0}\n'
)
RECORDED_GST = (
    b'{"class":"GST","device":"/dev/pts/0","time":"2026-11-09T12:00:00.000Z","rms":0.020,"major":0.030,'
    b'"minor":0.020,"orient":30.000,"lat":0.022,"lon":0.029,"alt":0.040}\n'
)
RECORDED_ATT = (
    b'{"class":"ATT","device":"/dev/pts/0",,"time":"2026-11-09T12:00:00.000Z""heading":77.600,"dip":0.029,'
    b'"acc_len":0.020,"acc_x":0.030,"acc_y":0.020,"acc_z":30.000,"gyro_x":0.040,"depth":0.022}\n'
)
"""As gpsd 3.22 writes it, which is not JSON."""


def tpv(**changes: Any) -> bytes:
    report = json.loads(RECORDED_TPV) | changes
    return json.dumps({name: value for name, value in report.items() if value is not None}).encode() + b"\n"


def test_recorded_reports_tell_place_velocity_and_heading() -> None:
    fix, velocity, imu = GpsdReceiver().take(RECORDED_TPV + RECORDED_GST + RECORDED_ATT, 0)
    assert isinstance(fix, Fix)
    assert fix.t_ns == UTC_NS
    assert (degrees(fix.latitude_rad), degrees(fix.longitude_rad)) == pytest.approx(
        (LATITUDE_DEG, LONGITUDE_DEG), abs=1e-9
    )
    assert fix.altitude_m == ALTITUDE_M
    assert fix.covariance_enu_m2 is None  # eph alone does not say how high it may be
    assert isinstance(velocity, FixVelocity)
    expected = (5.0 * sin(radians(77.52)), 5.0 * cos(radians(77.52)), 0.0)
    assert velocity.velocity_enu_m_s == pytest.approx(expected)
    assert velocity.velocity_covariance_enu_m2_s2 is None
    assert not velocity.is_vertical_measured
    assert isinstance(imu, VehicleImu)
    assert imu.t_ns == UTC_NS
    assert imu.orientation_wxyz is not None
    assert yaw_of(imu.orientation_wxyz) == pytest.approx(radians(90.0 - 77.6))


def test_the_receivers_own_accuracy_goes_before_gpsds() -> None:
    receiver = GpsdReceiver()
    stated = tpv(time="2026-11-09T12:00:01.000Z", epx=3.0, epy=4.0, epv=5.0)
    late = tpv(time="2026-11-09T12:00:03.500Z", epx=3.0, epy=4.0, epv=5.0)
    readings = receiver.take(RECORDED_TPV + RECORDED_GST + stated + late, 0)
    fixes = [reading for reading in readings if isinstance(reading, Fix)]
    assert fixes[1].covariance_enu_m2 is not None
    east, north, up = fixes[1].covariance_enu_m2[::4]
    assert (east + north, up) == pytest.approx((0.030**2 + 0.020**2, 0.040**2))
    assert fixes[2].covariance_enu_m2 == (9.0, 0.0, 0.0, 0.0, 16.0, 0.0, 0.0, 0.0, 25.0)


def test_velocity_has_the_accuracy_of_speed_and_course_in_their_directions() -> None:
    velocity = GpsdReceiver().take(tpv(speed=10.0, track=30.0, eps=0.1, epd=3.0, climb=0.4, epc=0.2), 0)[1]
    assert isinstance(velocity, FixVelocity)
    assert velocity.is_vertical_measured
    assert velocity.velocity_enu_m_s[2] == 0.4
    assert velocity.velocity_covariance_enu_m2_s2 is not None
    matrix = np.array(velocity.velocity_covariance_enu_m2_s2).reshape(3, 3)
    along = np.array([sin(radians(30.0)), cos(radians(30.0)), 0.0])
    across = np.array([along[1], -along[0], 0.0])
    assert along @ matrix @ along == pytest.approx(0.01)
    assert across @ matrix @ across == pytest.approx((10.0 * radians(3.0)) ** 2)
    assert matrix[2, 2] == pytest.approx(0.04)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"mode": 1}, "no fix"),
        ({"mode": None}, "no fix"),
        ({"time": None}, "no fix"),
        ({"mode": 2}, "height above the ellipsoid"),
        ({"altHAE": None, "geoidSep": None}, "height above the ellipsoid"),
        ({"lat": None}, "height above the ellipsoid"),
        ({"lat": 91.0}, "no place on earth"),
        ({"lat": True}, "height above the ellipsoid"),
    ],
)
def test_what_makes_no_fix_is_said(changes: dict[str, Any], words: str) -> None:
    receiver = GpsdReceiver()
    assert receiver.take(tpv(**changes), 0) == []
    assert receiver.complaint is not None
    assert words in receiver.complaint


def test_height_over_sea_and_geoid_make_the_one_above_the_ellipsoid() -> None:
    fix = GpsdReceiver().take(tpv(altHAE=None), 0)[0]
    assert isinstance(fix, Fix)
    assert fix.altitude_m == pytest.approx(ALTITUDE_M)


def test_an_instant_reported_twice_is_told_once_and_another_receiver_not_at_all() -> None:
    receiver = GpsdReceiver()
    assert len(receiver.take(RECORDED_TPV + RECORDED_TPV, 0)) == 2
    assert receiver.take(tpv(device="/dev/ttyUSB7", time="2026-11-09T12:00:01.000Z"), 0) == []


def test_a_receiver_that_sets_its_clock_back_is_followed() -> None:
    receiver = GpsdReceiver()
    wrong = tpv(time="2046-06-25T12:00:00.000Z")  # a week number that had rolled over
    right = receiver.take(wrong + RECORDED_TPV, 0)[2]
    assert right.t_ns == UTC_NS


def test_reports_are_asked_for_once_in_each_connection() -> None:
    receiver = GpsdReceiver("/dev/ttyACM0")
    request = receiver.to_send(0)
    assert request == b'?WATCH={"enable":true,"json":true,"device":"/dev/ttyACM0"};\n'
    assert receiver.to_send(1) == b""
    receiver.connected()
    assert receiver.to_send(2) == request


def test_utc_is_exact_to_the_nanosecond() -> None:
    assert utc_ns("2026-11-09T12:00:00.123456789Z") == UTC_NS + 123_456_789
    assert utc_ns("2026-11-09T12:00:00Z") == UTC_NS
    assert [utc_ns(text) for text in ("2026-13-09T12:00:00Z", "2026-11-09 12:00", None, 5)] == [None] * 4


@given(st.binary(max_size=200))
def test_no_bytes_whatever_make_it_raise(data: bytes) -> None:
    receiver = GpsdReceiver()
    receiver.take(data + b"\n", 0)
    assert len(receiver.take(RECORDED_TPV, 0)) == 2


@pytest.mark.parametrize("name", ["altHAE", "speed", "climb", "epx", "epv", "eps", "epd", "epc"])
def test_a_number_that_no_receiver_measures_counts_as_unsaid(name: str) -> None:
    stated = {"climb": 0.4, "epx": 3.0, "epy": 4.0, "epv": 5.0, "eps": 0.1, "epd": 3.0, "epc": 0.2, "altMSL": None}
    readings = GpsdReceiver().take(tpv(**stated | {name: 1e308}), 0)
    assert readings == GpsdReceiver().take(tpv(**stated | {name: None}), 0)


@pytest.mark.parametrize("name", ["major", "minor", "orient", "alt"])
def test_an_accuracy_that_no_receiver_has_is_no_accuracy(name: str) -> None:
    gst = json.loads(RECORDED_GST) | {name: 1e308, "lat": None}
    stated = tpv(time="2026-11-09T12:00:01.000Z")
    fix = GpsdReceiver().take(json.dumps(gst).encode() + b"\n" + stated, 0)[0]
    assert isinstance(fix, Fix)
    assert fix.covariance_enu_m2 is None


ODD_VALUES = (None, True, 10**400, -1, 1e308, float("nan"), float("inf"), "", "x", [1], {"lat": 1})


@pytest.mark.slow
@given(
    st.dictionaries(
        st.sampled_from(["class", "mode", "time", "lat", "lon", "altHAE", "track", "speed", "epx", "eps", "climb"]),
        st.sampled_from(ODD_VALUES),
    )
)
def test_no_values_whatever_make_it_raise(changes: dict[str, Any]) -> None:
    report = json.loads(RECORDED_TPV) | changes
    GpsdReceiver().take(json.dumps(report).encode() + b"\n", 0)
