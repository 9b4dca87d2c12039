import math

import numpy as np
import pytest
from numpy.typing import NDArray

from link.frames.rotations import quaternion_from_roll_pitch_yaw, rotate
from link.messages import BodyTruth, PadSighting, Vector3
from link.zenoh.keys import Keys
from scenarios.catalogue.catalogue import load_scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.recordings.result import result_table
from scenarios.simulation.camera_scene import CameraSensor
from scenarios.simulation.vehicle import VehicleState
from scenarios.simulation.vehicle_node import VehicleNode
from tests.scenarios.presets import list_presets

T_NS = 1_000_000_000
YAW_RAD = 0.6
VEHICLE = VehicleState(
    t_ns=T_NS,
    position_enu_m=(30.0, -20.0, 0.4),
    velocity_enu_m_s=(4.0 * math.cos(YAW_RAD), 4.0 * math.sin(YAW_RAD), 0.0),
    acceleration_enu_m_s2=(0.0, 0.0, 0.0),
    orientation_wxyz=quaternion_from_roll_pitch_yaw(0.02, -0.05, YAW_RAD),
    angular_velocity_flu_rad_s=(0.0, 0.0, 0.1),
    yaw_rad=YAW_RAD,
    yaw_rate_rad_s=0.1,
)
SCENARIO = load_scenario("straight_5+camera=day")


def drone(above_enu_m: Vector3, age_s: float = 0.0) -> BodyTruth:
    """A drone that is somewhere over the pad, as it was `age_s` ago, and flies as the vehicle drives."""
    moved = [-age_s * speed for speed in VEHICLE.velocity_enu_m_s]
    x, y, z = (a + b + c for a, b, c in zip(VEHICLE.position_enu_m, above_enu_m, moved, strict=True))
    return BodyTruth(
        t_ns=T_NS - round(age_s * 1e9),
        position_enu_m=(x, y, z),
        orientation_wxyz=quaternion_from_roll_pitch_yaw(0.05, 0.1, -1.0),
        velocity_flu_m_s=(1.0, -0.5, 0.0),
        angular_velocity_flu_rad_s=(0.1, -0.2, 0.1),
    )


def pad_from(body: BodyTruth, sighting: PadSighting) -> NDArray[np.float64]:
    """Where a sighting has the pad in W."""
    return np.array(body.position_enu_m) + rotate(body.orientation_wxyz, sighting.position_flu_m)


@pytest.mark.slow
@pytest.mark.parametrize("age_s", [0.0, 0.01])
def test_the_pad_is_seen_where_it_is_at_the_drones_own_time(age_s: float) -> None:
    body = drone((0.4, -0.3, 6.0), age_s)
    sighting = CameraSensor(SCENARIO, 3).sample(VEHICLE, body, 0.0)
    assert sighting is not None
    assert sighting.t_ns == body.t_ns
    true_m = np.array(VEHICLE.position_enu_m) + rotate(VEHICLE.orientation_wxyz, (0.0, 0.0, 1.5))
    true_m = true_m - age_s * np.array(VEHICLE.velocity_enu_m_s)
    error = pad_from(body, sighting) - true_m
    assert np.linalg.norm(error) < 0.06  # a mounting that is 0.3 degrees off


@pytest.mark.parametrize(
    ("above_enu_m", "age_s"), [((40.0, 0.0, 4.0), 0.0), ((0.0, 0.0, -3.0), 0.0), ((0.0, 0.0, 5.0), 0.2)]
)
def test_a_pad_beside_or_above_the_camera_and_one_of_an_old_truth_is_not_seen(
    above_enu_m: Vector3, age_s: float
) -> None:
    assert CameraSensor(SCENARIO, 3).sample(VEHICLE, drone(above_enu_m, age_s), 0.0) is None


@pytest.mark.slow
@pytest.mark.parametrize("preset", [name for name in list_presets("camera") if name != "none"])
def test_every_camera_sees_the_pad_from_three_metres_and_alike_for_the_same_seed(preset: str) -> None:
    scenario = load_scenario(f"straight_5+camera={preset}")
    first, second = (CameraSensor(scenario, 5).sample(VEHICLE, drone((0.1, 0.2, 4.5)), 0.0) for _ in range(2))
    assert first is not None
    assert first == second


def test_the_noise_model_sees_where_no_camera_is_asked_for() -> None:
    keys = Keys()
    for name in ("straight_5+sensors=nominal", "straight_5+sensors=nominal+camera=day+detector=model"):
        scenario = load_scenario(name)
        assert not scenario.has_camera
        published = VehicleNode(scenario, 1, keys).step(T_NS, drone((0.0, 0.0, 4.0)))
        assert published


@pytest.mark.slow
def test_a_landing_by_rendered_frames_is_as_good_as_one_by_the_noise_model() -> None:
    """At ten frames a second, a third of what it takes: each is 50 ms of rendering."""
    scenario = load_scenario("straight_5+sensors=nominal+wind=nominal+camera=day")
    camera = scenario.camera.model_copy(update={"rate_hz": 10.0})
    scenario = scenario.model_copy(update={"camera": camera})
    run = Lockstep(scenario, 4)
    result = result_table(scenario, 4, run.recording, run.run())
    assert result["tier"] == "S3"
    assert result["horizontal_error_m"] < 0.2
