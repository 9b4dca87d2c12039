import math
from collections.abc import Iterable

import numpy as np
import pytest

from link.frames.rotations import rotate
from link.messages import BodyTruth, Vector3
from link.records import replace
from scenarios.catalogue.catalogue import load_scenario
from scenarios.simulation.vehicle import (
    VehicleInputs,
    VehicleMemory,
    VehiclePlan,
    VehicleState,
    vehicle_at,
    vehicle_deck,
    vehicle_step,
    vehicle_truth,
)
from scenarios.simulation.vehicle_node import plan_of
from scenarios.tracks.config import ShakeConfig, WaypointsTrack
from scenarios.worlds.world import draw_world
from tests.rotations import matrix_of

START_NS = 1_800_000_000_000_000_000
STEP_NS = 10_000_000
HOVER = (0.1, -0.2, 5.3)


def drone_at(t_ns: int, position_enu_m: Vector3) -> BodyTruth:
    return BodyTruth(
        t_ns=t_ns,
        position_enu_m=position_enu_m,
        orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
        velocity_flu_m_s=(0.0, 0.0, 0.0),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
    )


def driven(
    plan: VehiclePlan,
    positions: Iterable[Vector3 | None],
    memory: VehicleMemory | None = None,
    start_ns: int = START_NS,
) -> list[tuple[VehicleMemory, VehicleState]]:
    memory = memory or VehicleMemory()
    steps = []
    for index, position_enu_m in enumerate(positions):
        t_ns = start_ns + index * STEP_NS
        drone = None if position_enu_m is None else drone_at(t_ns, position_enu_m)
        memory, state = vehicle_step(memory, VehicleInputs(t_ns=t_ns, drone=drone), plan)
        steps.append((memory, state))
    return steps


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "backwards"),
    [
        ("straight_5", False),
        ("figure_eight_7", False),
        ("circle_8", False),
        ("stop_and_go_7", False),
        ("lane_change_7", False),
        ("random_7", False),
        ("rough_road_5", False),
        ("rough_road_5", True),
        ("report_1", False),
    ],
)
def test_velocity_acceleration_and_angular_velocity_are_the_derivatives_of_the_pose(name: str, backwards: bool) -> None:
    plan = plan_of(load_scenario(name), seed=2)
    plan = replace(plan, departure=plan.departure.model_copy(update={"backwards": backwards}))
    memory = VehicleMemory(departs_ns=START_NS)
    step_ns = 20_000
    step_s = step_ns * 1e-9
    bad = 0
    times_s = np.linspace(0.5123, 40.0, 157)
    for t_s in times_s:
        t_ns = START_NS + round(t_s * 1e9)
        before, now, after = (vehicle_at(memory, t_ns + shift, plan) for shift in (-step_ns, 0, step_ns))
        velocity = (np.array(after.position_enu_m) - np.array(before.position_enu_m)) / (2.0 * step_s)
        acceleration = (np.array(after.velocity_enu_m_s) - np.array(before.velocity_enu_m_s)) / (2.0 * step_s)
        turned = (matrix_of(after.orientation_wxyz) - matrix_of(before.orientation_wxyz)) / (2.0 * step_s)
        cross = matrix_of(now.orientation_wxyz).T @ turned
        rates = (cross[2, 1], cross[0, 2], cross[1, 0])
        np.testing.assert_allclose(now.velocity_enu_m_s, velocity, atol=1e-4)
        smooth = np.allclose(now.acceleration_enu_m_s2, acceleration, atol=1e-3) and np.allclose(
            now.angular_velocity_flu_rad_s, rates, atol=1e-4
        )
        bad += not smooth
    assert bad <= 2  # instants at which curvature or acceleration jumps


def test_vehicle_that_drives_backwards_has_its_rear_ahead() -> None:
    plan = plan_of(load_scenario("circle_8"), seed=2)
    rear_ahead = replace(plan, departure=plan.departure.model_copy(update={"backwards": True}))
    one, other = (vehicle_at(VehicleMemory(departs_ns=START_NS), START_NS + 30 * 10**9, p) for p in (plan, rear_ahead))
    assert other.position_enu_m == one.position_enu_m
    assert other.velocity_enu_m_s == one.velocity_enu_m_s
    assert math.cos(other.yaw_rad - one.yaw_rad) == pytest.approx(-1.0)
    assert other.yaw_rate_rad_s == one.yaw_rate_rad_s != 0.0
    along, back = (np.array(vehicle_truth(state).velocity_flu_m_s) for state in (one, other))
    np.testing.assert_allclose(back, (-1.0, -1.0, 1.0) * along, atol=1e-9)


@pytest.mark.parametrize(("corner_m_s", "turns_round"), [(0.0, False), (2.0, True)])
def test_vehicle_that_stops_and_is_led_back_backs_up(corner_m_s: float, turns_round: bool) -> None:
    track = WaypointsTrack(
        kind="waypoints",
        waypoints_m=((0.0, 0.0), (4.0, 0.0), (0.0, 1.0)),
        speeds_m_s=(2.0, corner_m_s, 2.0),
    )
    plan = plan_of(load_scenario("straight_5").model_copy(update={"track": track}), seed=2)
    leads_back = vehicle_at(VehicleMemory(departs_ns=0), round(8.2 / (2.0 + corner_m_s) * 1e9), plan)
    assert leads_back.velocity_enu_m_s[0] < 0.0
    assert (abs(leads_back.yaw_rad) > 0.5 * math.pi) is turns_round


def test_vehicle_stands_until_the_drone_has_hovered_for_a_second() -> None:
    plan = plan_of(load_scenario("straight_5"), seed=1)
    steps = driven(plan, [(0.0, 0.0, 2.0)] * 300 + [HOVER] * 301)
    moving = [index for index, (_, state) in enumerate(steps) if state.velocity_enu_m_s[0] > 0.0]
    assert moving[0] == 300 + 100 + 100 + 1  # hovers for 1 s, departs 1 s later


def test_leaving_the_waiting_point_starts_the_hover_again() -> None:
    plan = plan_of(load_scenario("straight_5"), seed=1)
    steps = driven(plan, [HOVER] * 99 + [(0.0, 0.0, 7.51)] + [HOVER] * 102)
    assert steps[99][0].hovers_since_ns is None
    assert steps[-3][0].departs_ns is None
    assert steps[-1][0].departs_ns is not None


def test_vehicle_stays_without_a_drone() -> None:
    plan = plan_of(load_scenario("straight_5"), seed=1)
    steps = driven(plan, [None] * 1000)
    assert steps[-1][1].position_enu_m == (-40.0, 0.0, 0.0)


def test_vehicle_that_does_not_wait_departs_by_itself() -> None:
    plan = plan_of(load_scenario("straight_5"), seed=1)
    alone = replace(plan, departure=plan.departure.model_copy(update={"wait_for_drone": False}))
    steps = driven(alone, [None] * 300)
    assert steps[99][1].velocity_enu_m_s == (0.0, 0.0, 0.0)
    assert steps[200][1].velocity_enu_m_s[0] == pytest.approx(2.0)


def test_report_vehicle_stands_five_seconds_after_the_hover() -> None:
    plan = plan_of(load_scenario("report_1"), seed=1)
    steps = driven(plan, [HOVER] * 700)
    memory, state = steps[-1]
    assert memory.departs_ns == START_NS + 6_000_000_000
    assert state.velocity_enu_m_s[0] == pytest.approx(0.25 * 0.99)


def test_braking_vehicle_brakes_once_the_drone_is_low_and_then_stands() -> None:
    plan = plan_of(load_scenario("brake_7"), seed=1)
    assert plan.course.brake is not None
    memory = VehicleMemory(departs_ns=START_NS - 20_000_000_000)
    roof_m = 1.5 + plan.course.brake.height_above_roof_m
    x_m = vehicle_at(memory, START_NS, plan).position_enu_m[0]
    descent = [(x_m + 0.07 * i, 0.0, max(roof_m + 1.0 - 0.01 * i, roof_m - 0.5)) for i in range(400)]
    steps = driven(plan, descent, memory)
    brakes_ns = steps[-1][0].brakes_ns
    assert brakes_ns == pytest.approx(START_NS + 100 * STEP_NS, abs=STEP_NS)
    speeds_m_s = [state.velocity_enu_m_s[0] for _, state in steps]
    assert speeds_m_s[100] == pytest.approx(7.0)
    assert speeds_m_s[150] == pytest.approx(7.0 - 6.0 * 0.5, abs=0.07)
    assert speeds_m_s[-1] == 0.0
    assert steps[-1][1].position_enu_m[0] == pytest.approx(x_m + 7.0 + 49.0 / 12.0, abs=0.1)


def test_vehicle_of_a_world_that_brakes_late_brakes_and_dives_under_a_low_drone() -> None:
    world = draw_world("world:late", 3)
    plan, calm = plan_of(world.scenario, 3), plan_of(draw_world("world", 3).scenario, 3)
    brake, memory = plan.course.brake, VehicleMemory(departs_ns=START_NS - 30_000_000_000)
    assert brake is not None
    assert calm.course.brake is None
    east_m, north_m, road_m = vehicle_at(memory, START_NS, plan).position_enu_m
    low = (east_m, north_m, road_m + plan.roof_height_m + 0.9 * brake.height_above_roof_m)
    steps = driven(plan, [low] * 20, memory)
    begins_ns = steps[-1][0].brakes_ns
    assert begins_ns is not None
    before, after = (vehicle_at(steps[-1][0], begins_ns + round(t_s * 1e9), plan) for t_s in (0.0, 0.2))
    slower_m_s = math.hypot(*before.velocity_enu_m_s[:2]) - math.hypot(*after.velocity_enu_m_s[:2])
    assert slower_m_s == pytest.approx(0.2 * brake.deceleration_m_s2, rel=1e-3)
    unbraked = vehicle_at(memory, begins_ns + 200_000_000, plan)
    nose_down = [rotate(one.orientation_wxyz, (1.0, 0.0, 0.0))[2] for one in (unbraked, after)]
    assert nose_down[1] < nose_down[0] - 0.0005


def test_braking_vehicle_does_not_brake_for_a_low_drone_beside_it() -> None:
    plan = plan_of(load_scenario("brake_7"), seed=1)
    memory = VehicleMemory(departs_ns=START_NS - 20_000_000_000)
    x_m = vehicle_at(memory, START_NS, plan).position_enu_m[0]
    steps = driven(plan, [(x_m + 0.07 * i, 3.5, 1.6) for i in range(100)], memory)
    assert steps[-1][0].brakes_ns is None


def test_step_is_a_function_of_its_arguments() -> None:
    plan = plan_of(load_scenario("rough_road_5"), seed=7)
    path = [HOVER] * 500
    assert driven(plan, path) == driven(plan_of(load_scenario("rough_road_5"), seed=7), path)


def test_truth_has_the_velocity_along_the_body() -> None:
    plan = plan_of(load_scenario("circle_5"), seed=1)
    state = vehicle_at(VehicleMemory(departs_ns=START_NS), START_NS + 17_000_000_000, plan)
    truth = vehicle_truth(state)
    assert truth.velocity_flu_m_s == pytest.approx((5.0, 0.0, 0.0), abs=1e-9)
    assert truth.angular_velocity_flu_rad_s == pytest.approx((0.0, 0.0, 0.25), abs=1e-9)


def test_climbing_vehicle_is_nose_up_along_the_road() -> None:
    scenario = load_scenario("rough_road_5")
    still = ShakeConfig(heave_m=0.0, roll_rad=0.0, pitch_rad=0.0)
    level = scenario.track.model_copy(update={"shake": still})
    plan = plan_of(scenario.model_copy(update={"track": level}), seed=1)
    state = vehicle_at(VehicleMemory(departs_ns=START_NS), START_NS + 30_000_000_000, plan)
    nose = rotate(state.orientation_wxyz, (1.0, 0.0, 0.0))
    assert nose[2] / nose[0] == pytest.approx(0.05)
    assert state.velocity_enu_m_s[2] == pytest.approx(0.25)


def test_rough_road_shakes_within_its_amplitudes() -> None:
    plan = plan_of(load_scenario("rough_road_5"), seed=1)
    memory = VehicleMemory(departs_ns=START_NS)
    states = [vehicle_at(memory, START_NS + i * STEP_NS, plan) for i in range(300, 900)]
    heave_m = np.array([state.position_enu_m[2] for state in states])
    assert 0.095 < np.abs(heave_m).max() <= 0.1
    tilt_rad = [math.acos(matrix_of(state.orientation_wxyz)[2, 2]) for state in states]
    assert 0.05 < max(tilt_rad) < 0.0524 * math.sqrt(2.0) + 1e-6


def test_deck_has_the_angular_velocity_in_the_world() -> None:
    scenario = load_scenario("circle_5")
    state = vehicle_at(VehicleMemory(departs_ns=START_NS), START_NS + 20_000_000_000, plan_of(scenario, seed=1))
    deck = vehicle_deck(state, scenario.vehicle)
    assert deck.angular_velocity_enu_rad_s == pytest.approx([0.0, 0.0, 0.25], abs=1e-9)
    assert (deck.roof_size_m, deck.roof_height_m) == ((4.2, 1.8), 1.5)
