"""The autopilot's messages as the step sees them; what is absurd changes nothing."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.autopilots.driver import Driver
from companion.autopilots.px4 import Px4Driver
from companion.autopilots.state import AutopilotState, shift_reports, update_state
from link.frames.geodesy import Projection
from link.frames.rotations import quaternion_ned_frd_from_enu_flu
from link.mavlink.clock_map import ClockMap, with_round_trip, with_system_time
from link.mavlink.clock_map import RoundTrip as Trip
from link.mavlink.dialect import Message, mavlink
from link.messages import Vector3
from tests.companion.world import START_NS

DRIVER = Px4Driver()
BOOT_MS = 50_000
_TRIP = Trip(sent_ns=START_NS, received_ns=START_NS + 1_000_000, boot_ns=BOOT_MS * 1_000_000)
CLOCK = with_system_time(with_round_trip(ClockMap(), _TRIP), BOOT_MS * 1_000_000, START_NS)
LEVEL = mavlink.MAVLink_attitude_quaternion_message(BOOT_MS, 1.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.3)


def _hear(*messages: Message, state: AutopilotState | None = None) -> AutopilotState:
    state = AutopilotState() if state is None else state
    for message in messages:
        state = update_state(state, message, CLOCK, DRIVER)
    return state


def _at(after_ms: int, place_ned_m: Vector3, velocity_ned_m_s: Vector3 = (0.0, 0.0, 0.0)) -> Message:
    return mavlink.MAVLink_local_position_ned_message(BOOT_MS + after_ms, *place_ned_m, *velocity_ned_m_s)


def _leaning(boot_ms: int, roll_rad: float) -> Message:
    w, x = math.cos(0.5 * roll_rad), math.sin(0.5 * roll_rad)
    return mavlink.MAVLink_attitude_quaternion_message(boot_ms, w, x, 0.0, 0.0, 0.0, 0.0, 0.0)


def _origin(latitude_1e7: int, longitude_1e7: int, altitude_mm: int) -> Message:
    return mavlink.MAVLink_gps_global_origin_message(latitude_1e7, longitude_1e7, altitude_mm)


def test_position_is_turned_to_enu_and_stamped_in_utc() -> None:
    state = _hear(LEVEL, _at(20, (1.0, 2.0, -3.0), (0.1, 0.2, -0.3)))
    assert state.own is not None
    assert state.own.position_enu_m == pytest.approx((2.0, 1.0, 3.0))
    assert state.own.velocity_enu_m_s == pytest.approx((0.2, 0.1, 0.3))
    assert state.own.angular_velocity_flu_rad_s == pytest.approx((0.1, -0.2, -0.3))
    assert abs(state.own.t_ns - (START_NS + 20_000_000)) < 1_000_000


@given(yaw_rad=st.floats(-3.1, 3.1))
def test_attitude_is_the_one_that_was_sent(yaw_rad: float) -> None:
    q = (math.cos(yaw_rad / 2), 0.0, 0.0, math.sin(yaw_rad / 2))
    w, x, y, z = quaternion_ned_frd_from_enu_flu(q)
    state = _hear(mavlink.MAVLink_attitude_quaternion_message(BOOT_MS, w, x, y, z, 0.0, 0.0, 0.0))
    assert state.orientation_wxyz is not None
    assert abs(np.dot(state.orientation_wxyz, q)) == pytest.approx(1.0, abs=1e-9)


def test_position_without_an_attitude_is_not_yet_a_state() -> None:
    assert _hear(_at(0, (0.0, 0.0, 0.0))).own is None


def test_age_of_the_attitude_is_told_with_each_position() -> None:
    state = _hear(LEVEL, _at(20, (0.0, 0.0, 0.0)), _at(700, (0.4, 0.0, 0.0)))
    assert [own.attitude_age_s for own in state.history] == pytest.approx([0.02, 0.7])
    newer = mavlink.MAVLink_attitude_quaternion_message(BOOT_MS + 715, 1.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.3)
    (*_, newest) = _hear(newer, _at(710, (0.4, 0.0, 0.0)), state=state).history
    assert newest.attitude_age_s == 0.0


@pytest.mark.parametrize("late_ms", [0, 20, 500, 1000])
def test_late_and_doubled_attitudes_are_passed_over(late_ms: int) -> None:
    state = _hear(_leaning(BOOT_MS + 1000, 0.1), _leaning(BOOT_MS + 1000 - late_ms, 0.9))
    assert state == _hear(_leaning(BOOT_MS + 1000, 0.1))
    assert _hear(_leaning(BOOT_MS - 5000, 0.9), state=state) != state


def test_attitude_and_place_without_a_stamp_say_nothing() -> None:
    state = _hear(LEVEL, _at(0, (0.0, 0.0, 0.0)))
    assert _hear(_leaning(0, 0.9), _at(-BOOT_MS, (9.0, 0.0, 0.0)), state=state) == state


def test_late_and_doubled_positions_are_passed_over() -> None:
    state = _hear(LEVEL, _at(0, (0.0, 0.0, 0.0)), _at(40, (0.4, 0.0, 0.0)))
    assert _hear(_at(20, (0.2, 0.0, 0.0)), _at(40, (9.0, 0.0, 0.0)), state=state).own == state.own


def test_clock_that_was_set_back_does_not_silence_the_drone() -> None:
    state = _hear(LEVEL, _at(40_000, (0.0, 0.0, 0.0)))
    after = _hear(_at(0, (0.1, 0.0, 0.0)), state=state)
    assert after.own is not None
    assert len(after.history) == 1
    assert after.own.position_enu_m == pytest.approx((0.0, 0.1, 0.0))


def test_jump_that_flying_cannot_explain_is_a_shift_of_the_frame() -> None:
    state = _hear(LEVEL, _at(0, (0.0, 0.0, 0.0), (10.0, 0.0, 0.0)), _at(20, (0.2, 0.0, 0.0), (10.0, 0.0, 0.0)))
    assert state.view.frame_moves.shift_enu_m == (0.0, 0.0, 0.0)
    jumped = _hear(_at(40, (5.4, -3.0, 0.5), (10.0, 0.0, 0.0)), state=state)
    assert jumped.view.frame_moves.shift_enu_m == pytest.approx((-3.0, 5.0, -0.5))
    back = _hear(_at(60, (0.6, 0.0, 0.0), (10.0, 0.0, 0.0)), state=jumped)
    assert back.view.frame_moves.shift_enu_m == pytest.approx((0.0, 0.0, 0.0))


@given(wrong=st.tuples(*[st.floats(-99.0, 99.0)] * 3))
def test_single_velocity_that_is_wrong_is_no_shift(wrong: Vector3) -> None:
    told = [_at(ms, (ms * 0.01, 0.0, 0.0), wrong if ms == 40 else (10.0, 0.0, 0.0)) for ms in (0, 20, 40, 60, 80)]
    assert _hear(LEVEL, *told).view.frame_moves.shift_enu_m == (0.0, 0.0, 0.0)


def test_velocity_that_no_drone_has_is_no_report() -> None:
    state = _hear(LEVEL, _at(0, (0.0, 0.0, 0.0)))
    assert _hear(_at(20, (0.0, 0.0, 0.0), (0.0, 0.0, 101.0)), state=state) == state


@pytest.mark.parametrize("at_once_m", [0.11, 0.18])
def test_correction_with_a_fix_is_no_shift_and_a_larger_one_is(at_once_m: float) -> None:
    state = _hear(LEVEL, _at(0, (0.0, 0.0, 0.0), (5.0, 0.0, 0.0)), _at(20, (0.1 + at_once_m, 0.0, 0.0)))
    assert any(state.view.frame_moves.shift_enu_m) is (at_once_m > 0.15)


@given(gap_ms=st.integers(4, 900), braking=st.floats(0.0, 8.0), speed=st.floats(0.0, 20.0))
def test_hard_flying_over_a_gap_in_the_link_is_no_shift(gap_ms: int, braking: float, speed: float) -> None:
    gap_s = gap_ms * 1e-3
    place = (speed * gap_s - 0.5 * braking * gap_s**2, 0.0, 0.0)
    state = _hear(LEVEL, _at(0, (0.0, 0.0, 0.0), (speed, 0.0, 0.0)), _at(gap_ms, place))
    assert state.view.frame_moves.shift_enu_m == (0.0, 0.0, 0.0)


def test_moved_origin_is_counted_and_a_repeated_one_is_not() -> None:
    state = _hear(_origin(475_000_000, 80_000_000, 400_000), _origin(475_000_000, 80_000_000, 400_000))
    assert state.view.frame_moves.origin_count == 1
    moved = _hear(*2 * [_origin(475_000_200, 80_000_000, 400_000)], state=state)
    assert moved.view.frame_moves.origin_count == 2
    assert _hear(*2 * [_origin(475_000_000, 80_000_000, 401_000)], state=state).view.frame_moves.origin_count == 2


def test_steps_before_an_origin_that_they_do_not_explain_are_none_since_then() -> None:
    told = (LEVEL, _at(0, (0.0, 0.0, 0.0)), _at(20, (-2.3, 0.0, -0.9)))
    state = _hear(_origin(475_000_000, 80_000_000, 400_000), *told)
    assert state.view.frame_moves.since_origin_enu_m == pytest.approx((0.0, -2.3, 0.9))
    other = _origin(475_000_400, 80_000_000, 400_000)
    moved = _hear(other, _at(40, (-2.3, 0.0, -0.9)), other, state=state)
    assert moved.view.frame_moves.since_origin_enu_m == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("steps_first", [True, False])
def test_origin_that_moves_by_what_the_drone_stepped_leaves_the_ground_known(*, steps_first: bool) -> None:
    known, other = _origin(475_000_000, 80_000_000, 400_000), _origin(475_000_200, 80_000_000, 399_000)
    before, steps, after = _at(0, (0.0, 0.0, 0.0)), _at(20, (-2.3, 0.0, -0.9)), _at(40, (-2.3, 0.0, -0.9))
    order = (steps, other, after, other) if steps_first else (other, other, steps, other)
    state = _hear(known, LEVEL, before, *order)
    moves = state.view.frame_moves
    assert moves.origin_count == 1
    assert moves.shift_enu_m == pytest.approx((0.0, -2.3, 0.9))
    assert moves.origin_shift_enu_m == pytest.approx((0.0, -2.22, 1.0), abs=0.01)
    another = _origin(475_000_400, 80_000_000, 399_000)
    again = _hear(another, _at(60, (-2.3, 0.0, -0.9)), another, state=state).view.frame_moves
    assert again.origin_count == 2


@pytest.mark.parametrize("steps_first", [True, False])
@pytest.mark.parametrize(("north_1e7", "is_taken"), [(200, True), (160, True), (90, False), (-200, False)])
def test_origin_that_the_drone_has_stepped_with_is_taken_at_once(
    north_1e7: int, *, is_taken: bool, steps_first: bool
) -> None:
    known, other = _origin(475_000_000, 80_000_000, 400_000), _origin(475_000_000 + north_1e7, 80_000_000, 400_000)
    before, steps = _at(0, (0.0, 0.0, 0.0)), _at(20, (-2.2, 0.0, 0.0))
    state = _hear(known, LEVEL, before, *((steps, other) if steps_first else (other, steps)))
    assert state.view.frame is not None
    assert (state.view.frame.origin.latitude_rad > math.radians(47.5)) is is_taken
    assert any(state.view.frame_moves.origin_shift_enu_m) is is_taken
    assert state.view.frame_moves.origin_count == 1


def test_origin_that_is_near_the_known_one_is_not_taken_for_the_drones_corrections() -> None:
    known, near = _origin(475_000_000, 80_000_000, 400_000), _origin(475_000_030, 80_000_000, 400_000)
    state = _hear(known, LEVEL, _at(0, (0.0, 0.0, 0.0)), _at(20, (-0.33, 0.0, 0.0)))
    assert any(state.view.frame_moves.shift_enu_m)
    assert _hear(near, state=state).view.frame == state.view.frame


@given(others=st.lists(st.integers(480_000_000, 490_000_000), unique=True, max_size=5))
def test_other_origins_that_are_told_once_each_move_nothing(others: list[int]) -> None:
    known = _origin(475_000_000, 80_000_000, 400_000)
    doubted = [_origin(latitude_1e7, 80_000_000, 400_000) for latitude_1e7 in others]
    before = _hear(known)
    assert _hear(*doubted, state=before).view == before.view
    assert _hear(*doubted, known, *doubted[-1:], state=before).view == before.view


@pytest.mark.parametrize("by_ns", [0, 5_000_000, -3_600_000_000_000])
def test_utc_that_is_set_meanwhile_makes_no_doubled_origin_believed(by_ns: int) -> None:
    other = _origin(475_000_200, 80_000_000, 400_000)
    doubted = _hear(_origin(475_000_000, 80_000_000, 400_000), LEVEL, _at(0, (0.0, 0.0, 0.0)), other)
    put_off = shift_reports(doubted, by_ns)
    assert _hear(other, state=put_off).view.frame_moves.origin_count == 1


def test_step_of_the_drones_own_place_is_put_off_with_its_report() -> None:
    stepped = shift_reports(_hear(LEVEL, _at(0, (0.0, 0.0, 0.0)), _at(20, (5.0, 0.0, 0.0))), 5_000_000)
    assert stepped.own is not None
    assert stepped.view.frame_moves.stepped_ns == stepped.own.t_ns


@pytest.mark.parametrize(
    ("driver", "projection"), [(Px4Driver(), Projection.PX4), (ArduPilotDriver(), Projection.ARDUPILOT)]
)
def test_frame_is_laid_out_as_the_driver_says(driver: Driver, projection: Projection) -> None:
    state = update_state(AutopilotState(), _origin(475_000_000, 80_000_000, 400_000), CLOCK, driver)
    assert state.view.frame is not None
    assert state.view.frame.projection is projection


def test_origin_that_is_nearly_the_same_moves_nothing_so_that_none_creeps() -> None:
    known = _hear(_origin(475_000_000, 80_000_000, 400_000))
    state = _hear(*20 * [_origin(475_000_005, 80_000_000, 400_000)], state=known)  # 5.6 cm
    assert state.view.frame == known.view.frame
    assert _hear(_origin(475_000_010, 80_000_000, 400_000), state=state).view.frame == known.view.frame


def test_the_same_origin_of_another_kind_of_autopilot_is_another_frame() -> None:
    state = _hear(_origin(475_000_000, 80_000_000, 400_000))
    other = update_state(state, _origin(475_000_000, 80_000_000, 400_000), CLOCK, ArduPilotDriver())
    assert other.view.frame is not None
    assert other.view.frame.projection is Projection.ARDUPILOT
    assert other.view.frame_moves.origin_count == 2


def test_origin_off_the_earth_is_no_origin() -> None:
    assert _hear(_origin(910_000_000, 0, 0), _origin(0, 1_900_000_000, 0)).view.frame is None


def _receiver(fix: int, msl_mm: int, ellipsoid_mm: int) -> Message:
    return mavlink.MAVLink_gps_raw_int_message(
        0, fix, 475_000_000, 80_000_000, msl_mm, 1, 1, 0, 0, 9, alt_ellipsoid=ellipsoid_mm
    )


@pytest.mark.parametrize("first", [0, 1])
def test_origins_altitude_is_above_the_ellipsoid_whatever_comes_first(first: int) -> None:
    told = [_origin(475_000_000, 80_000_000, 400_000), _receiver(3, 410_000, 457_300)]
    state = _hear(told[first], told[1 - first])
    assert state.view.frame is not None
    assert state.view.frame.origin.altitude_m == pytest.approx(447.3)
    again = _hear(_receiver(3, 430_000, 477_500), state=state)
    assert again.view == state.view


@pytest.mark.parametrize("receiver", [_receiver(1, 0, 47_000), _receiver(3, 400_000, 0), _receiver(3, 0, 900_000)])
def test_receiver_that_does_not_know_the_geoid_says_nothing(receiver: Message) -> None:
    state = _hear(_origin(475_000_000, 80_000_000, 400_000), receiver)
    assert state.view.frame is not None
    assert state.view.frame.origin.altitude_m == 400.0
    assert not state.view.receiver.knows_geoid


@pytest.mark.parametrize("geoid_mm", [-32_400, -950, -3, 0, 600, 990, 47_300])
def test_first_geoid_height_is_taken_whatever_it_is(geoid_mm: int) -> None:
    state = _hear(_origin(475_000_000, 80_000_000, 400_000), _receiver(3, 410_000, 410_000 + geoid_mm))
    assert state.view.frame is not None
    assert state.view.receiver.knows_geoid
    assert state.view.frame.origin.altitude_m == pytest.approx(400.0 + geoid_mm * 1e-3, abs=0.05)


def test_later_geoid_height_counts_when_it_is_told_again() -> None:
    state = _hear(_origin(475_000_000, 80_000_000, 400_000), _receiver(3, 410_000, 410_600))
    near = _hear(_receiver(3, 410_000, 411_500), state=state)
    assert near.view == state.view
    once = _hear(_receiver(3, 410_000, 411_700), state=state)
    assert once.view == state.view
    assert _hear(_receiver(3, 410_000, 410_600), _receiver(3, 410_000, 411_700), state=once).view == state.view
    twice = _hear(_receiver(3, 410_000, 411_700), state=once)
    assert twice.view.frame is not None
    assert twice.view.frame.origin.altitude_m == pytest.approx(401.7)


def _beat(base_mode: int) -> Message:
    return mavlink.MAVLink_heartbeat_message(2, 12, base_mode, 0x0006_0000, 4, 3)


def _flying_with_geoid(*told_mm: int) -> AutopilotState:
    """An armed drone 10 m above its origin whose receiver has told these heights of the geoid."""
    receivers = [_receiver(3, 410_000, 410_000 + geoid_mm) for geoid_mm in told_mm]
    return _hear(_beat(217), _origin(475_000_000, 80_000_000, 400_000), *receivers, *_hover(0, 10.0))


def _hover(since_ms: int, height_m: float) -> list[Message]:
    return [LEVEL, *(_at(since_ms + 20 * number, (0.0, 0.0, -height_m)) for number in range(1, 6))]


def _origin_altitude_m(state: AutopilotState) -> float:
    assert state.view.frame is not None
    return state.view.frame.origin.altitude_m


def test_sure_geoid_height_is_kept_while_the_drone_flies() -> None:
    state = _hear(*10 * [_receiver(3, 410_000, 413_600)], state=_flying_with_geoid(600, 600))
    assert _origin_altitude_m(state) == pytest.approx(400.6)
    disarmed = _hear(*2 * [_beat(29)], _receiver(3, 410_000, 413_600), state=state)
    assert _origin_altitude_m(disarmed) == pytest.approx(403.6)


def test_geoid_height_that_was_told_once_before_is_replaced_in_flight() -> None:
    state = _hear(*2 * [_receiver(3, 410_000, 413_600)], state=_flying_with_geoid(600))
    assert _origin_altitude_m(state) == pytest.approx(403.6)


def test_geoid_height_with_which_the_drones_own_has_stepped_counts_in_flight() -> None:
    stepped = _hear(*_hover(100, 7.0), state=_flying_with_geoid(600, 600))
    state = _hear(*2 * [_receiver(3, 407_000, 410_600)], state=stepped)
    assert _origin_altitude_m(state) == pytest.approx(403.6)
    assert state.view.frame_moves.origin_count == stepped.view.frame_moves.origin_count


@pytest.mark.parametrize(("fix", "is_fixed"), [(3, False), (5, False), (6, True)])
def test_receiver_tells_whether_its_phases_are_fixed(fix: int, *, is_fixed: bool) -> None:
    state = _hear(_receiver(fix, 410_000, 457_300))
    assert state.view.receiver.is_fixed is is_fixed


@pytest.mark.parametrize(
    ("fixes", "is_fixed"),
    [
        ((6, 5), True),  # one bad epoch
        ((6, 5, 6, 5), True),
        ((6, 5, 5), False),
        ((6, 5, 1), False),
        ((5, 6), False),
        ((5, 6, 5, 6), False),
        ((5, 6, 6), True),
    ],
)
def test_whether_phases_are_fixed_counts_when_it_is_told_again(fixes: tuple[int, ...], *, is_fixed: bool) -> None:
    state = _hear(*(_receiver(fix, 410_000, 457_300) for fix in fixes))
    assert state.view.receiver.is_fixed is is_fixed


@pytest.mark.parametrize(
    ("fixes", "has_fix"),
    [
        ((), None),
        ((0,), None),  # has no receiver
        ((0, 0), None),
        ((1,), False),
        ((2,), False),
        ((3,), True),
        ((6,), True),
        ((3, 0), True),  # one bad epoch
        ((3, 1, 3, 1), True),
        ((3, 0, 0), False),  # has fallen silent
        ((3, 0, 2), False),
        ((1, 0), False),
        ((0, 3, 1), True),
        ((1, 3), False),
        ((1, 3, 6), True),
    ],
)
def test_receiver_tells_whether_it_has_a_fix(fixes: tuple[int, ...], *, has_fix: bool | None) -> None:
    state = _hear(*(_receiver(fix, 410_000, 457_300) for fix in fixes))
    assert state.view.receiver.has_fix is has_fix


OFFBOARD, LOITER, GUIDED, RTL = 0x0006_0000, 0x0304_0000, 4, 6


@pytest.mark.parametrize(
    ("driver", "mode", "status", "failsafe", "warns"),
    [
        (Px4Driver(), OFFBOARD, 3, False, False),
        (Px4Driver(), OFFBOARD, 4, False, False),
        (Px4Driver(), OFFBOARD, 5, True, False),
        (Px4Driver(), OFFBOARD, 6, True, False),
        (Px4Driver(), LOITER, 5, True, False),
        (ArduPilotDriver(), GUIDED, 4, False, False),
        (ArduPilotDriver(), GUIDED, 5, False, True),
        (ArduPilotDriver(), GUIDED, 6, True, False),
        (ArduPilotDriver(), RTL, 5, True, False),
    ],
)
def test_failsafe_is_read_off_the_heartbeat(
    driver: Driver, mode: int, status: int, *, failsafe: bool, warns: bool
) -> None:
    heartbeat = mavlink.MAVLink_heartbeat_message(2, driver.autopilot_id, 0x91, mode, status, 3)
    view = update_state(AutopilotState(), heartbeat, CLOCK, driver).view
    assert (view.failsafe, view.warns) == (failsafe, warns)
    assert view.armed
    assert view.in_control is (mode in (OFFBOARD, GUIDED))


def test_mode_is_known_from_the_quicker_message() -> None:
    state = _hear(mavlink.MAVLink_heartbeat_message(2, 12, 0x91, 0x0006_0000, 4, 3))
    state = _hear(mavlink.MAVLink_current_mode_message(0, 0x0003_0000, 0x0003_0000), state=state)
    assert not state.view.in_control


@pytest.mark.parametrize(
    ("flown", "asked", "overruled"),
    [(0x0304_0000, 0x0006_0000, True), (0x0304_0000, 0x0304_0000, False), (0x0006_0000, 0x0006_0000, False)],
)
def test_mode_that_nobody_asked_for_is_a_failsafes(flown: int, asked: int, overruled: bool) -> None:
    state = _hear(mavlink.MAVLink_current_mode_message(0, flown, asked))
    assert state.view.overruled is overruled


@pytest.mark.parametrize(("landed_state", "landed"), [(0, None), (1, True), (2, False), (3, False), (4, False)])
def test_landed_is_unknown_until_said(landed_state: int, landed: bool | None) -> None:
    assert _hear(mavlink.MAVLink_extended_sys_state_message(0, landed_state)).view.landed is landed


any_float = st.one_of(st.floats(width=32), st.sampled_from([math.nan, math.inf, -math.inf, 3e38]))
uint32 = st.integers(0, 2**32 - 1)
messages = st.one_of(
    st.builds(mavlink.MAVLink_local_position_ned_message, uint32, *[any_float] * 6),
    st.builds(mavlink.MAVLink_attitude_quaternion_message, uint32, *[any_float] * 7),
    st.builds(mavlink.MAVLink_heartbeat_message, *[st.integers(0, 255)] * 3, uint32, *[st.integers(0, 255)] * 2),
    st.builds(mavlink.MAVLink_current_mode_message, st.integers(0, 255), uint32, uint32),
    st.builds(mavlink.MAVLink_extended_sys_state_message, st.integers(0, 255), st.integers(0, 255)),
    st.builds(mavlink.MAVLink_gps_global_origin_message, *[st.integers(-(2**31), 2**31 - 1)] * 3),
)


@pytest.mark.slow
@given(told=st.lists(messages, max_size=12))
@settings(max_examples=100, deadline=None)
def test_no_message_whatever_makes_the_state_absurd(told: list[Message]) -> None:
    state = _hear(LEVEL, *told)
    for own in state.history:
        assert np.isfinite((*own.position_enu_m, *own.velocity_enu_m_s, *own.angular_velocity_flu_rad_s)).all()
        assert np.linalg.norm(own.orientation_wxyz) == pytest.approx(1.0)
        assert max(map(abs, own.position_enu_m)) < 1e6
    times = [own.t_ns for own in state.history]
    assert times == sorted(set(times))
    assert np.isfinite(state.view.frame_moves.shift_enu_m).all()


def test_stop_within_one_report_is_a_jolt_and_hard_braking_is_none() -> None:
    places_m = (0.0, 0.1, 0.2, 0.3, 0.4, 0.45)  # as far as the velocities lead
    stopped = _hear(
        LEVEL, *(_at(20 * k, (x, 0.0, -1.0), (5.0 if k < 5 else 0.0, 0.0, 0.0)) for k, x in enumerate(places_m))
    )
    assert stopped.own is not None
    assert stopped.own.jolt_m_s2 == pytest.approx(5.0 / 0.06)
    braking = _hear(
        LEVEL, *(_at(20 * k, (0.1 * k - 0.002 * k**2, 0.0, -1.0), (5.0 - 0.2 * k, 0.0, 0.0)) for k in range(6))
    )
    assert braking.own is not None
    assert braking.own.jolt_m_s2 == pytest.approx(10.0)


def test_of_a_flood_of_texts_the_newest_wait_for_the_log() -> None:
    texts = [mavlink.MAVLink_statustext_message(6, f"text {number}".encode()) for number in range(300)]
    state = AutopilotState()
    for text in texts:
        state = update_state(state, text, CLOCK, ArduPilotDriver())
    assert state.texts == tuple(f"text {number}" for number in range(250, 300))
