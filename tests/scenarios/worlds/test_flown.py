"""A flown world: read back from its run's own file, and replayed."""

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
SHORT = WORLD.scenario.with_run(time_limit_s=15.0)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("world")
    run_in_lockstep(SHORT, RunOptions(seed=SEED, speed=1.0, folder=folder, record=True), lambda *_: None)
    return folder


def test_file_of_a_run_holds_the_world_that_was_flown(run: Path) -> None:
    assert load_scenario(str(run / "scenario.toml")) == SHORT


def test_replay_of_a_world_equals_its_flight_in_every_field(run: Path) -> None:
    ((_, flight),) = read_flights(run)
    result = replay(flight)
    assert result.steps > 500
    assert result.differences == ()
    assert result.missing_inputs == 0
