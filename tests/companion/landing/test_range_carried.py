"""A range finder that has come too near to see: what it saw last, carried on by the drone's own descent."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.autopilots.px4 import Px4Driver
from companion.autopilots.state import AutopilotState, update_state
from companion.situation.own_drone import range_carried_m
from companion.situation.situation import Drone
from link.mavlink.clock_map import ClockMap, RoundTrip, with_round_trip, with_system_time
from link.mavlink.dialect import Message, mavlink
from link.records import replace
from tests.companion.facts import NOW_NS

BOOT_MS = 50_000
_TRIP = RoundTrip(sent_ns=NOW_NS, received_ns=NOW_NS + 1_000_000, boot_ns=BOOT_MS * 1_000_000)
CLOCK = with_system_time(with_round_trip(ClockMap(), _TRIP), BOOT_MS * 1_000_000, NOW_NS)
LEVEL = mavlink.MAVLink_attitude_quaternion_message(BOOT_MS, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
UNSEEN_CM = 65_535


def _at(after_ms: int, up_m: float, forward_m: float = 0.0) -> Message:
    return mavlink.MAVLink_local_position_ned_message(BOOT_MS + after_ms, forward_m, 0.0, -up_m, 0.0, 0.0, 0.0)


def _range(after_ms: int, distance_cm: int, quality: int = 0) -> Message:
    down = mavlink.MAV_SENSOR_ROTATION_PITCH_270
    return mavlink.MAVLink_distance_sensor_message(
        BOOT_MS + after_ms, 0, 10_000, distance_cm, 0, 0, down, 0, signal_quality=quality
    )


def _hear(*messages: Message) -> AutopilotState:
    state = AutopilotState()
    for message in messages:
        state = update_state(state, message, CLOCK, Px4Driver())
    return state


def _carried_m(state: AutopilotState, up_m: float, after_s: float, sensor_height_m: float = 0.0) -> float | None:
    drone = Drone(position_enu_m=np.array([0.0, 0.0, up_m]), velocity_enu_m_s=np.zeros(3), yaw_rad=0.0, age_s=0.0)
    return range_carried_m(drone, state.view.range_down, sensor_height_m, NOW_NS + round(after_s * 1e9))


@pytest.mark.parametrize(("distance_cm", "quality"), [(UNSEEN_CM, 0), (10_000, 0), (0, 0), (300, 1)])
def test_reading_beyond_the_range_or_told_invalid_leaves_what_was_seen_last(distance_cm: int, quality: int) -> None:
    state = _hear(LEVEL, _at(0, 1.2), _range(10, 7), _at(20, 1.19), _range(30, distance_cm, quality))
    assert state.view.range_down is not None
    assert state.view.range_down.own is not None
    assert state.view.range_down.distance_m == pytest.approx(0.07)
    assert state.view.range_down.own.position_enu_m[2] == pytest.approx(1.2)


@given(seen_cm=st.integers(1, 400), sunk_m=st.floats(-1.0, 2.0), sensor_m=st.floats(0.0, 0.3))
def test_what_was_seen_last_is_carried_on_by_the_descent(seen_cm: int, sunk_m: float, sensor_m: float) -> None:
    state = _hear(LEVEL, _at(0, 1.7), _range(10, seen_cm), _range(30, UNSEEN_CM))
    carried_m = _carried_m(state, 1.7 - sunk_m, 1.4, sensor_m)
    assert carried_m == pytest.approx(0.01 * seen_cm - sensor_m - sunk_m)


def test_what_was_seen_long_ago_or_in_another_frame_is_not_carried_on() -> None:
    seen = (LEVEL, _at(0, 1.7), _range(10, 7))
    assert _carried_m(_hear(*seen), 1.5, 2.9) is not None
    assert _carried_m(_hear(*seen), 1.5, 3.1) is None
    moved = _hear(*seen, _at(20, 1.7, 50.0))
    assert moved.view.frame_moves.shift_enu_m != (0.0, 0.0, 0.0)
    assert _carried_m(moved, 1.5, 0.1) is None
    assert moved.view.range_down is not None  # a distance is one in every frame


def test_nothing_is_carried_on_without_a_drone_or_a_height_to_carry_from() -> None:
    reading = _hear(LEVEL, _at(0, 1.0), _range(0, 10)).view.range_down
    assert reading is not None
    drone = Drone(position_enu_m=np.zeros(3), velocity_enu_m_s=np.zeros(3), yaw_rad=0.0, age_s=0.0)
    assert range_carried_m(None, reading, 0.0, NOW_NS) is None
    assert range_carried_m(drone, None, 0.0, NOW_NS) is None
    assert range_carried_m(drone, replace(reading, own=None), 0.0, NOW_NS) is None
