"""Worlds by their names."""

import shlex

import pytest

from link.errors import UserError
from scenarios.catalogue.catalogue import load_scenario
from scenarios.catalogue.world_names import WorldName, names_worlds, parse_world_name, run_seed
from scenarios.catalogue.worlds import drawn_world
from scenarios.config import FIRMWARES, FirmwareName
from scenarios.worlds.odd import slices
from scenarios.worlds.seeds import SEEDS_END
from scenarios.worlds.world import draw_world


@pytest.mark.parametrize("slice_name", slices())
@pytest.mark.parametrize("seed", [None, 0, 4711])
@pytest.mark.parametrize("firmware", [None, *FIRMWARES])
def test_name_is_read_as_it_is_written(slice_name: str, seed: int | None, firmware: FirmwareName | None) -> None:
    name = WorldName(slice=slice_name, seed=seed, firmware=firmware)
    assert names_worlds(name.text)
    assert parse_world_name(name.text) == name
    assert shlex.quote(name.text) == name.text  # nothing of it means anything to a shell


@pytest.mark.parametrize("name", ["straight_5", "worldly", "world.toml", "./world@1.toml", "straight_5+wind=calm"])
def test_other_names_mean_no_worlds(name: str) -> None:
    assert not names_worlds(name)


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("world", "means many worlds"),
        ("world:urban+firmware=px4", r"such as world:urban@1\+firmware=px4"),
        ("world:nowhere@1", "no slice of the worlds is called 'world:nowhere'"),
        ("world@", "write SLICE@SEED"),
        ("world@x", "write SLICE@SEED"),
        ("world@-1", "write SLICE@SEED"),
        ("world@1+wind=calm", "draws everything but its firmware"),
        ("world@1+firmware=inav", r"\+firmware=px4, \+firmware=ardupilot"),
        (f"world@{SEEDS_END - 1}", "is held back"),
        ("world@1000000", "below 1000000"),
    ],
)
def test_name_of_no_world_is_refused_in_one_line(name: str, told: str) -> None:
    with pytest.raises(UserError, match=told) as refusal:
        load_scenario(name)
    assert "\n" not in str(refusal.value)


def test_world_is_loaded_by_its_name_as_it_is_drawn() -> None:
    scenario = load_scenario("world:urban@17")
    assert scenario.name == "world:urban@17"
    drawn = draw_world("world:urban", 17).scenario
    assert scenario == drawn.model_copy(update={"name": scenario.name})


@pytest.mark.parametrize("firmware", FIRMWARES)
def test_firmware_behind_the_name_is_the_one_that_is_drawn(firmware: FirmwareName) -> None:
    world = drawn_world(WorldName(slice="world", firmware=firmware), 5)
    assert world.scenario.firmware == firmware
    assert world.drawn["drone.firmware"] == firmware
    assert world.scenario.name == f"world@5+firmware={firmware}"


def test_firmware_changes_no_other_draw() -> None:
    px4, ardupilot = (drawn_world(WorldName(slice="world", firmware=one), 23).scenario for one in FIRMWARES)
    assert px4.vehicle == ardupilot.vehicle
    assert px4.sensors == ardupilot.sensors
    assert px4.wind == ardupilot.wind


def test_run_has_the_seed_of_its_world_unless_another_one_is_asked_for() -> None:
    assert run_seed("world:urban@17", None) == 17
    assert run_seed("world:urban@17", 3) == 3
    assert run_seed("straight_5", None) == 1
