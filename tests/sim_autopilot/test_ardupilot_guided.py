"""ArduCopter's GUIDED, against what was measured on the real one; each tolerance is stated beside its figure."""

from collections.abc import Callable
from math import atan2, cos, degrees, hypot, inf, nan, radians, sin

import pytest

from link.mavlink.dialect import Message, mavlink
from sim_autopilot.core.places import local_from_world
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.physics.airframe import ARDUCOPTER_AIRFRAME
from sim_autopilot.plant.config import PlantConfig
from tests.sim_autopilot.copter import (
    GUIDED,
    LAND,
    LOITER,
    ardupilot,
    copter_in_the_air,
    every,
    mode,
    take_off,
)
from tests.sim_autopilot.pilot import Pilot, arm

pytestmark = pytest.mark.slow

ACCEPTED, FAILED = 0, 4
POSITION, FOLLOW, FOLLOW_ALL, VELOCITY = 0b1001_1111_1000, 0b1001_1100_0000, 0b1000_0000_0000, 0b1001_1100_0111
Vector = tuple[float, float, float]
ZERO = (0.0, 0.0, 0.0)
Course = Callable[[float], tuple[Vector, Vector, Vector]]
EXTENDED_SYS_STATE = 245


def setpoint(
    mask: int,
    position: Vector = ZERO,
    velocity: Vector = ZERO,
    acceleration: Vector = ZERO,
    *,
    frame: int = 1,
    yaw: float = 0.0,
    rate: float = 0.0,
) -> Message:
    return mavlink.MAVLink_set_position_target_local_ned_message(
        0, 1, 1, frame, mask, *position, *velocity, *acceleration, yaw, rate
    )


def north(speed_m_s: float, ramp_m_s2: float = inf) -> Course:
    """North at 10 m of height, from rest by a step or a ramp."""

    def at(t_s: float) -> tuple[Vector, Vector, Vector]:
        ramp_s = speed_m_s / ramp_m_s2
        if t_s < ramp_s:
            return (0.5 * ramp_m_s2 * t_s**2, 0.0, -10.0), (ramp_m_s2 * t_s, 0.0, 0.0), (ramp_m_s2, 0.0, 0.0)
        return (speed_m_s * (t_s - 0.5 * ramp_s), 0.0, -10.0), (speed_m_s, 0.0, 0.0), ZERO

    return at


def draggy(**parameters: float) -> AutopilotConfig:
    """With the drag of ArduCopter's own simulated quadrotor."""
    return ardupilot(plant=PlantConfig(airframe=ARDUCOPTER_AIRFRAME), parameters=parameters)


def circle(radius_m: float, speed_m_s: float = 5.0) -> Course:
    rate = speed_m_s / radius_m

    def at(t_s: float) -> tuple[Vector, Vector, Vector]:
        c, s = cos(rate * t_s), sin(rate * t_s)
        position = (radius_m * (c - 1.0), radius_m * s, -10.0)
        return position, (-speed_m_s * s, speed_m_s * c, 0.0), (-speed_m_s * rate * c, -speed_m_s * rate * s, 0.0)

    return at


def flown(course: Course, mask: int, duration_s: float, config: AutopilotConfig | None = None) -> tuple[Pilot, float]:
    """A drone that has flown the course, and the time at which it began."""
    pilot = copter_in_the_air(config)
    began_s = pilot.t_s
    pilot.run(duration_s, lambda t_s: setpoint(mask, *course(t_s - began_s)))
    return pilot, began_s


def local_enu_m(pilot: Pilot) -> Vector:
    """Where the drone is in the frame that its setpoints are in."""
    east_m, north_m, up_m = pilot.position.tolist()
    return local_from_world(pilot.node.memory.places.origin, (east_m, north_m, up_m))


def lag_m(speed_m_s: float, mask: int, duration_s: float, ramp_m_s2: float = inf) -> float:
    course = north(speed_m_s, ramp_m_s2)
    pilot, began_s = flown(course, mask, duration_s)
    return local_enu_m(pilot)[1] - course(pilot.t_s - began_s)[0][0]


def outward_m(radius_m: float, mask: int) -> float:
    pilot, _ = flown(circle(radius_m), mask, 30.0)
    east_m, north_m, _ = local_enu_m(pilot)
    return hypot(north_m + radius_m, east_m) - radius_m


def landed_state(pilot: Pilot) -> int:
    return int(pilot.last("EXTENDED_SYS_STATE").landed_state)


def test_a_take_off_lifts_3_5_to_4_s_after_the_command_and_is_at_5_m_after_8_5_s() -> None:
    pilot = Pilot(ardupilot())
    pilot.step(mode(GUIDED), arm(), every(EXTENDED_SYS_STATE, 50.0))
    assert take_off(pilot, 5.0) == [ACCEPTED]
    ground_m = pilot.position[2]
    assert 3.4 <= pilot.run_until(lambda: pilot.position[2] > ground_m + 0.02, 10.0) <= 4.0
    assert landed_state(pilot) == mavlink.MAV_LANDED_STATE_TAKEOFF
    pilot.run_until(lambda: pilot.position[2] > ground_m + 4.95, 10.0)
    assert pilot.t_s == pytest.approx(8.5, abs=1.0)
    pilot.run(1.0)
    assert landed_state(pilot) == mavlink.MAV_LANDED_STATE_IN_AIR
    assert pilot.position[2] - ground_m == pytest.approx(5.0, abs=0.1)


def test_setpoints_never_take_off() -> None:
    pilot = Pilot(ardupilot())
    pilot.step(mode(GUIDED), arm())
    ground_m = pilot.position[2]
    pilot.run(8.0, lambda _: setpoint(POSITION, (0.0, 0.0, -5.0)))
    assert pilot.position[2] == pytest.approx(ground_m, abs=0.01)


def test_a_setpoint_before_the_take_off_completes_silently_cancels_it() -> None:
    pilot = Pilot(ardupilot())
    pilot.step(mode(GUIDED), arm())
    take_off(pilot, 5.0)
    pilot.run(2.0)
    assert pilot.acknowledged(setpoint(POSITION, (0.0, 0.0, -5.0))) == []
    ground_m = pilot.position[2]
    pilot.run(6.0)
    assert pilot.position[2] == pytest.approx(ground_m, abs=0.01)


def test_a_take_off_fails_disarmed_in_another_mode_and_in_the_air() -> None:
    pilot = Pilot(ardupilot())
    pilot.step(mode(GUIDED))
    assert take_off(pilot, 5.0) == [FAILED]
    pilot.step(mode(LOITER), arm())
    assert take_off(pilot, 5.0) == [FAILED]
    assert take_off(copter_in_the_air(), 20.0) == [FAILED]


@pytest.mark.parametrize(
    ("mask", "real_m", "tolerance_m"), [(POSITION, -10.7, 0.2), (FOLLOW, 0.0, 0.02), (VELOCITY, -6.6, 0.2)]
)
def test_at_5_m_s_each_kind_of_setpoint_lags_as_measured(mask: int, real_m: float, tolerance_m: float) -> None:
    assert lag_m(5.0, mask, 20.0) == pytest.approx(real_m, abs=tolerance_m)


def test_a_position_only_chase_at_10_m_s_lags_38_m_and_more_and_more() -> None:
    course = north(10.0)
    pilot, began_s = flown(course, POSITION, 16.0)
    first_m = pilot.position[1] - 10.0 * (pilot.t_s - began_s)
    pilot.run(4.0, lambda t_s: setpoint(POSITION, *course(t_s - began_s)))
    second_m = pilot.position[1] - 10.0 * (pilot.t_s - began_s)
    assert second_m == pytest.approx(-38.0, abs=2.0)
    assert second_m < first_m


@pytest.mark.parametrize(("mask", "real_m"), [(FOLLOW, -23.0), (VELOCITY, -24.7)])
def test_at_10_m_s_the_tilt_limit_against_drag_leaves_it_behind_as_measured(mask: int, real_m: float) -> None:
    course = north(10.0)
    pilot, began_s = flown(course, mask, 14.0, draggy())
    assert pilot.position[1] - course(pilot.t_s - began_s)[0][0] == pytest.approx(real_m, abs=1.2)


def test_the_ceiling_is_10_3_m_s_by_angle_max_and_12_m_s_are_followed_with_more() -> None:
    course = north(13.0, 1.0)
    pilot, _ = flown(course, FOLLOW_ALL, 25.0, draggy())
    assert pilot.node.state.velocity_enu_m_s[1] == pytest.approx(10.28, abs=0.05)
    course = north(12.0, 1.0)
    wider = draggy(ANGLE_MAX=4500.0, WPNAV_SPEED=1500.0, WPNAV_ACCEL=350.0)
    pilot, began_s = flown(course, FOLLOW_ALL, 25.0, wider)
    assert pilot.position[1] - course(pilot.t_s - began_s)[0][0] == pytest.approx(-0.06, abs=0.15)


@pytest.mark.parametrize(("mask", "real_m", "tolerance_m"), [(FOLLOW, -0.67, 0.05), (FOLLOW_ALL, -0.37, 0.25)])
def test_a_ramp_to_10_m_s_lags_as_measured(mask: int, real_m: float, tolerance_m: float) -> None:
    assert lag_m(10.0, mask, 9.0, 1.0) == pytest.approx(real_m, abs=tolerance_m)
    assert abs(lag_m(10.0, mask, 20.0, 1.0)) < 0.05


@pytest.mark.parametrize(("mask", "real_m", "tolerance_m"), [(FOLLOW, 1.04, 0.3), (FOLLOW_ALL, 0.38, 0.25)])
def test_a_circle_of_20_m_is_flown_outside_as_measured(mask: int, real_m: float, tolerance_m: float) -> None:
    assert outward_m(20.0, mask) == pytest.approx(real_m, abs=tolerance_m)


def test_a_circle_of_12_5_m_fails_without_acceleration_and_not_with_it() -> None:
    assert abs(outward_m(12.5, FOLLOW)) > 2.0
    assert abs(outward_m(12.5, FOLLOW_ALL)) < 0.5


def test_without_setpoints_pos_and_velocity_coast_on_fly_back_and_hold_in_guided() -> None:
    course = north(5.0)
    pilot, began_s = flown(course, FOLLOW, 15.0)
    last_m = course(pilot.t_s - began_s)[0][0]
    farthest_m = 0.0
    for _ in range(150):
        pilot.run(0.1)
        farthest_m = max(farthest_m, float(pilot.position[1]))
    assert farthest_m - last_m == pytest.approx(21.0, abs=1.5)
    assert pilot.position[1] - last_m == pytest.approx(15.0, abs=0.5)
    assert pilot.last("HEARTBEAT").custom_mode == GUIDED


def test_without_setpoints_a_position_is_held_for_ever() -> None:
    pilot = copter_in_the_air()
    pilot.step(setpoint(POSITION, (3.0, 0.0, -10.0)))
    pilot.run(30.0)
    assert pilot.position[1] == pytest.approx(3.0, abs=0.1)


@pytest.mark.parametrize(
    "wrong",
    [
        setpoint(POSITION | 0b001, (50.0, 0.0, -10.0)),
        setpoint(VELOCITY | 0b001000, ZERO, (5.0, 0.0, 0.0)),
        setpoint(POSITION, (50.0, 0.0, -10.0), frame=12),
        setpoint(POSITION, (50.0, 0.0, -10.0), frame=20),
        setpoint(POSITION, (50.0, 0.0, -10.0), frame=21),
        setpoint(0b1001_1111_1111),
        setpoint(VELOCITY, ZERO, (nan, 0.0, 0.0)),
    ],
    ids=["part of position", "part of velocity", "frame 12", "frame 20", "frame 21", "nothing", "NaN in use"],
)
def test_a_setpoint_that_cannot_be_understood_means_stop(wrong: Message) -> None:
    pilot = copter_in_the_air()
    pilot.run(3.0, lambda _: setpoint(VELOCITY, ZERO, (3.0, 0.0, 0.0)))
    pilot.step(wrong)
    pilot.run(3.5)
    assert hypot(*pilot.node.state.velocity_enu_m_s[:2]) < 0.2


def test_nan_in_an_ignored_field_is_fine() -> None:
    pilot = copter_in_the_air()
    pilot.run(4.0, lambda _: setpoint(VELOCITY, (nan, nan, nan), (3.0, 0.0, 0.0), (nan, nan, nan)))
    assert pilot.node.state.velocity_enu_m_s[1] == pytest.approx(3.0, abs=0.2)


def test_setpoints_count_in_guided_only() -> None:
    pilot = copter_in_the_air()
    pilot.step(mode(LOITER))
    pilot.run(3.0, lambda _: setpoint(VELOCITY, ZERO, (3.0, 0.0, 0.0)))
    assert hypot(*pilot.node.state.velocity_enu_m_s[:2]) < 0.2


def test_descent_feed_forward_is_not_limited_and_a_step_overshoots() -> None:
    pilot = copter_in_the_air(height_m=30.0)
    began_s, sinks = pilot.t_s, []
    for _ in range(300):
        t_s = pilot.t_s - began_s
        pilot.step(setpoint(FOLLOW, (0.0, 0.0, -30.0 + t_s), (0.0, 0.0, 1.0)))
        sinks.append(-float(pilot.node.state.velocity_enu_m_s[2]))
    assert max(sinks) == pytest.approx(1.78, abs=0.25)
    pilot.run(5.0, lambda _: setpoint(VELOCITY, ZERO, (0.0, 0.0, 3.0)))
    assert -pilot.node.state.velocity_enu_m_s[2] == pytest.approx(3.0, abs=0.1)


def test_yaw_slews_at_60_degrees_a_second() -> None:
    pilot = copter_in_the_air()
    pilot.run(3.0, lambda _: setpoint(FOLLOW, (0.0, 0.0, -10.0)))

    def turned_rad(duration_s: float) -> float:
        before_rad = pilot.node.memory.now.yaw_rad
        pilot.run(duration_s, lambda _: setpoint(FOLLOW, (0.0, 0.0, -10.0), yaw=radians(170.0)))
        return before_rad - pilot.node.memory.now.yaw_rad

    turned_rad(1.0)
    assert degrees(turned_rad(1.0)) == pytest.approx(60.0, abs=3.0)


def test_with_yaw_and_rate_ignored_the_nose_turns_along_the_way() -> None:
    pilot = copter_in_the_air()
    ignored = VELOCITY | 0b1100_0000_0000
    pilot.run(6.0, lambda _: setpoint(ignored, ZERO, (-2.0, -3.0, 0.0)))
    assert pilot.node.memory.now.yaw_rad == pytest.approx(atan2(-2.0, -3.0), abs=0.1)


def test_waypoint_speed_limits_a_flight_by_position_only() -> None:
    pilot = copter_in_the_air(ardupilot(parameters={"WPNAV_SPEED": 300.0}))
    pilot.run(10.0, lambda _: setpoint(POSITION, (200.0, 0.0, -10.0)))
    assert pilot.node.state.velocity_enu_m_s[1] == pytest.approx(3.0, abs=0.1)
    pilot.run(10.0, lambda _: setpoint(VELOCITY, ZERO, (6.0, 0.0, 0.0)))
    assert pilot.node.state.velocity_enu_m_s[1] == pytest.approx(6.0, abs=0.1)


def test_plain_disarm_in_the_air_fails_and_force_disarm_always_works() -> None:
    pilot = copter_in_the_air()
    assert pilot.acknowledged(arm(armed=False)) == [FAILED]
    assert pilot.acknowledged(arm(armed=False, force=True)) == [ACCEPTED]
    assert not pilot.is_armed()


def test_any_disarm_reports_on_ground_even_in_the_air() -> None:
    pilot = copter_in_the_air()
    pilot.step(every(EXTENDED_SYS_STATE, 50.0))
    pilot.step(arm(armed=False, force=True))
    pilot.run(0.1)
    assert pilot.position[2] > 5.0
    assert landed_state(pilot) == mavlink.MAV_LANDED_STATE_ON_GROUND


def test_land_sinks_at_land_speed_and_disarms_by_itself() -> None:
    pilot = copter_in_the_air(height_m=4.0)
    pilot.step(mode(LAND), every(EXTENDED_SYS_STATE, 50.0))
    pilot.run(3.0)
    assert -pilot.node.state.velocity_enu_m_s[2] == pytest.approx(0.5, abs=0.05)
    assert landed_state(pilot) == mavlink.MAV_LANDED_STATE_LANDING
    pilot.run_until(lambda: pilot.position[2] < 0.14, 15.0)
    assert pilot.run_until(lambda: not pilot.is_armed(), 10.0) == pytest.approx(2.1, abs=0.8)
    assert pilot.acknowledged(arm()) == [FAILED]
