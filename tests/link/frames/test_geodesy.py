"""Local ENU coordinates against closed forms and a published example."""

from math import cos, degrees, pi, radians, sin, sqrt

import pymap3d
import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.frames.geodesy import Datum, enu_from_geodetic, geodetic_from_enu
from link.messages import Vector3

# WGS 84 defining parameters: NIMA TR8350.2, table 3.1
SEMI_MAJOR_AXIS_M = 6378137.0
FLATTENING = 1.0 / 298.257223563
ECCENTRICITY2 = FLATTENING * (2.0 - FLATTENING)

ZERMATT = Datum(latitude_rad=radians(46.017), longitude_rad=radians(7.750), altitude_m=1673.0)
DISTANCES = st.floats(-2e4, 2e4)


def test_matterhorn_lies_where_mathworks_says() -> None:
    """The example of geodetic2enu in MathWorks' Mapping Toolbox reference, given to 0.1 m."""
    position = enu_from_geodetic(ZERMATT, radians(45.976), radians(7.658), 4531.0)
    assert position == pytest.approx((-7134.8, -4556.3, 2852.4), abs=0.05)


@given(DISTANCES, DISTANCES, st.floats(-500.0, 5000.0))
def test_position_returns_through_geodetic_coordinates(east_m: float, north_m: float, up_m: float) -> None:
    latitude_rad, longitude_rad, altitude_m = geodetic_from_enu(ZERMATT, (east_m, north_m, up_m))
    back = enu_from_geodetic(ZERMATT, latitude_rad, longitude_rad, altitude_m)
    assert back == pytest.approx((east_m, north_m, up_m), abs=1e-5)


@given(
    st.floats(-90.0, 90.0),
    st.floats(-180.0, 180.0),
    st.tuples(DISTANCES, DISTANCES, st.floats(-500.0, 5000.0)),
)
def test_conversions_are_those_of_pymap3d(latitude_deg: float, longitude_deg: float, position: Vector3) -> None:
    datum = Datum(latitude_rad=radians(latitude_deg), longitude_rad=radians(longitude_deg), altitude_m=250.0)
    latitude, longitude, altitude_m = geodetic_from_enu(datum, position)
    place = (degrees(latitude), degrees(longitude), altitude_m)
    theirs = pymap3d.enu2geodetic(*position, latitude_deg, longitude_deg, 250.0)
    apart = pymap3d.geodetic2enu(*place, *theirs)
    assert max(map(abs, map(float, apart))) < 1e-6
    again = pymap3d.geodetic2enu(*place, latitude_deg, longitude_deg, 250.0)
    ours = enu_from_geodetic(datum, radians(place[0]), radians(place[1]), altitude_m)
    assert ours == pytest.approx(tuple(map(float, again)), abs=1e-6)


def test_small_steps_follow_the_radii_of_curvature() -> None:
    """Meridian and prime vertical radii of the ellipsoid, in closed form."""
    latitude_rad, step_rad = ZERMATT.latitude_rad, 1e-7
    root = 1.0 - ECCENTRICITY2 * sin(latitude_rad) ** 2
    meridian_m = SEMI_MAJOR_AXIS_M * (1.0 - ECCENTRICITY2) / root**1.5 + ZERMATT.altitude_m
    prime_vertical_m = SEMI_MAJOR_AXIS_M / sqrt(root) + ZERMATT.altitude_m

    _, north_m, _ = enu_from_geodetic(ZERMATT, latitude_rad + step_rad, ZERMATT.longitude_rad, ZERMATT.altitude_m)
    east_m, _, _ = enu_from_geodetic(ZERMATT, latitude_rad, ZERMATT.longitude_rad + step_rad, ZERMATT.altitude_m)

    assert north_m / step_rad == pytest.approx(meridian_m, rel=1e-6)
    assert east_m / step_rad == pytest.approx(prime_vertical_m * cos(latitude_rad), rel=1e-6)


def test_datum_is_the_origin() -> None:
    position = enu_from_geodetic(ZERMATT, ZERMATT.latitude_rad, ZERMATT.longitude_rad, ZERMATT.altitude_m)
    assert position == pytest.approx((0.0, 0.0, 0.0), abs=1e-8)


def test_crossing_the_date_line_goes_on_eastward() -> None:
    datum = Datum(latitude_rad=radians(-17.0), longitude_rad=radians(179.999), altitude_m=0.0)
    east_m, _, _ = enu_from_geodetic(datum, datum.latitude_rad, radians(-179.999), 0.0)
    assert 200.0 < east_m < 230.0
    _, longitude_rad, _ = geodetic_from_enu(datum, (east_m, 0.0, 0.0))
    assert degrees(longitude_rad) == pytest.approx(-179.999, abs=1e-6)


@pytest.mark.parametrize(
    ("latitude_rad", "longitude_rad", "altitude_m"),
    [(1.6, 0.0, 0.0), (0.0, pi + 0.1, 0.0), (float("nan"), 0.0, 0.0), (0.0, 0.0, float("inf"))],
)
def test_datum_that_is_no_place_is_refused(latitude_rad: float, longitude_rad: float, altitude_m: float) -> None:
    with pytest.raises(ValueError, match=r"_rad|_m must"):
        Datum(latitude_rad=latitude_rad, longitude_rad=longitude_rad, altitude_m=altitude_m)
