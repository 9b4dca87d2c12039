"""The population against its sources: what is drawn is distributed as `odd.toml` says, and independent.

Levels: one test of a thousand would fail by chance, over all of its quantities together; the seeds are fixed.
"""

import numpy as np
import pytest
from scipy import stats

from link.errors import UserError
from scenarios.tracks.drive_config import DriveTrack
from scenarios.worlds.distributions import Choice, Graded, Plain
from scenarios.worlds.draws import Draws
from scenarios.worlds.driver import EVENTS
from scenarios.worlds.odd import Cases, quantities_of, slices
from scenarios.worlds.world import draw_world, quantities
from tests.scenarios.worlds.references import reference_of

LEVEL = 1e-3
SEEDS = range(10_000, 10_400)
WHOLE = quantities_of("world")
NAMES = sorted(WHOLE)


def values_of(name: str, seeds: range) -> list[tuple[Plain, Draws, float | str | bool]]:
    """The distribution that a quantity was drawn from in each world, the world's draws, and the value."""
    out = []
    for seed in seeds:
        draws = Draws(WHOLE, seed, {})
        quantity = WHOLE[name]
        if isinstance(quantity, Cases):
            quantity = quantity.cases[draws.word(quantity.by)]
        kind = isinstance(quantity, Choice) and not isinstance(quantity.values[0], float)
        value = draws.word(name) if kind else draws.number(name)
        out.append((quantity, draws, value))
    return out


def levels_of(drawn: list[tuple[Plain, Draws, float | str | bool]]) -> list[float]:
    """The probability of a value below each one, by scipy."""
    levels: list[float] = []
    for quantity in dict.fromkeys(quantity for quantity, _, _ in drawn):
        here = [(draws, float(value)) for one, draws, value in drawn if one == quantity]
        if isinstance(quantity, Graded):
            qualities = np.array([draws.number(quantity.quality) for draws, _ in here])
            medians = quantity.poor * (quantity.good / quantity.poor) ** qualities
            z = np.log([value for _, value in here] / medians) / quantity.spread
            levels += stats.truncnorm(-2.0, 2.0).cdf(z).tolist()
        else:
            levels += np.asarray(reference_of(quantity).cdf([value for _, value in here])).tolist()
    return levels


@pytest.mark.parametrize("name", [one for one in NAMES if not isinstance(WHOLE[one], Choice)])
def test_drawn_numbers_have_the_distribution_of_their_source(name: str) -> None:
    drawn = values_of(name, SEEDS[:150])
    if isinstance(drawn[0][0], Choice):
        pytest.skip("a choice in each case, which the test of choices covers")
    assert stats.kstest(levels_of(drawn), "uniform").pvalue > LEVEL / len(NAMES)


@pytest.mark.parametrize("name", [one for one in NAMES if isinstance(WHOLE[one], Choice)])
def test_choices_have_their_weights(name: str) -> None:
    drawn = values_of(name, SEEDS)
    choice = drawn[0][0]
    assert isinstance(choice, Choice)
    texts = [str(value) for _, _, value in drawn]
    counts = [texts.count(str(value)) for value in choice.values]
    if len(choice.values) == 1:  # which leaves chance nothing
        assert counts == [len(drawn)]
        return
    wanted = np.array(choice.weights) / sum(choice.weights) * len(drawn)
    assert stats.chisquare(counts, wanted).pvalue > LEVEL / len(NAMES)


def test_choices_by_case_have_the_weights_of_the_case() -> None:
    names = [
        name for name, one in WHOLE.items() if isinstance(one, Cases) and isinstance(one.cases.get("yard"), Choice)
    ]
    assert names
    for name in names:
        quantity = WHOLE[name]
        assert isinstance(quantity, Cases)
        case = quantity.cases["yard"]
        assert isinstance(case, Choice)
        yard = [Draws(quantities_of("world:yard"), seed, {}) for seed in SEEDS]
        texts = [str(draws.word(name)) for draws in yard]
        counts = [texts.count(str(value)) for value in case.values]
        wanted = np.array(case.weights) / sum(case.weights) * len(yard)
        assert stats.chisquare(counts, wanted).pvalue > LEVEL / len(NAMES)


def rank_correlations(uniforms: list[list[float]]) -> np.ndarray:
    """Spearman's correlation of each pair of columns."""
    ranks = np.asarray(stats.rankdata(np.array(uniforms), axis=0))
    matrix: np.ndarray = np.asarray(np.corrcoef(ranks, rowvar=False))
    return matrix[np.triu_indices(len(uniforms[0]), 1)]


@pytest.mark.slow
def test_quantities_are_independent_of_each_other() -> None:
    names = [name for name in NAMES if not isinstance(WHOLE[name], Cases)][:60]
    worlds = [Draws(WHOLE, seed, {}) for seed in SEEDS]
    for draws in worlds:
        for name in names:
            draws.word(name)
    correlation = rank_correlations([[draws.uniforms[name] for name in names] for draws in worlds])
    # a rank correlation of independent numbers is normal, with a standard deviation of 1 / sqrt(n - 1)
    bound = stats.norm.isf(0.5 * LEVEL / len(correlation)) / np.sqrt(len(worlds) - 1)
    assert np.abs(correlation).max() < bound


def test_slots_of_a_quantity_are_independent_of_each_other() -> None:
    worlds = [Draws(WHOLE, seed, {}) for seed in SEEDS]
    gaps = [[draws.number("driver.event_gap_s", slot) for slot in range(EVENTS)] for draws in worlds]
    assert len({value for row in gaps for value in row}) == EVENTS * len(worlds)
    correlation = rank_correlations(
        [[draws.uniforms[f"driver.event_gap_s.{slot}"] for slot in range(EVENTS)] for draws in worlds]
    )
    assert np.abs(correlation).max() < stats.norm.isf(0.5 * LEVEL / len(correlation)) / np.sqrt(len(worlds) - 1)


def test_a_quantity_is_drawn_the_same_whatever_else_is_drawn() -> None:
    first, second = Draws(WHOLE, 7, {}), Draws(WHOLE, 7, {})
    alone = first.number("drone.mass_kg")
    for name in NAMES:
        second.word(name) if name != "drone.mass_kg" else None
    assert second.number("drone.mass_kg") == alone


@pytest.mark.parametrize("name", slices())
def test_every_world_draws_and_tells_the_same_names(name: str) -> None:
    assert quantities(name, 3) == quantities("world", 1)
    assert list(draw_world(name, 3).drawn) == list(draw_world("world", 1).drawn)


@pytest.mark.parametrize(
    ("name", "road"), [("world:urban", "urban"), ("world:highway", "highway"), ("world:yard", "yard")]
)
def test_slice_by_road_has_that_road_only(name: str, road: str) -> None:
    assert {Draws(quantities_of(name), seed, {}).word("road.class") for seed in SEEDS[:50]} == {road}


def test_poor_slice_differs_in_the_qualities_only() -> None:
    poor, whole = draw_world("world:poor", 5), draw_world("world", 5)
    assert poor.drawn["sensors.quality"] <= 0.3  # type: ignore[operator]  # a number
    assert poor.drawn["link.quality"] <= 0.3  # type: ignore[operator]  # likewise
    assert poor.scenario.track.model_dump(exclude={"departure"}) == whole.scenario.track.model_dump(
        exclude={"departure"}
    )


def test_late_slice_differs_in_its_brake_only() -> None:
    late, whole = draw_world("world:late", 5).scenario, draw_world("world", 5).scenario
    assert isinstance(late.track, DriveTrack)
    assert late.track.brake is not None
    assert late.track.model_copy(update={"brake": None}) == whole.track
    assert late.model_copy(update={"name": whole.name, "track": whole.track}) == whole


def test_chosen_number_takes_the_place_of_the_drawn_one_alone() -> None:
    name = "driver.brake_m_s2.2"
    plain, chosen = draw_world("world", 4), draw_world("world", 4, chosen={"wind.mean_m_s": 0.999, name: 0.5})
    changed = {key for key, value in plain.drawn.items() if chosen.drawn[key] != value}
    assert "wind.mean_m_s" in changed
    assert changed <= {"wind.mean_m_s"} | {key for key in plain.drawn if key.startswith("drive.")}
    again = draw_world("world", 4, chosen={"wind.mean_m_s": 0.999, name: 0.5})
    assert again.scenario == chosen.scenario


@pytest.mark.parametrize(
    ("chosen", "told"),
    [
        ({"wind.mean": 0.5}, "'wind.mean'"),
        ({"wind.mean_m_s": 1.0}, "between 0 and 1"),
        ({"wind.mean_m_s": float("nan")}, "nan"),
    ],
)
def test_choosing_what_cannot_be_is_a_users_error(chosen: dict[str, float], told: str) -> None:
    with pytest.raises(UserError, match=told):
        draw_world("world", 4, chosen=chosen)


@pytest.mark.parametrize("name", ["world:moon", "worlds", "world:", "straight_5"])
def test_unknown_slice_is_a_users_error_that_names_those_there_are(name: str) -> None:
    with pytest.raises(UserError, match="world:highway"):
        draw_world(name, 1)
