"""No drone begins inside the vehicle, and each waits where the vehicle expects it."""

import math
from pathlib import Path

import pytest

from link.errors import UserError
from scenarios.catalogue.catalogue import list_scenarios, load_scenario
from scenarios.lockstep.lockstep import Lockstep

ROAD = """
description = "A road that begins where the drone would stand"
{places}
[track]
kind = "waypoints"
waypoints_m = [[0.0, 0.0], [30.0, 40.0], [300.0, 400.0]]
speeds_m_s = [0.0, 5.0, 5.0]
"""


def written(folder: Path, places: str = "") -> str:
    path = folder / "road.toml"
    path.write_text(ROAD.format(places=places), encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("name", [entry.name for entry in list_scenarios() if not entry.name.startswith("ship")])
def test_roads_of_the_catalogue_leave_the_drone_at_the_datum(name: str) -> None:
    scenario = load_scenario(name)
    assert (scenario.run.drone_start_enu_m, scenario.run.waiting_point_enu_m) == ((0.0, 0.0, 0.0), (0.0, 0.0, 5.0))


def test_drone_waits_ahead_of_a_vehicle_that_begins_at_the_datum(tmp_path: Path) -> None:
    scenario = load_scenario(written(tmp_path))
    start, waiting = scenario.run.drone_start_enu_m, scenario.run.waiting_point_enu_m
    assert math.hypot(*start[:2]) > 0.5 * scenario.vehicle.length_m + 1.0
    assert math.atan2(start[1], start[0]) == pytest.approx(math.atan2(4.0, 3.0))
    assert (waiting[:2], waiting[2]) == (start[:2], 5.0)


@pytest.mark.slow
def test_drone_ahead_of_the_vehicle_takes_off_at_once(tmp_path: Path) -> None:
    run = Lockstep(load_scenario(written(tmp_path)), 1)
    while run.recording.elapsed_s < 12.0:
        run.step()
    assert run.recording.phase_times_s()["waiting"] < 10.0


def test_drone_placed_inside_the_vehicle_is_refused_with_what_to_change(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"inside the vehicle, at \(1, 0.5, 0\) m; change run.drone_start_enu_m"):
        load_scenario(written(tmp_path, "run.drone_start_enu_m = [1.0, 0.5, 0.0]"))


def test_drone_may_begin_on_the_roof_or_beside_the_vehicle(tmp_path: Path) -> None:
    for place in ((0.0, 0.0, 1.5), (-4.0, 3.0, 0.0)):
        scenario = load_scenario(written(tmp_path, f"run.drone_start_enu_m = {list(place)}"))
        assert scenario.run.drone_start_enu_m == place


def test_pad_on_the_road_is_no_vehicle_to_be_inside_of(tmp_path: Path) -> None:
    scenario = load_scenario(written(tmp_path, 'vehicle = "report"'))
    assert scenario.run.drone_start_enu_m == (0.0, 0.0, 0.0)


HEIGHT = "system.companion.takeoff.waiting_height_m"


@pytest.mark.parametrize(
    ("places", "start_enu_m", "height_m"),
    [
        ("run.waiting_point_enu_m = [3.0, -20.0, 8.0]", (3.0, -20.0, 0.0), 8.0),
        ("run.drone_start_enu_m = [3.0, -20.0, 2.0]", (3.0, -20.0, 2.0), 5.0),
        (f"run.drone_start_enu_m = [3.0, -20.0, 2.0]\n{HEIGHT} = 7.0", (3.0, -20.0, 2.0), 7.0),
        (f"run.waiting_point_enu_m = [3.0, -20.0, 7.0]\n{HEIGHT} = 7.0", (3.0, -20.0, 0.0), 7.0),
    ],
)
def test_what_is_left_open_of_where_the_drone_waits_follows_from_the_rest(
    tmp_path: Path, places: str, start_enu_m: tuple[float, float, float], height_m: float
) -> None:
    scenario = load_scenario(written(tmp_path, places))
    east_m, north_m, up_m = scenario.run.waiting_point_enu_m
    assert scenario.run.drone_start_enu_m == start_enu_m
    assert (east_m, north_m, up_m - start_enu_m[2]) == (*start_enu_m[:2], height_m)
    assert scenario.system.companion.takeoff.waiting_height_m == height_m


@pytest.mark.parametrize(
    "places",
    [
        f"run.waiting_point_enu_m = [3.0, -20.0, 8.0]\n{HEIGHT} = 5.0",
        "run.waiting_point_enu_m = [3.0, -20.0, 8.0]\nrun.drone_start_enu_m = [0.0, -20.0, 0.0]",
    ],
)
def test_drone_that_would_wait_elsewhere_is_refused_with_what_to_change(tmp_path: Path, places: str) -> None:
    with pytest.raises(UserError, match=r"the vehicle would never depart; change that, run.drone_start_enu_m or"):
        load_scenario(written(tmp_path, places))
