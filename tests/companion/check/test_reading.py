"""What a check gathers from an autopilot's messages."""

import pytest

from companion.check.reading import Reader
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.session import MavlinkSession
from tests.companion.peer import FakePx4
from tests.link.mavlink.fake_autopilot import MS, START_NS, UTC_AHEAD_NS, S

DOWN = mavlink.MAV_SENSOR_ROTATION_PITCH_270
FORWARD, RIGHT = mavlink.MAV_SENSOR_ROTATION_NONE, mavlink.MAV_SENSOR_ROTATION_YAW_90


def battery(number: int, percent: int) -> Message:
    return mavlink.MAVLink_battery_status_message(number, 0, 0, 2500, [0] * 10, -1, -1, -1, percent)


def heard(*messages: Message, vehicle_type: int = mavlink.MAV_TYPE_QUADROTOR) -> Reader:
    """A reader that has found a PX4 and heard `messages` of it."""
    reader, autopilot = Reader(MavlinkSession(1)), MavlinkCodec(1, 1)
    heartbeat = mavlink.MAVLink_heartbeat_message(vehicle_type, mavlink.MAV_AUTOPILOT_PX4, 0, 0, 3, 3)
    for k, message in enumerate((heartbeat, *messages)):
        reader.receive(autopilot.encode(message), START_NS + k * MS)
    return reader


def test_facts_tell_what_vehicle_the_heartbeat_is_of() -> None:
    for vehicle_type in (mavlink.MAV_TYPE_HEXAROTOR, mavlink.MAV_TYPE_FIXED_WING):
        assert heard(vehicle_type=vehicle_type).facts().vehicle_type == vehicle_type


@pytest.mark.parametrize(
    ("told", "share"),
    [([(0, 80), (1, 5)], 0.8), ([(1, 5)], None), ([(0, -1), (2, 50)], None), ([(0, 80), (0, 79)], 0.79)],
)
def test_only_the_first_battery_counts_as_in_flight(told: list[tuple[int, int]], share: float | None) -> None:
    assert heard(*(battery(*one) for one in told)).facts().battery_share == share


def distance(orientation: int) -> Message:
    return mavlink.MAVLink_distance_sensor_message(1000, 20, 1200, 300, 0, 0, orientation, 0)


@pytest.mark.parametrize(
    ("orientations", "found"),
    [((DOWN, FORWARD, RIGHT), True), ((FORWARD, DOWN), True), ((DOWN,), True), ((FORWARD, RIGHT), False), ((), False)],
)
def test_range_finder_downwards_is_found_among_sectors_around_the_drone(
    orientations: tuple[int, ...], *, found: bool
) -> None:
    assert heard(*map(distance, orientations)).facts().has_range_finder is found


@pytest.mark.parametrize(
    ("base_mode", "seen_cm", "at_rest_m"),
    [(0, 62, 0.62), (mavlink.MAV_MODE_FLAG_SAFETY_ARMED, 62, None), (0, 20, None), (0, 1200, None)],
)
def test_range_at_rest_is_what_is_seen_within_the_range_with_the_motors_off(
    base_mode: int, seen_cm: int, at_rest_m: float | None
) -> None:
    beat = mavlink.MAVLink_heartbeat_message(2, mavlink.MAV_AUTOPILOT_PX4, base_mode, 0, 3, 3)
    seen = mavlink.MAVLink_distance_sensor_message(1000, 20, 1200, seen_cm, 0, 0, DOWN, 0)
    assert heard(beat, seen).facts().range_at_rest_m == at_rest_m


@pytest.mark.parametrize(
    ("fix", "ellipsoid_mm", "height_m"), [(3, 400_000, 0.0), (3, 447_300, 47.3), (3, 0, None), (1, 447_300, None)]
)
def test_geoid_is_read_off_the_receiver_as_in_flight(fix: int, ellipsoid_mm: int, height_m: float | None) -> None:
    receiver = mavlink.MAVLink_gps_raw_int_message(0, fix, 1, 1, 400_000, 1, 1, 0, 0, 9, alt_ellipsoid=ellipsoid_mm)
    assert heard(receiver).facts().geoid_height_m == (None if height_m is None else pytest.approx(height_m))


def ran(reader: Reader, autopilot: FakePx4, t_ns: int, duration_s: float) -> int:
    """Let both talk to each other, and return the time after it."""
    for _ in range(round(duration_s * S / (5 * MS))):
        t_ns += 5 * MS
        autopilot.tick(t_ns)
        for data in autopilot.take_output():
            reader.receive(data, t_ns)
        reader.poll(t_ns)
        for frame in reader.session.take_output():
            autopilot.receive(frame, t_ns)
    return t_ns


def test_what_is_asked_for_once_waits_for_an_answer_before_it_is_asked_for_again() -> None:
    ask = mavlink.MAV_CMD_REQUEST_MESSAGE
    reader, autopilot = Reader(MavlinkSession(1)), FakePx4(results={ask: ()})
    t_ns = ran(reader, autopilot, START_NS, 20.0)
    asked = len(autopilot.commands(ask))
    assert asked > 20
    autopilot.results = {}
    ran(reader, autopilot, t_ns, 0.9)
    assert len(autopilot.commands(ask)) - asked <= 4
    assert reader.facts().has_origin


def test_autopilots_date_is_compared_with_the_computers() -> None:
    reader, autopilot = Reader(MavlinkSession(1)), FakePx4(utc_set_by_ns=-UTC_AHEAD_NS + 4_200 * MS)
    ran(reader, autopilot, START_NS, 3.0)
    assert reader.facts().utc_ahead_s == pytest.approx(4.2, abs=0.005)
    reader, autopilot = Reader(MavlinkSession(1)), FakePx4(utc_known=False)
    ran(reader, autopilot, START_NS, 3.0)
    assert reader.facts().utc_ahead_s is None
