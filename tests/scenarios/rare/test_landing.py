import json
from pathlib import Path

import pytest

from link.program.cli import make_app, run_app
from scenarios.catalogue.catalogue import load_scenario
from scenarios.commands import campaign as campaign_commands
from scenarios.commands import rare as rare_commands
from scenarios.rare.chain import LaterStep, Walk, WholeStep
from scenarios.rare.landing import Cell, Chains, fly_landing, flying, subject_of
from scenarios.rare.noise import Move, MovedNoise, NoiseInFlight
from tests.scenarios.campaigns.short import failing_cell, short_cell

FIRST = MovedNoise(seed=3)
BESIDE = FIRST.changed(Move(seed=4, angle_rad=0.5))


def scenarios(*args: object) -> int:
    """Run a program with the command, and another one beside it, and return its exit code."""
    app = make_app("Rare events.")
    for commands in (rare_commands, campaign_commands):
        commands.register(app)
    return run_app("scenarios", app, ["rare", *(str(arg) for arg in args)])


@pytest.mark.slow
def test_noise_decides_the_landing_and_a_move_changes_it(tmp_path: Path) -> None:
    subject = Cell(cell=load_scenario(short_cell(tmp_path)))
    first, again, beside = (fly_landing(subject, NoiseInFlight(noise)) for noise in (FIRST, FIRST, BESIDE))
    assert first == again
    assert first != beside


@pytest.mark.slow
def test_redrawn_landing_flies_the_same_again(tmp_path: Path) -> None:
    subject = Cell(cell=load_scenario(short_cell(tmp_path, time_limit_s=3.0)))
    before = fly_landing(subject, NoiseInFlight(FIRST))
    climbing_s = 0.2 * before.duration_s  # how far it has climbed by the end decides its margin
    redrawn = NoiseInFlight(FIRST, redraw_seed=8, from_s=climbing_s)
    after = fly_landing(subject, redrawn)
    assert after != before
    assert fly_landing(subject, NoiseInFlight(redrawn.flown())) == after


@pytest.mark.slow
def test_chains_end_in_other_processes_as_in_this_one(tmp_path: Path) -> None:
    subject = Cell(cell=load_scenario(short_cell(tmp_path)))
    steps = (WholeStep(seed=6, angle_rad=0.5), LaterStep(seed=7, share=0.3))
    walks = [Walk(noise=BESIDE, steps=steps)]
    chains = Chains(subject=subject)
    with flying(subject, 1) as fly:
        assert fly(walks) == [chains(walk) for walk in walks]


@pytest.mark.slow
def test_landings_that_raise_are_told_and_give_no_probability(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cell = failing_cell(tmp_path)
    assert scenarios(cell, "--particles", 20, "--workers", 1, "--json") == 1
    table = json.loads(capsys.readouterr().out)
    assert (table["converged"], table["verdict"], table["probability"]) == (False, "failed", None)
    assert len(table["errors"]) == 20


@pytest.mark.parametrize(
    ("options", "named"),
    [
        (["nowhere_5"], "nowhere_5"),
        (["world:nowhere"], "world:nowhere"),
        (["world", "--firmware", "px4"], "--firmware"),
        (["straight_5", "--level", "0"], "--level"),
    ],
)
def test_what_cannot_be_flown_is_one_clear_line(
    options: list[str], named: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert scenarios(*options) == 2
    told = capsys.readouterr().err
    assert named in told
    assert told.count("\n") == 1


def test_noise_draws_the_world_and_a_small_move_changes_it_a_little() -> None:
    subject = subject_of("world")
    first, again = subject.scenario(FIRST), subject.scenario(FIRST)
    assert first == again
    nearby = subject.scenario(FIRST.changed(Move(seed=4, angle_rad=1e-3)))
    assert nearby.wind.mean_m_s == pytest.approx(first.wind.mean_m_s, rel=0.02)
    assert nearby.wind.mean_m_s != first.wind.mean_m_s
