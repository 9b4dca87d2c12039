"""A flown world: the same bits from its seed, from its file, and replayed."""

from pathlib import Path

import pytest

from scenarios.catalogue.catalogue import load_scenario
from scenarios.lockstep.run import run_in_lockstep
from scenarios.recordings.replay import read_flights, replay
from scenarios.recordings.run_folder import RunOptions
from scenarios.worlds.world import draw_world

pytestmark = pytest.mark.slow
SEED = 2
WORLD = draw_world("world", SEED)


def options(folder: Path) -> RunOptions:
    return RunOptions(seed=SEED, speed=1.0, folder=folder, record=True)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("world")
    run_in_lockstep(WORLD.scenario, options(folder), lambda *_: None)
    return folder


def test_world_that_is_flown_from_its_runs_own_file_has_the_same_result(run: Path, tmp_path: Path) -> None:
    scenario = load_scenario(str(run / "scenario.toml"))
    run_in_lockstep(scenario, options(tmp_path), lambda *_: None)
    assert (tmp_path / "result.json").read_bytes() == (run / "result.json").read_bytes()


def test_replay_of_a_world_equals_its_flight_in_every_field(run: Path) -> None:
    ((_, flight),) = read_flights(run)
    result = replay(flight)
    assert result.steps > 500
    assert result.differences == ()
    assert result.missing_inputs == 0
