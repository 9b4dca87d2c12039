from math import inf, nan, pi

import numpy as np
import pytest

from link.frames.geodesy import Datum, LocalFrame, Projection, geodetic_from_enu
from link.mavlink.dialect import Message, mavlink
from link.records import replace
from sim_autopilot.boot import initial_memory
from sim_autopilot.core.data import Array, Reference
from sim_autopilot.core.places import Origin
from sim_autopilot.setpoints.setpoints import (
    NO_SETPOINTS,
    are_fresh,
    are_streaming,
    reference_from_message,
    with_setpoint,
)
from tests.sim_autopilot.pilot import DATUM, START_NS, Pilot, arm, px4, set_mode, setpoint

PLACE_NAMES = ("latitude_rad", "longitude_rad", "altitude_m")
FRAMES = frozenset({mavlink.MAV_FRAME_LOCAL_NED, mavlink.MAV_FRAME_BODY_NED})
ORIGIN_ENU_M = (100.0, 200.0, 30.0)
ORIGIN = Origin(
    world=DATUM,
    frame=LocalFrame(
        origin=Datum(**dict(zip(PLACE_NAMES, geodetic_from_enu(DATUM, ORIGIN_ENU_M), strict=True))),
        projection=Projection.TANGENT_PLANE,
    ),
    position_enu_m=ORIGIN_ENU_M,
)
YAW_RAD = 0.7
NOW = replace(initial_memory(px4(), START_NS).now, position_enu_m=(104.0, 203.0, 31.0), yaw_rad=YAW_RAD)


def message(mask: int, frame: int = mavlink.MAV_FRAME_LOCAL_NED, **fields: float) -> Message:
    values = {"x": 1.0, "y": 2.0, "z": -3.0, "vx": 4.0, "vy": 5.0, "vz": -6.0, "afx": 0.7, "afy": 0.8, "afz": -0.9}
    values |= {"yaw": 0.3, "yaw_rate": 0.2} | fields
    return mavlink.MAVLink_set_position_target_local_ned_message(0, 1, 1, frame, mask, **values)


def understood(mask: int, frame: int = mavlink.MAV_FRAME_LOCAL_NED, **fields: float) -> Reference | None:
    return reference_from_message(message(mask, frame, **fields), FRAMES, ORIGIN, NOW)


def near(vector: Array | None, expected: tuple[float, float, float]) -> bool:
    return vector is not None and np.allclose(vector, expected)


def test_all_groups_turn_from_ned_about_the_origin_to_enu() -> None:
    reference = understood(0)
    assert reference is not None
    assert near(reference.position_enu_m, (102.0, 201.0, 33.0))
    assert near(reference.velocity_enu_m_s, (5.0, 4.0, 6.0))
    assert near(reference.acceleration_enu_m_s2, (0.8, 0.7, 0.9))
    assert reference.yaw_rad == pytest.approx(pi / 2.0 - 0.3)
    assert reference.yaw_rate_rad_s == -0.2


def test_masked_groups_are_left_out_even_when_they_hold_no_numbers() -> None:
    reference = understood(0b1101_1100_0111, x=nan, y=inf, z=nan, afx=nan, yaw=nan, yaw_rate=nan)
    assert reference is not None
    assert reference.position_enu_m is None
    assert reference.acceleration_enu_m_s2 is None
    assert reference.yaw_rad is None
    assert reference.yaw_rate_rad_s is None


@pytest.mark.parametrize("bit", [0, 1, 3, 4, 6, 7])
def test_a_setpoint_that_gives_north_without_east_is_dropped(bit: int) -> None:
    assert understood(1 << bit) is None


@pytest.mark.parametrize("mask", [0b111_011_011, 0b111_111_011, 0b111_100_111, 0b111_111_111])
def test_a_setpoint_that_leaves_an_axis_without_anything_is_dropped(mask: int) -> None:
    assert understood(0b1100_0000_0000 | mask) is None


def test_an_axis_that_is_masked_is_free_and_may_hold_no_number() -> None:
    reference = understood(0b1101_1110_0011, x=nan, y=inf, vz=nan)
    assert reference is not None
    assert reference.free_position == (True, True, False)
    assert reference.free_velocity == (False, False, False)
    assert reference.height_m == pytest.approx(33.0, abs=1e-3)
    assert near(reference.velocity_enu_m_s, (5.0, 4.0, 0.0))


@pytest.mark.slow
def test_a_height_and_a_horizontal_velocity_are_flown_together() -> None:
    pilot = Pilot()
    pilot.take_off(5.0)
    mixed = setpoint((nan, nan, -8.0), (2.0, 1.0, nan), mask=0b1001_1110_0011)
    pilot.run(6.0, lambda _t: mixed)
    assert pilot.position[2] == pytest.approx(8.0, abs=0.1)
    assert pilot.node.state.velocity_enu_m_s == pytest.approx((1.0, 2.0, 0.0), abs=0.15)


def _slowed(mask: int) -> list[float]:
    """Speeds northward after one of 4 m/s was asked for, and then one of 2 m/s, every 0.1 s."""
    pilot, speeds = Pilot(), list[float]()
    pilot.take_off(5.0)
    fast, slow = (setpoint((nan, nan, -5.0), (speed, 0.0, 0.0), mask=mask) for speed in (4.0, 2.0))
    pilot.run(3.0, lambda _t: fast)
    for _ in range(20):
        pilot.run(0.1, lambda _t: slow)
        speeds.append(float(pilot.node.state.velocity_enu_m_s[1]))
    return speeds


@pytest.mark.slow
def test_a_velocity_is_flown_no_otherwise_for_a_height_beside_it() -> None:
    # what steadies the place of a moving setpoint must not hold on to one that nobody asked for
    assert _slowed(0b1001_1110_0011) == pytest.approx(_slowed(0b1001_1100_0111), abs=0.02)


@pytest.mark.slow
def test_a_climb_rate_over_a_held_place_takes_off_and_keeps_the_place() -> None:
    pilot = Pilot()
    rise = setpoint((0.0, 0.0, nan), (nan, nan, -1.0), mask=0b1001_1101_1100)
    pilot.run(0.2, lambda _t: rise)
    pilot.step(set_mode(6), arm())
    pilot.run(8.0, lambda _t: rise)
    assert pilot.node.state.velocity_enu_m_s == pytest.approx((0.0, 0.0, 1.0), abs=0.15)
    assert pilot.position[:2] == pytest.approx((0.0, 0.0), abs=0.1)


@pytest.mark.parametrize("name", ["x", "y", "z", "vx", "vy", "vz", "afx", "afy", "afz", "yaw", "yaw_rate"])
@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_a_used_field_that_is_not_finite_drops_the_setpoint(name: str, value: float) -> None:
    spoilt = message(0)
    setattr(spoilt, name, value)
    assert reference_from_message(spoilt, FRAMES, ORIGIN, NOW) is None


@pytest.mark.parametrize("frame", [frame for frame in range(22) if frame not in FRAMES])
def test_other_frames_are_dropped(frame: int) -> None:
    assert understood(0, frame) is None


def test_a_force_setpoint_is_dropped() -> None:
    assert understood(0b10_0000_0000) is None


def test_a_setpoint_without_any_group_is_dropped() -> None:
    assert understood(0b1_1111_1111) is None


def test_the_body_frame_turns_velocity_by_the_heading_and_leaves_position_out() -> None:
    forward = understood(0, mavlink.MAV_FRAME_BODY_NED, vx=2.0, vy=0.0)
    assert forward is not None
    assert forward.position_enu_m is None
    assert near(forward.velocity_enu_m_s, (2.0 * np.cos(YAW_RAD), 2.0 * np.sin(YAW_RAD), 6.0))
    right = understood(0, mavlink.MAV_FRAME_BODY_NED, vx=0.0, vy=2.0)
    assert right is not None
    assert near(right.velocity_enu_m_s, (2.0 * np.sin(YAW_RAD), -2.0 * np.cos(YAW_RAD), 6.0))


def test_setpoints_are_fresh_until_the_loss_time_is_over() -> None:
    reference = understood(0)
    assert reference is not None
    setpoints = with_setpoint(NO_SETPOINTS, reference, 5_000_000_000, 1.0)
    assert are_fresh(setpoints, 6_000_000_000, 1.0)
    assert not are_fresh(setpoints, 6_010_000_000, 1.0)
    assert not are_fresh(NO_SETPOINTS, 0, 1.0)


def test_a_stream_counts_from_its_first_setpoint_after_a_gap() -> None:
    reference = understood(0)
    assert reference is not None
    setpoints = with_setpoint(NO_SETPOINTS, reference, 0, 1.0)
    for boot_ns in (50_000_000, 100_000_000, 3_000_000_000, 3_100_000_000):
        setpoints = with_setpoint(setpoints, reference, boot_ns, 1.0)
    assert not are_streaming(setpoints, 3_100_000_000, 1.0, 0.2)
    assert are_streaming(setpoints, 3_200_000_000, 1.0, 0.2)
