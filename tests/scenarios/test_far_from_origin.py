"""Landings a kilometre from the autopilot's origin, metres beside a tangent plane, and across the antimeridian."""

import pytest

from link.frames.geodesy import geodetic_from_enu, local_from_geodetic
from scenarios.catalogue.catalogue import load_scenario
from scenarios.config import Scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.recordings.result import result_table
from scenarios.simulation.vehicle_node import datum_of
from scenarios.tracks.config import WaypointsTrack

_EAST_M, _NORTH_M = 900.0, -450.0

pytestmark = pytest.mark.slow


def _far_away(firmware: str) -> Scenario:
    """5 m/s on a road past a waiting point that is 1006 m from the datum, where the autopilot boots its origin."""
    road = ((_EAST_M - 60.0, _NORTH_M - 20.0), (_EAST_M + 400.0, _NORTH_M + 133.0))
    track = WaypointsTrack(kind="waypoints", waypoints_m=road, speeds_m_s=(5.0, 5.0))
    scenario = load_scenario(f"straight_5+firmware={firmware}").model_copy(update={"track": track})
    return scenario.with_run(drone_start_enu_m=(_EAST_M, _NORTH_M, 0.0), waiting_point_enu_m=(_EAST_M, _NORTH_M, 5.0))


@pytest.mark.parametrize(("firmware", "beside_m"), [("px4", 2.0), ("ardupilot", 1.0)])
def test_a_landing_a_kilometre_from_the_origin_is_as_good_as_one_beside_it(firmware: str, beside_m: float) -> None:
    scenario = _far_away(firmware)
    run = Lockstep(scenario, 1)
    ended = run.run()
    result = result_table(scenario, 1, run.recording, ended)
    assert result["tier"] == "S3"
    assert result["horizontal_error_m"] < 0.2
    assert result["position_rmse_m"] < 0.05  # of the estimate, in the frame that the drone flies in

    contact = run.recording.drone[-1].position_enu_m
    frame = run.simulation.autopilot.memory.places.origin.frame
    local = local_from_geodetic(frame, *geodetic_from_enu(datum_of(scenario.run.datum), contact))
    assert abs(local[0] - contact[0]) > beside_m  # without the projection it would have been flown so far beside


def test_a_landing_across_the_antimeridian_is_as_good_as_one_elsewhere() -> None:
    scenario = load_scenario("straight_5+firmware=ardupilot")
    datum = scenario.run.datum.model_copy(
        update={"latitude_deg": -77.85, "longitude_deg": 179.9999}
    )  # 2.3 m west of it
    run = Lockstep(scenario.with_run(datum=datum), 1)
    ended = run.run()
    result = result_table(scenario, 1, run.recording, ended)
    places = [geodetic_from_enu(datum_of(datum), truth.position_enu_m)[1] for truth in run.recording.drone]
    assert min(places) < 0.0 < max(places)  # it has flown on both sides
    assert result["tier"] == "S3"
    assert result["horizontal_error_m"] < 0.2
    assert result["position_rmse_m"] < 0.05
