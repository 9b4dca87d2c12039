"""pymavlink's mavutil, the base of MAVProxy and of many scripts, with the helpers that these use."""

from collections.abc import Callable, Iterator
from functools import partial

import pytest
from pymavlink import mavutil, mavwp

from link.mavlink.dialect import Message, mavlink
from tests.conformance.programs import StandIn, stand_in, wait

pytestmark = [pytest.mark.wire, pytest.mark.timeout(600)]


@pytest.fixture(scope="module", params=["px4", "ardupilot"])
def autopilot(request: pytest.FixtureRequest) -> Iterator[StandIn]:
    """A stand-in for all cases of the module: none starts it anew."""
    with stand_in(request.param) as here:
        yield here


@pytest.fixture
def client(autopilot: StandIn) -> Iterator[mavutil.mavfile]:
    """A connection over TCP that has heard a heartbeat and sent one."""
    connection = mavutil.mavlink_connection(f"tcp:127.0.0.1:{autopilot.tcp_port}", source_system=255)
    connection.wait_heartbeat(timeout=30)
    connection.mav.heartbeat_send(mavlink.MAV_TYPE_GCS, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0)
    connection.mav.request_data_stream_send(connection.target_system, 1, mavlink.MAV_DATA_STREAM_ALL, 4, 1)
    yield connection
    connection.close()


def heard(client: mavutil.mavfile, name: str | list[str], fits: Callable[[Message], bool] = lambda _: True) -> Message:
    """The next message of a name that fits."""
    found: list[Message] = []

    def once() -> bool:
        message = client.recv_match(type=name, blocking=True, timeout=0.1)
        found.extend([message] if message is not None and fits(message) else [])
        return bool(found)

    wait(once)
    return found[0]


def _is_item(seq: int, request: Message) -> bool:
    return bool(request.seq == seq)


def in_mode(client: mavutil.mavfile, name: str) -> None:
    client.set_mode(name)
    heard(
        client, "HEARTBEAT", lambda beat: beat.autopilot != mavlink.MAV_AUTOPILOT_INVALID and client.flightmode == name
    )


def test_modes_are_set_by_their_names(client: mavutil.mavfile, autopilot: StandIn) -> None:
    for name in ("ALTCTL", "RTL", "LAND", "LOITER") if autopilot.firmware == "px4" else ("ALT_HOLD", "RTL", "GUIDED"):
        in_mode(client, name)


def test_all_parameters_are_fetched_one_is_set_and_read(client: mavutil.mavfile, autopilot: StandIn) -> None:
    client.param_fetch_all()
    first = heard(client, "PARAM_VALUE")
    while client.recv_match(type="PARAM_VALUE", blocking=True, timeout=1.0) is not None:
        pass  # mavutil keeps them
    assert len(client.params) == first.param_count > 800
    name = "MIS_TAKEOFF_ALT" if autopilot.firmware == "px4" else "WPNAV_SPEED_UP"
    client.param_set_send(name, 3.5, mavlink.MAV_PARAM_TYPE_REAL32)
    assert heard(client, "PARAM_VALUE", lambda value: value.param_id == name).param_value == pytest.approx(3.5)
    client.param_set_send(name, 2.5, mavlink.MAV_PARAM_TYPE_REAL32)
    heard(client, "PARAM_VALUE", lambda value: value.param_id == name)


def test_it_arms_and_disarms_by_mavutils_helpers(client: mavutil.mavfile, autopilot: StandIn) -> None:
    in_mode(client, "LOITER" if autopilot.firmware == "px4" else "GUIDED")
    client.arducopter_arm()
    heard(client, "HEARTBEAT", lambda _: client.motors_armed())
    client.arducopter_disarm()
    heard(client, "HEARTBEAT", lambda _: not client.motors_armed())


def test_a_mission_of_floats_goes_up_and_down(client: mavutil.mavfile) -> None:
    loader, system = mavwp.MAVWPLoader(client.target_system, 1), client.target_system
    for seq, command in enumerate((16, 22, 16)):
        place = (52.4733, 13.4017, 5.0)
        loader.add(mavlink.MAVLink_mission_item_message(system, 1, seq, 3, command, 0, 1, 0, 0, 0, 0, *place))
    client.waypoint_count_send(loader.count())
    for seq in range(loader.count()):
        asked = heard(client, ["MISSION_REQUEST", "MISSION_REQUEST_INT"], partial(_is_item, seq))
        client.mav.send(loader.wp(asked.seq))
    assert heard(client, "MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED
    client.waypoint_request_list_send()
    assert heard(client, "MISSION_COUNT").count == 3
    client.waypoint_request_send(1)
    assert heard(client, "MISSION_ITEM").command == 22
    client.mav.mission_ack_send(system, 1, mavlink.MAV_MISSION_ACCEPTED)
    client.waypoint_set_current_send(1)
    assert heard(client, "MISSION_CURRENT", lambda current: current.seq == 1)
    client.waypoint_clear_all_send()
    assert heard(client, "MISSION_ACK").type == mavlink.MAV_MISSION_ACCEPTED


def test_mavutil_knows_where_it_is(client: mavutil.mavfile) -> None:
    heard(client, "VFR_HUD")
    heard(client, "GLOBAL_POSITION_INT")
    place = client.location()
    assert (place.lat, place.lng) == pytest.approx((52.4733, 13.4017), abs=1e-3)
