"""NMEA 0183 read: whole and broken sentences, instants put together, stamps, accuracy."""

from math import cos, degrees, pi, radians, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.frames.rotations import yaw_of
from link.messages import Fix, FixVelocity, VehicleImu
from scenarios.vehicle_sources.nmea import NmeaReceiver
from scenarios.vehicle_sources.nmea_sentences import angle_rad, parse_sentence, time_of_day_ns
from scenarios.vehicle_sources.receiver import Reading
from tests.scenarios.vehicle_sources.sentences import (
    ALTITUDE_M,
    COURSE_DEG,
    LATITUDE_DEG,
    LONGITUDE_DEG,
    PERIOD_NS,
    SPEED_KNOTS,
    UTC_NS,
    drive,
    epoch,
    sentence,
)


def read(*sentences: bytes) -> list[Reading]:
    return NmeaReceiver().take(b"".join(sentences), 0)


def fixes(readings: list[Reading]) -> list[Fix]:
    return [reading for reading in readings if isinstance(reading, Fix)]


def test_published_sentences_keep_their_checksums() -> None:
    # The examples of the u-blox M8 protocol description (UBX-13003221), GGA and RMC, with their checksums
    gga = b"$GPGGA,092725.00,4717.11399,N,00833.91590,E,1,08,1.01,499.6,M,48.0,M,,*5B"
    rmc = b"$GPRMC,083559.00,A,4717.11437,N,00833.91522,E,0.004,77.52,091202,,,A*57"
    for line, kind in ((gga, "GGA"), (rmc, "RMC")):
        found = parse_sentence(line)
        assert found is not None
        assert found.kind == kind


def test_a_drive_is_told_with_place_stamp_and_velocity() -> None:
    readings = read(drive(10))
    told = fixes(readings)
    assert [fix.t_ns for fix in told] == [UTC_NS + index * PERIOD_NS for index in range(10)]
    assert degrees(told[0].latitude_rad) == pytest.approx(LATITUDE_DEG, abs=1e-12)
    assert degrees(told[0].longitude_rad) == pytest.approx(LONGITUDE_DEG, abs=1e-12)
    assert told[0].altitude_m == pytest.approx(ALTITUDE_M)
    velocity = next(reading for reading in readings if isinstance(reading, FixVelocity))
    speed_m_s = SPEED_KNOTS * 0.514444
    expected = (speed_m_s * sin(radians(COURSE_DEG)), speed_m_s * cos(radians(COURSE_DEG)), 0.0)
    assert velocity.velocity_enu_m_s == pytest.approx(expected, rel=1e-5)
    assert velocity.velocity_covariance_enu_m2_s2 is None
    assert not velocity.is_vertical_measured


def test_an_instant_is_told_at_its_last_sentence_once_the_order_is_known() -> None:
    receiver = NmeaReceiver()
    receiver.take(drive(2), 0)
    gga, rmc, gst, _ = epoch(2)
    assert fixes(receiver.take(gga + rmc, 0)) == []
    told = fixes(receiver.take(gst, 0))
    assert [fix.t_ns for fix in told] == [UTC_NS + 2 * PERIOD_NS]


def test_gst_ellipse_becomes_a_covariance_whose_axes_are_the_stated_ones() -> None:
    covariance = fixes(read(drive(3)))[0].covariance_enu_m2
    assert covariance is not None
    matrix = np.array(covariance).reshape(3, 3)
    axis = np.array([sin(radians(30.0)), cos(radians(30.0)), 0.0])  # 30 degrees clockwise from north
    across = np.array([axis[1], -axis[0], 0.0])
    assert axis @ matrix @ axis == pytest.approx(0.030**2)
    assert across @ matrix @ across == pytest.approx(0.020**2)
    assert axis @ matrix @ across == pytest.approx(0.0, abs=1e-12)
    assert matrix[2, 2] == pytest.approx(0.040**2)


def test_gst_without_an_ellipse_has_north_and_east_in_their_places() -> None:
    gga, rmc, _, _ = epoch(0)
    told = fixes(read(gga, rmc, sentence("GNGST,120000.00,,,,,0.7,0.5,1.1"), epoch(1)[0]))
    assert told[0].covariance_enu_m2 == pytest.approx((0.25, 0.0, 0.0, 0.0, 0.49, 0.0, 0.0, 0.0, 1.21))


def test_without_gst_the_accuracy_is_unknown() -> None:
    assert [fix.covariance_enu_m2 for fix in fixes(read(*epoch(0)[:2], epoch(1)[0]))] == [None]


@pytest.mark.parametrize("stated", ["1e200,0.02,30.0,,,0.04", ",,,1e200,0.5,0.04", "0.03,0.02,30.0,,,1e200"])
def test_an_accuracy_that_no_receiver_has_is_unknown(stated: str) -> None:
    gga, rmc, _, _ = epoch(0)
    told = fixes(read(gga, rmc, sentence(f"GNGST,120000.00,,{stated}"), epoch(1)[0]))
    assert told[0].covariance_enu_m2 is None


def test_an_old_statement_of_accuracy_no_longer_holds() -> None:
    later = [line for index in range(1, 13) for line in epoch(index)[:2]]
    covariances = [fix.covariance_enu_m2 for fix in fixes(read(*epoch(0), *later, epoch(13)[0]))]
    assert [covariance is None for covariance in covariances] == [False] * 11 + [True] * 2  # 2 s at 5 Hz


def test_heading_is_turned_from_clockwise_north_to_counterclockwise_east() -> None:
    imu = next(reading for reading in read(drive(1)) if isinstance(reading, VehicleImu))
    assert imu.t_ns == UTC_NS
    assert imu.orientation_wxyz is not None
    assert yaw_of(imu.orientation_wxyz) == pytest.approx(radians(90.0 - 77.6))
    assert imu.orientation_covariance_rad2 is None


def test_vtg_stands_in_for_rmc() -> None:
    gga, _, _, _ = epoch(0)
    date, vtg = sentence("GNZDA,120000.00,09,11,2026,00,00"), sentence("GNVTG,77.52,T,,M,9.719,N,18.0,K,A")
    velocity = next(reading for reading in read(gga, date, vtg, epoch(1)[0]) if isinstance(reading, FixVelocity))
    assert np.hypot(*velocity.velocity_enu_m_s[:2]) == pytest.approx(5.0)


def test_midnight_is_passed_with_the_date_of_the_day_before() -> None:
    last = (
        "GNRMC,235959.90,A,4717.11399,N,00833.91590,E,9.7,77.5,311226,,,R",
        "GNGGA,235959.90,4717.11399,N,00833.91590,E,4,12,0.8,499.6,M,48.0,M,1.0,0000",
    )
    first = "GNGGA,000000.00,4717.11399,N,00833.91590,E,4,12,0.8,499.6,M,48.0,M,1.0,0000"
    after = first.replace("000000.00", "000000.10")
    told = fixes(read(*map(sentence, (*last, first, after))))
    assert [fix.t_ns - told[0].t_ns for fix in told] == [0, 100_000_000, 200_000_000]
    assert (told[1].t_ns // 1_000_000_000) % 86_400 == 0


def test_time_of_day_is_exact_and_takes_a_leap_second() -> None:
    assert time_of_day_ns("123519.487") == (12 * 3600 + 35 * 60 + 19) * 10**9 + 487_000_000
    assert time_of_day_ns("235960.5") == 86_400 * 10**9 + 500_000_000
    assert [time_of_day_ns(text) for text in ("", "240000", "126000", "12-500", "12350")] == [None] * 5


def test_places_in_all_hemispheres() -> None:
    assert angle_rad("0730.0000", "S") == pytest.approx(-7.5 * pi / 180.0)
    assert angle_rad("17930.0000", "W") == pytest.approx(-179.5 * pi / 180.0)
    assert [angle_rad(*one) for one in (("", "N"), ("9100.0", "N"), ("4760.0", "N"), ("4700.0", "X"))] == [None] * 4


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ((b",4,12,", b",0,12,"), "no fix"),
        ((b",4,12,", b",7,12,"), "no fix"),
        ((b",A,", b",V,"), "no fix"),
        ((b",48.0,M", b",,M"), "geoid separation"),
        ((b",091126,", b",,"), "no date"),
        ((b"GNGGA", b"GNGNS"), "GGA"),
    ],
)
def test_what_makes_no_fix_is_said(change: tuple[bytes, bytes], words: str) -> None:
    receiver = NmeaReceiver()
    bodies = [line[1:-5].replace(*change).decode() for line in drive(3).splitlines(keepends=True)]
    assert fixes(receiver.take(b"".join(map(sentence, bodies)), 0)) == []
    assert receiver.complaint is not None
    assert words in receiver.complaint


def test_broken_sentences_are_counted_and_cost_nothing_else() -> None:
    receiver = NmeaReceiver()
    broken = epoch(1)[0].replace(b"4717", b"4718")
    cut = epoch(1)[1][:30]
    readings = receiver.take(b"\xff\x00garbage\r\n" + drive(1) + broken + cut + b"".join(epoch(2)) + epoch(3)[0], 0)
    assert [fix.t_ns for fix in fixes(readings)] == [UTC_NS, UTC_NS + 2 * PERIOD_NS]
    assert receiver.counts["bad"] == 2  # what was cut is read on at the next sentence's beginning


def test_wrong_baud_rate_is_suggested_when_nothing_is_a_sentence() -> None:
    receiver = NmeaReceiver()
    receiver.take(b"\x81\xfe\n\x99\x00\n", 0)
    assert receiver.complaint is not None
    assert "baud rate" in receiver.complaint


@given(st.lists(st.integers(min_value=1, max_value=60), min_size=1, max_size=40))
def test_pieces_of_any_size_tell_the_same(sizes: list[int]) -> None:
    data, receiver, readings, at = drive(3), NmeaReceiver(), list[Reading](), 0
    while at < len(data):
        size = sizes[at % len(sizes)]
        readings += receiver.take(data[at : at + size], 0)
        at += size
    assert readings == read(drive(3))


@given(st.binary(max_size=300))
def test_no_bytes_whatever_make_it_raise(data: bytes) -> None:
    receiver = NmeaReceiver()
    receiver.take(data, 0)
    fields = data.decode("latin-1").replace("*", "").replace("$", "").replace("\r", "").replace("\n", "")
    ascii_fields = fields.encode("ascii", "ignore").decode()
    receiver.take(b"".join(sentence(f"GN{kind},{ascii_fields}") for kind in ("GGA", "RMC", "GST", "ZDA", "HDT")), 0)


_ODD = ("", "nan", "inf", "1e308", "-1", "1_0", "240000.00", "9" * 12, "9" * 400, "9" * 5000, "." + "9" * 400)


@given(st.lists(st.tuples(st.integers(0, 15), st.integers(1, 11), st.sampled_from(_ODD)), min_size=1, max_size=4))
def test_no_field_of_a_whole_sentence_makes_it_raise_or_tell_what_is_no_number(
    changes: list[tuple[int, int, str]],
) -> None:
    bodies = [line[1:].decode().partition("*")[0] for line in drive(3).splitlines()]
    bodies += ["GPZDA,120000.00,09,11,2026,00,00", "GPVTG,77.5,T,,M,9.7,N,18,K,A"]
    for which, place, text in changes:
        fields = bodies[which % len(bodies)].split(",")
        fields[place % len(fields) or 1] = text
        bodies[which % len(bodies)] = ",".join(fields)
    for reading in read(*map(sentence, bodies)):
        told = (getattr(reading, name) for name in reading.__struct_fields__)
        assert np.all(np.isfinite(np.concatenate([np.ravel(one) for one in told if one is not None]).astype(float)))


def test_day_and_angle_of_more_digits_than_they_have_are_none() -> None:
    for body in (f"GPZDA,120000.00,{'9' * 12},11,2026,00,00", f"GPZDA,120000.00,09,11,{'9' * 5000},00,00"):
        assert read(sentence(body)) == []
    assert angle_rad("9" * 400, "E") is None
