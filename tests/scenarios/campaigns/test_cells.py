"""What a campaign flies as one cell."""

import json
from pathlib import Path

import pytest

from link.errors import UserError
from scenarios.campaigns import cells
from scenarios.campaigns.cells import Population, draw, load_cell, with_companion
from scenarios.campaigns.landing_task import Flights, Task
from scenarios.campaigns.plan import Plan, make_plan
from scenarios.catalogue.catalogue import load_scenario
from scenarios.config import Scenario
from scenarios.recordings.versions import sources
from scenarios.worlds.world import World, draw_world
from tests.scenarios.campaigns.short import scenarios


def test_slice_is_a_population_and_one_of_its_worlds_a_scenario() -> None:
    assert load_cell("world:urban+firmware=px4") == Population(slice="world:urban", firmware="px4")
    assert load_cell("world:urban@3") == load_scenario("world:urban@3")


def test_every_number_that_a_world_draws_is_a_column() -> None:
    drawn = draw(Population(slice="world:highway"), 12)
    world = draw_world("world:highway", 12)
    assert drawn.columns == {f"world.{name}": value for name, value in world.drawn.items()}
    assert drawn.scenario == load_scenario("world:highway@12")


def test_scenario_flies_itself_with_every_seed() -> None:
    cell = load_cell("straight_5")
    assert draw(cell, 3).scenario is draw(cell, 4).scenario
    assert draw(cell, 3).columns == {}


def test_configuration_is_laid_over_that_of_each_world() -> None:
    plain = Population(slice="world")
    changed = with_companion(plain, {"descent": {"alignment": {"height_m": 1.25}}}, "own.toml")
    for seed in (1, 2):
        before, after = (draw(one, seed).scenario.model_dump() for one in (plain, changed))
        assert after["system"]["companion"]["descent"]["alignment"].pop("height_m") == 1.25
        assert before["system"]["companion"]["descent"]["alignment"].pop("height_m") != 1.25
        assert after == before


def test_plan_holds_slices_by_their_names_however_many_worlds_they_are() -> None:
    few, many = (make_plan(["world"], first_seed=1, seeds=seeds, config=None, firmware="both") for seeds in (3, 3000))
    assert few.populations == many.populations
    assert few.cells == ["world+firmware=px4", "world+firmware=ardupilot"]
    assert Plan.model_validate_json(json.dumps(many.model_dump(mode="json"))) == many


def test_seed_that_the_results_have_no_room_for_is_refused_before_anything_is_flown() -> None:
    assert make_plan(["straight_5"], first_seed=2**63 - 2, seeds=2, config=None).seed_range[-1] == 2**63 - 1
    with pytest.raises(UserError, match=f"the last seed must be at most {2**63 - 1}$"):
        make_plan(["straight_5"], first_seed=2**63 - 1, seeds=2, config=None)


def test_plan_mixes_slices_and_scenarios() -> None:
    plan = make_plan(["world:yard", "straight_5"], first_seed=1, seeds=1, config=None)
    assert {name: type(cell) for name, cell in plan.flown.items()} == {"world:yard": Population, "straight_5": Scenario}
    with pytest.raises(ValueError, match="each cell needs one"):
        Plan.model_validate({**plan.model_dump(), "populations": {}})


@pytest.mark.slow
def test_world_that_cannot_be_drawn_is_a_row_with_its_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> World:
        raise ArithmeticError("no road is that\n short")

    monkeypatch.setattr(cells, "drawn_world", fail)
    flights = Flights(cells={"world": Population(slice="world")}, sources=sources())
    assert flights(Task(cell="world", seed=7)).row == {
        "cell": "world",
        "seed": 7,
        "firmware": None,
        "error": "ArithmeticError: no road is that short (test_cells.py, fail)",
    }


def test_world_that_cannot_be_flown_is_a_row_with_its_error_and_what_was_drawn(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fail(*_: object) -> None:
        raise ArithmeticError("not finite")

    monkeypatch.setattr("scenarios.campaigns.landing_task.Lockstep", fail)
    flights = Flights(cells={"world": Population(slice="world")}, sources=sources())
    row = flights(Task(cell="world", seed=7)).row
    world = draw_world("world", 7)
    assert row["error"] == "ArithmeticError: not finite (test_cells.py, fail)"
    assert row["firmware"] == world.scenario.firmware
    assert {name: row[f"world.{name}"] for name in world.drawn} == dict(world.drawn)


def test_whole_slice_is_no_scenario_for_a_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(UserError, match="such as world:urban@1"):
        load_scenario("world:urban")
    assert scenarios("campaign", "world:urban@", "--out", tmp_path / "out") == 2
    assert "write SLICE@SEED" in capsys.readouterr().err
