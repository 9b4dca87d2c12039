"""The stand-ins' local frames a kilometre from the origin: all that is told and taken names one point on the globe."""

from math import degrees, hypot, nan, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from link.frames.geodesy import Datum, LocalFrame, Projection, enu_from_geodetic, geodetic_from_enu, local_from_geodetic
from link.frames.rotations import enu_from_ned
from link.mavlink.dialect import Message, mavlink
from link.messages import Vector3
from sim_autopilot.core.places import Origin, local_from_world, world_from_local
from sim_autopilot.firmware.ardupilot.ardupilot import ARDUPILOT
from sim_autopilot.firmware.px4.px4 import PX4
from sim_autopilot.interfaces import AutopilotConfig
from tests.sim_autopilot.copter import ardupilot
from tests.sim_autopilot.pilot import DATUM, Pilot, arm, px4, set_mode, setpoint

FAR: Vector3 = (900.0, -450.0, 0.12)
CONFIGS = [px4(position_enu_m=FAR), ardupilot(position_enu_m=FAR)]
NAMES = ["px4", "ardupilot"]
parts = st.floats(-2e4, 2e4)


def place_of(message: Message) -> Vector3:
    """Latitude, longitude (rad) and altitude (m) of a message."""
    return (radians(message.lat * 1e-7), radians(message.lon * 1e-7), message.alt * 1e-3)


def local_of(message: Message) -> Vector3:
    return enu_from_ned((message.x, message.y, message.z))


@pytest.mark.parametrize("config", CONFIGS, ids=NAMES)
def test_local_position_is_the_firmwares_layout_of_the_global_one(config: AutopilotConfig) -> None:
    pilot = Pilot(config)
    for message_id in (mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED, mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT):
        pilot.step(
            mavlink.MAVLink_command_long_message(
                1, 1, mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, 0, message_id, 2e4, 0.0, 0.0, 0.0, 0.0, 0.0
            )
        )
    pilot.run(1.0)
    frame = LocalFrame(origin=DATUM, projection=config.firmware.origin.projection)
    local = local_of(pilot.last("LOCAL_POSITION_NED"))
    assert local == pytest.approx(local_from_geodetic(frame, *place_of(pilot.last("GLOBAL_POSITION_INT"))), abs=0.02)
    assert hypot(local[0] - FAR[0], local[1] - FAR[1]) > 1.0
    assert local[2] - pilot.position[2] == pytest.approx(hypot(*FAR[:2]) ** 2 / (2.0 * 6.37e6), abs=1e-3)


def test_px4_tells_the_same_place_by_every_message() -> None:
    pilot = Pilot(px4(position_enu_m=FAR))
    pilot.run(1.5)
    local = local_of(pilot.last("LOCAL_POSITION_NED"))
    assert local_of(pilot.last("ODOMETRY")) == pytest.approx(local, abs=1e-4)
    home = pilot.last("HOME_POSITION")
    assert local_of(home) == pytest.approx(local, abs=5e-3)  # its legs give by 2 mm
    place = (radians(home.latitude * 1e-7), radians(home.longitude * 1e-7), home.altitude * 1e-3)
    assert enu_from_geodetic(DATUM, *place) == pytest.approx(FAR, abs=0.02)
    assert pilot.last("ALTITUDE").altitude_local == pytest.approx(local[2], abs=1e-3)


@pytest.mark.slow
def test_px4_flies_to_the_local_place_that_it_is_sent_and_tells_it_again() -> None:
    pilot = Pilot(px4(position_enu_m=FAR))
    pilot.run(0.5)
    start = pilot.last("LOCAL_POSITION_NED")
    wanted = (start.x + 3.0, start.y - 2.0, start.z - 5.0)
    pilot.run(0.5, lambda _t: setpoint(wanted))
    pilot.step(set_mode(6), arm())
    pilot.run(12.0, lambda _t: setpoint(wanted))
    told, target = pilot.last("LOCAL_POSITION_NED"), pilot.last("POSITION_TARGET_LOCAL_NED")
    assert (told.x, told.y, told.z) == pytest.approx(wanted, abs=0.05)
    assert (target.x, target.y, target.z) == pytest.approx(wanted, abs=1e-3)
    assert pilot.position == pytest.approx((FAR[0] - 2.0, FAR[1] + 3.0, FAR[2] + 5.0), abs=0.07)


@pytest.mark.slow
def test_a_height_that_is_given_alone_is_above_the_origins_altitude_where_the_drone_is() -> None:
    pilot = Pilot(px4(position_enu_m=FAR))
    pilot.run(0.5)
    rise = setpoint((nan, nan, -8.0), (0.0, 0.0, nan), mask=0b1001_1110_0011)
    pilot.run(0.5, lambda _t: rise)
    pilot.step(set_mode(6), arm())
    pilot.run(12.0, lambda _t: rise)
    assert pilot.last("LOCAL_POSITION_NED").z == pytest.approx(-8.0, abs=0.02)
    assert place_of(pilot.last("GLOBAL_POSITION_INT"))[2] == pytest.approx(DATUM.altitude_m + 8.0, abs=0.02)


def test_a_moved_origin_leaves_a_setpoint_its_local_place() -> None:
    pilot = Pilot(px4(position_enu_m=FAR))
    pilot.run(0.5)
    pilot.step(setpoint((-440.0, 910.0, -5.0)))
    pilot.step()
    latitude_rad, longitude_rad, altitude_m = geodetic_from_enu(DATUM, (700.0, 300.0, 0.0))
    place = (round(degrees(latitude_rad) * 1e7), round(degrees(longitude_rad) * 1e7), round(altitude_m * 1e3))
    pilot.step(mavlink.MAVLink_set_gps_global_origin_message(1, *place))
    pilot.step()
    reference = pilot.node.memory.heard.setpoints.reference
    assert reference is not None
    assert reference.position_enu_m is not None
    x, y, z = reference.position_enu_m.tolist()
    assert local_from_world(pilot.node.memory.places.origin, (x, y, z)) == pytest.approx((910.0, -440.0, 5.0), abs=1e-4)


@given(place=st.tuples(parts, parts, st.floats(-500.0, 5000.0)), projection=st.sampled_from(Projection))
def test_places_return_through_the_local_frame(place: Vector3, projection: Projection) -> None:
    moved = Datum(latitude_rad=radians(52.48), longitude_rad=radians(13.38), altitude_m=60.0)
    origin = Origin(world=DATUM, frame=LocalFrame(origin=moved, projection=projection))
    assert world_from_local(origin, local_from_world(origin, place)) == pytest.approx(place, abs=1e-4)


@pytest.mark.parametrize("firmware", [PX4, ARDUPILOT], ids=NAMES)
@pytest.mark.parametrize("place", [(3e38, -3e38, 1.0), (1.0, 0.0, -3e38), (-1e7, 2e7, 3e38)])
def test_a_place_out_of_all_reach_stays_in_its_direction(firmware: object, place: Vector3) -> None:
    projection = PX4.origin.projection if firmware is PX4 else ARDUPILOT.origin.projection
    origin = Origin(world=DATUM, frame=LocalFrame(origin=DATUM, projection=projection))
    found = world_from_local(origin, place)
    assert np.all(np.isfinite(found))
    assert [np.sign(one) for one, asked in zip(found, place, strict=True) if abs(asked) > 1e6] == [
        np.sign(asked) for asked in place if abs(asked) > 1e6
    ]
