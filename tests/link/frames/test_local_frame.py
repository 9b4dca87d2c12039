"""Local frames against what real autopilots sent, against pymap3d, against themselves, and in closed form."""

import lzma
from bisect import bisect_left
from itertools import pairwise
from math import cos, degrees, dist, hypot, pi, radians
from pathlib import Path

import pymap3d
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymap3d.vincenty import vdist

from link.frames.geodesy import (
    Datum,
    LocalFrame,
    Projection,
    enu_from_geodetic,
    geodetic_from_enu,
    geodetic_from_local,
    local_from_geodetic,
    scale_of,
)
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message
from link.messages import Vector3
from tests.link.mavlink.tlog_frames import frames_of

DATA = Path(__file__).parents[2] / "data"
BERLIN = Datum(latitude_rad=radians(52.4733), longitude_rad=radians(13.4017), altitude_m=89.0)
FAR = st.floats(-2e4, 2e4)
PLACES = st.tuples(FAR, FAR, st.floats(-500.0, 5000.0))
FLAT = [Projection.PX4, Projection.ARDUPILOT]
RADII_M = {Projection.PX4: 6371000.0, Projection.ARDUPILOT: 6378100.0}


def about(projection: Projection, datum: Datum = BERLIN) -> LocalFrame:
    return LocalFrame(origin=datum, projection=projection)


def heard(name: str) -> dict[str, list[Message]]:
    """The messages of a recording about where the drone is."""
    codec = MavlinkCodec(250, 1)
    found: dict[str, list[Message]] = {"GLOBAL_POSITION_INT": [], "LOCAL_POSITION_NED": [], "GPS_GLOBAL_ORIGIN": []}
    for _, frame in frames_of(lzma.decompress(DATA.joinpath(f"{name}.tlog.xz").read_bytes())):
        for message in codec.decode(frame):
            found.get(message.get_type(), []).append(message)
    return found


def between(before: Message, after: Message, boot_ms: int) -> Vector3 | None:
    """The local place at `boot_ms` in ENU; None across a gap, and across a jolt, over which no straight line leads."""
    gap_ms = after.time_boot_ms - before.time_boot_ms
    jolt_m_s = dist((before.vx, before.vy, before.vz), (after.vx, after.vy, after.vz))
    if not 0 < gap_ms <= 60 or jolt_m_s > 0.5:
        return None
    share = (boot_ms - before.time_boot_ms) / gap_ms
    north, east, down = (
        one + share * (other - one) for one, other in ((before.x, after.x), (before.y, after.y), (before.z, after.z))
    )
    return (east, north, -down)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "projection", "least"),
    [("px4_offboard", Projection.PX4, 690), ("arducopter_guided", Projection.ARDUPILOT, 230)],
)
def test_a_real_autopilots_local_place_is_its_global_one_to_two_centimetres(
    name: str, projection: Projection, least: int
) -> None:
    """Both as it sent them, whole flights of 146 and 99 m; the global one is rounded to 1 cm, the stamps to 1 ms."""
    messages = heard(name)
    told = messages["GPS_GLOBAL_ORIGIN"][-1]
    datum = Datum(
        latitude_rad=radians(told.latitude * 1e-7),
        longitude_rad=radians(told.longitude * 1e-7),
        altitude_m=told.altitude * 1e-3,
    )
    local = messages["LOCAL_POSITION_NED"]
    boots_ms = [message.time_boot_ms for message in local]
    compared, tangent_m, reach_m = 0, 0.0, 0.0
    for message in messages["GLOBAL_POSITION_INT"]:
        after = bisect_left(boots_ms, message.time_boot_ms)
        if not 0 < after < len(local):
            continue
        theirs = between(local[after - 1], local[after], message.time_boot_ms)
        if theirs is None:
            continue
        place = (radians(message.lat * 1e-7), radians(message.lon * 1e-7), message.alt * 1e-3)
        assert local_from_geodetic(about(projection, datum), *place) == pytest.approx(theirs, abs=0.02)
        tangent_m = max(tangent_m, dist(enu_from_geodetic(datum, *place)[:2], theirs[:2]))
        compared, reach_m = compared + 1, max(reach_m, hypot(*theirs[:2]))
    assert compared >= least
    assert reach_m > 90.0
    assert tangent_m > 0.1  # the recording tells the two apart


@given(place=PLACES, projection=st.sampled_from(Projection))
def test_a_place_returns_through_geodetic_coordinates(place: Vector3, projection: Projection) -> None:
    frame = about(projection)
    assert local_from_geodetic(frame, *geodetic_from_local(frame, place)) == pytest.approx(place, abs=1e-5)


@given(place=PLACES)
def test_a_tangent_plane_is_pymap3ds(place: Vector3) -> None:
    latitude_rad, longitude_rad, altitude_m = geodetic_from_local(about(Projection.TANGENT_PLANE), place)
    origin = (degrees(BERLIN.latitude_rad), degrees(BERLIN.longitude_rad), BERLIN.altitude_m)
    theirs = pymap3d.geodetic2enu(degrees(latitude_rad), degrees(longitude_rad), altitude_m, *origin)
    assert place == pytest.approx(tuple(map(float, theirs)), abs=1e-6)


@given(place=st.tuples(FAR, FAR, st.just(0.0)).filter(lambda place: hypot(*place) > 1.0))
def test_px4s_place_is_as_far_away_as_along_the_great_circle_and_in_its_direction(place: Vector3) -> None:
    """Vincenty's inverse problem, of pymap3d, on PX4's sphere."""
    latitude_rad, longitude_rad, _ = geodetic_from_local(about(Projection.PX4), place)
    sphere = pymap3d.Ellipsoid(RADII_M[Projection.PX4], RADII_M[Projection.PX4])
    away_m, azimuth_deg = vdist(
        degrees(BERLIN.latitude_rad),
        degrees(BERLIN.longitude_rad),
        degrees(latitude_rad),
        degrees(longitude_rad),
        ell=sphere,
    )
    east_m, north_m, _ = place
    assert hypot(east_m, north_m) == pytest.approx(float(away_m), abs=1e-3)
    theirs_rad = 0.5 * pi - radians(float(azimuth_deg))
    assert dist((away_m * cos(theirs_rad), away_m * cos(theirs_rad - 0.5 * pi)), (east_m, north_m)) < 0.01


@pytest.mark.parametrize("projection", FLAT)
def test_due_north_is_the_latitude_times_the_radius(projection: Projection) -> None:
    place = local_from_geodetic(about(projection), BERLIN.latitude_rad + 2e-4, BERLIN.longitude_rad, 120.0)
    assert place == pytest.approx((0.0, 2e-4 * RADII_M[projection], 31.0), abs=1e-6)


def test_ardupilots_east_is_shortened_by_the_cosine_of_the_mean_latitude() -> None:
    north_rad, east_rad = 3e-4, 5e-4
    place = local_from_geodetic(
        about(Projection.ARDUPILOT), BERLIN.latitude_rad + north_rad, BERLIN.longitude_rad + east_rad, 89.0
    )
    assert place[0] == pytest.approx(6378100.0 * east_rad * cos(BERLIN.latitude_rad + 0.5 * north_rad), abs=1e-6)


@pytest.mark.parametrize("projection", FLAT)
def test_height_is_a_difference_of_altitudes_and_not_above_a_plane(projection: Projection) -> None:
    place = geodetic_from_enu(BERLIN, (1900.0, 900.0, 0.0))
    _, _, up_m = local_from_geodetic(about(projection), *place)
    assert up_m == pytest.approx(place[2] - BERLIN.altitude_m, abs=1e-9)
    assert up_m > 0.3


@pytest.mark.parametrize("projection", Projection)
def test_the_scale_is_that_of_small_steps(projection: Projection) -> None:
    frame, step_m = about(projection), 2.0
    for axis, scale in enumerate(scale_of(frame)):
        ahead = [0.0, 0.0, 0.0]
        ahead[axis] = step_m
        moved = local_from_geodetic(frame, *geodetic_from_enu(BERLIN, (ahead[0], ahead[1], ahead[2])))
        assert moved[axis] / step_m == pytest.approx(scale, abs=2e-6)


@pytest.mark.parametrize("projection", Projection)
def test_the_date_line_is_crossed_without_a_jump(projection: Projection) -> None:
    frame = about(projection, Datum(latitude_rad=-0.3, longitude_rad=pi - 1e-5, altitude_m=0.0))
    places = [geodetic_from_local(frame, (east_m, 10.0, 5.0)) for east_m in (40.0, 80.0, 120.0)]
    assert places[0][1] > 0.0 > places[2][1]
    for before, after in pairwise(local_from_geodetic(frame, *place) for place in places):
        assert after[0] - before[0] == pytest.approx(40.0, abs=1e-5)


@pytest.mark.parametrize("projection", Projection)
def test_the_origin_is_where_the_frame_begins(projection: Projection) -> None:
    frame, origin = about(projection), (BERLIN.latitude_rad, BERLIN.longitude_rad, BERLIN.altitude_m)
    assert local_from_geodetic(frame, *origin) == pytest.approx((0.0, 0.0, 0.0), abs=1e-8)
    assert geodetic_from_local(frame, (0.0, 0.0, 0.0)) == pytest.approx(origin)
