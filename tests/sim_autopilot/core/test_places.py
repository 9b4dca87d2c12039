"""The linear map from ENU to geodetic coordinates, against the exact one."""

from math import degrees, isclose, pi, radians

import pytest

from link.frames.geodesy import Datum, geodetic_from_enu
from link.frames.rotations import wrap_angle
from sim_autopilot.core.places import chart_at, geodetic, near

OFFSETS_M = [(0.0, 0.0, 0.0), (13.0, -7.0, 4.0), (-15.0, 3.0, -2.0), (2.0, 18.0, 5.0)]


@pytest.mark.parametrize("base_m", [(0.0, 0.0, 0.0), (-30.0, 400.0, 20.0), (25.0, -80.0, 5.0)])
@pytest.mark.parametrize("offset_m", OFFSETS_M)
@pytest.mark.parametrize(
    ("latitude_deg", "longitude_deg"),
    [
        (47.4, 8.5),
        (47.4, 179.9999),
        (47.4, -179.9999),
        (47.4, 180.0),
        (-77.85, 179.9999),
        (12.0, -180.0),
        (3.0, 0.00005),
    ],
)
def test_map_near_its_base_is_exact_to_a_tenth_of_a_millimetre(
    latitude_deg: float, longitude_deg: float, base_m: tuple[float, float, float], offset_m: tuple[float, float, float]
) -> None:
    datum = Datum(latitude_rad=radians(latitude_deg), longitude_rad=radians(longitude_deg), altitude_m=400.0)
    x, y, z = (b + o for b, o in zip(base_m, offset_m, strict=True))
    exact = geodetic_from_enu(datum, (x, y, z))
    latitude, longitude, altitude = geodetic(chart_at(datum, base_m), (x, y, z))
    assert abs(longitude) <= pi
    assert isclose(degrees(latitude), degrees(exact[0]), abs_tol=1e-9)
    # a tenth of a millimetre of latitude; at 78 degrees the meridians are five times closer
    assert isclose(degrees(wrap_angle(longitude - exact[1])), 0.0, abs_tol=5e-9)
    assert isclose(altitude, exact[2], abs_tol=1e-4)


def test_map_is_kept_while_it_reaches() -> None:
    datum = Datum(latitude_rad=radians(47.4), longitude_rad=radians(179.9999), altitude_m=400.0)
    chart = chart_at(datum, (0.0, 0.0, 0.0))
    assert near(chart, (12.0, -15.0, 2.0)) is chart
    assert near(chart, (15.0, -15.0, 2.0)).base_enu_m == (15.0, -15.0, 2.0)
