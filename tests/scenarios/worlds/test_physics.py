"""No world's vehicle breaks physics: evaluated on a grid over the whole drive, without flying."""

import math
from collections.abc import Callable
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from link.program.toml_config import dump_toml
from scenarios.catalogue.catalogue import load_scenario
from scenarios.simulation.vehicle import VehicleMemory, VehicleState, vehicle_at
from scenarios.simulation.vehicle_node import plan_of
from scenarios.tracks.drive_config import DriveTrack
from scenarios.tracks.roads import Piece, Road
from scenarios.worlds.driver import DRIVE_S
from scenarios.worlds.odd import slices
from scenarios.worlds.road import STEERING_MAX_PER_M_S, TURN_RADIUS_MIN_M
from scenarios.worlds.world import World, draw_world
from sim_autopilot.physics.airframe import GRAVITY_M_S2
from tests.rotations import matrix_of

SEEDS = range(20_000, 20_003)
STEP_S = 0.05
START_NS = 1_800_000_000_000_000_000


def states(world: World, times_s: np.ndarray) -> list[VehicleState]:
    """The vehicle at times after its departure."""
    plan, memory = plan_of(world.scenario, world.seed), VehicleMemory(departs_ns=START_NS)
    return [vehicle_at(memory, START_NS + round(t_s * 1e9), plan) for t_s in times_s.tolist()]


Vehicle = dict[str, np.ndarray]


@cache
def driven(name: str, seed: int) -> tuple[World, Vehicle]:
    """A world and its vehicle on the grid, by the fields of its state."""
    world = draw_world(name, seed)
    vehicle = states(world, np.arange(0.0, DRIVE_S + 20.0, STEP_S))
    fields = (
        "position_enu_m",
        "velocity_enu_m_s",
        "acceleration_enu_m_s2",
        "yaw_rad",
        "yaw_rate_rad_s",
        "orientation_wxyz",
    )
    return world, {field: np.array([getattr(state, field) for state in vehicle]) for field in fields}


def acceleration_stays_in_the_friction_circle(world: World, vehicle: Vehicle) -> None:
    level = np.linalg.norm(vehicle["acceleration_enu_m_s2"][:, :2], axis=1)
    assert level.max() <= GRAVITY_M_S2 * float(world.drawn["road.friction"]), world.scenario.name


def position_and_velocity_are_continuous(world: World, vehicle: Vehicle) -> None:
    moved_m = np.diff(vehicle["position_enu_m"], axis=0)
    mean_m_s = 0.5 * (vehicle["velocity_enu_m_s"][1:] + vehicle["velocity_enu_m_s"][:-1])
    # the level part bends with at most the friction circle's acceleration, which the trapezoid leaves out
    off_m = np.abs(moved_m - mean_m_s * STEP_S)
    assert off_m[:, :2].max() < GRAVITY_M_S2 * STEP_S**2, world.scenario.name
    jump_m_s = np.linalg.norm(np.diff(vehicle["velocity_enu_m_s"][:, :2], axis=0), axis=1)
    assert jump_m_s.max() <= 1.05 * GRAVITY_M_S2 * STEP_S, world.scenario.name


def curvature_is_a_vehicles_and_changes_no_faster_than_it_is_steered(world: World, vehicle: Vehicle) -> None:
    plan = plan_of(world.scenario, world.seed)
    ends = [road.curvature_per_m + road.growth_per_m2 * length_m for road, length_m in lengths(plan.course.road)]
    begins = [piece.curvature_per_m for piece in plan.course.road.pieces]
    np.testing.assert_allclose(ends[:-1], begins[1:], atol=1e-9, err_msg=world.scenario.name)
    speeds_m_s = np.linalg.norm(vehicle["velocity_enu_m_s"][:, :2], axis=1)
    moving = speeds_m_s > 0.1
    curvature_per_m = vehicle["yaw_rate_rad_s"][moving] / speeds_m_s[moving]
    assert np.abs(curvature_per_m).max() <= 1.001 / TURN_RADIUS_MIN_M, world.scenario.name
    both = moving[1:] & moving[:-1]
    curvature = np.divide(vehicle["yaw_rate_rad_s"], speeds_m_s, out=np.zeros(len(moving)), where=moving)
    turned = np.abs(np.diff(curvature))[both] / STEP_S
    assert turned.max() <= 1.05 * STEERING_MAX_PER_M_S, world.scenario.name


def lengths(road: Road) -> list[tuple[Piece, float]]:
    """The pieces of a road, each with its length."""
    ends = [*road.starts_m[1:], road.length_m]
    return [(piece, end - piece.s_m) for piece, end in zip(road.pieces, ends, strict=True)]


def body_neither_tips_nor_leaves_the_road_nor_sinks_into_the_ground(world: World, vehicle: Vehicle) -> None:
    upright = 1.0 - 2.0 * (vehicle["orientation_wxyz"][:, 1:3] ** 2).sum(axis=1)  # R_WV[2, 2]
    assert upright.min() > math.cos(0.3), world.scenario.name
    assert float(world.drawn["drive.heave_max_m"]) < 0.3, world.scenario.name
    assert vehicle["position_enu_m"][:, 2].min() > -0.15, world.scenario.name


def vehicle_passes_the_waiting_point_at_speed_and_stands_in_the_end(world: World, vehicle: Vehicle) -> None:
    aside_m = np.linalg.norm(vehicle["position_enu_m"][:, :2], axis=1)
    speeds_m_s = np.linalg.norm(vehicle["velocity_enu_m_s"][:, :2], axis=1)
    nearest = int(aside_m.argmin())
    assert aside_m[0] >= 40.0 - 1e-9, world.scenario.name
    assert aside_m[nearest] < 0.51 * STEP_S * speeds_m_s.max(), world.scenario.name
    assert nearest * STEP_S < 60.0, world.scenario.name
    assert speeds_m_s[nearest] > 0.5 * float(world.drawn["drive.cruise_m_s"]), world.scenario.name
    track = world.scenario.track
    assert isinstance(track, DriveTrack)
    (in_the_end,) = states(world, np.array([sum(duration_s for duration_s, _ in track.legs) + 1.0]))
    assert np.linalg.norm(in_the_end.velocity_enu_m_s[:2]) < 1e-9, world.scenario.name


LAWS = (
    acceleration_stays_in_the_friction_circle,
    position_and_velocity_are_continuous,
    curvature_is_a_vehicles_and_changes_no_faster_than_it_is_steered,
    body_neither_tips_nor_leaves_the_road_nor_sinks_into_the_ground,
    vehicle_passes_the_waiting_point_at_speed_and_stands_in_the_end,
)


@pytest.mark.slow
@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.__name__)
def test_law_holds_in_worlds_of_each_slice(law: Callable[[World, Vehicle], None]) -> None:
    for name, seed in product(slices(), SEEDS):
        law(*driven(name, seed))


def test_velocity_and_angular_velocity_are_the_derivatives_of_the_pose() -> None:
    world = draw_world("world:urban", 20_001)
    times_s, step_s = np.linspace(3.0013, 118.0, 157), 2e-5
    before, now, after = (states(world, times_s + shift) for shift in (-step_s, 0.0, step_s))
    for one, two, three in zip(before, now, after, strict=True):
        velocity = (np.array(three.position_enu_m) - np.array(one.position_enu_m)) / (2.0 * step_s)
        np.testing.assert_allclose(velocity, two.velocity_enu_m_s, atol=2e-4)
        turned = matrix_of(one.orientation_wxyz).T @ matrix_of(three.orientation_wxyz)
        rate = np.array([turned[2, 1], turned[0, 2], turned[1, 0]]) / (2.0 * step_s)
        np.testing.assert_allclose(rate, two.angular_velocity_flu_rad_s, atol=2e-4)


@pytest.mark.parametrize("name", slices())
def test_world_is_read_back_from_its_file_to_the_last_bit(name: str, tmp_path: Path) -> None:
    for seed in range(30_000, 30_003):
        scenario = draw_world(name, seed).scenario
        file = tmp_path / "world.toml"
        file.write_text(dump_toml(scenario), encoding="utf-8")
        assert load_scenario(str(file)) == scenario


def test_world_is_named_after_its_slice_and_seed() -> None:
    world = draw_world("world:yard", 12)
    assert world.scenario.name == "world:yard-12"
    assert isinstance(world.scenario.track, DriveTrack)
