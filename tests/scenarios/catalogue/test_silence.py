"""Of a vehicle that tells nothing the companion knows the pad, and waits where it will see it."""

import pytest

from link.errors import UserError
from link.messages import BodyTruth
from link.zenoh.keys import Keys
from scenarios.catalogue.catalogue import load_scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.recordings.result import result_table
from scenarios.simulation.vehicle_node import VehicleNode

NAME = "straight_5+sensors=nominal+wind=nominal+telemetry=none"


def test_companion_knows_the_pad_and_waits_as_high_as_its_detector_sees() -> None:
    scenario = load_scenario(NAME)
    companion = scenario.system.companion
    assert companion.silent_vehicle is not None
    assert companion.silent_vehicle.pad.height_m == scenario.vehicle.roof_height_m
    assert companion.takeoff.waiting_height_m == scenario.run.waiting_point_enu_m[2] == 9.5


def test_it_publishes_nothing_but_what_the_drone_sees() -> None:
    keys = Keys()
    node = VehicleNode(load_scenario(NAME), 1, keys, publishes_truth=False)
    above = BodyTruth(
        t_ns=1_000_000_000,
        position_enu_m=(-40.0, 0.0, 6.0),
        orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
        velocity_flu_m_s=(0.0, 0.0, 0.0),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
    )
    published = {one.key for t_ns in range(10**9, 2 * 10**9, 10**7) for one in node.step(t_ns, _at(above, t_ns))}
    assert published == {keys.pad_pose}


def _at(body: BodyTruth, t_ns: int) -> BodyTruth:
    return BodyTruth(**{name: getattr(body, name) for name in body.__struct_fields__} | {"t_ns": t_ns})


def test_without_eyes_on_the_drone_nobody_would_find_it() -> None:
    with pytest.raises(UserError, match="nobody sees"):
        load_scenario("straight_5+telemetry=none")


@pytest.mark.slow
def test_it_is_landed_on() -> None:
    scenario = load_scenario(f"{NAME}+firmware=ardupilot")
    run = Lockstep(scenario, 5)
    assert result_table(scenario, 5, run.recording, run.run())["tier"] in ("S2", "S3")
