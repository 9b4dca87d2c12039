from collections.abc import Callable, Mapping, Sequence

import pytest

from scenarios.catalogue.catalogue import load_scenario
from scenarios.config import Scenario
from scenarios.falsify.flights import Flight
from scenarios.falsify.reduction import Case, Reduction
from scenarios.falsify.search import Found, Space, search
from scenarios.falsify.trial import Outcome

NAMES = tuple(f"quantity.{index}" for index in range(20))
PLAIN = load_scenario("straight_5+wind=nominal+link=nominal")
WIND, DELAY = 3, 11


def draw(_seed: int, chosen: Mapping[str, float]) -> Scenario:
    """Draw wind up to 20 m/s and a delay up to 1 s; the other quantities change what does not matter."""
    wind = PLAIN.wind.model_copy(update={"mean_m_s": 20.0 * chosen[NAMES[WIND]]})
    zenoh = PLAIN.link.zenoh.model_copy(update={"delay_s": chosen[NAMES[DELAY]]})
    others = sum(u for name, u in chosen.items() if name not in {NAMES[WIND], NAMES[DELAY]})
    link = PLAIN.link.model_copy(update={"zenoh": zenoh})
    return PLAIN.model_copy(update={"wind": wind, "link": link}).with_run(time_limit_s=100.0 + others)


class Air:
    """Flies without flying: strong wind together with much delay is unsafe."""

    def __init__(self, limit: float) -> None:
        self.limit = limit
        self.flown: list[Flight] = []

    def fly(self, flights: Sequence[Flight], is_last: Callable[[Outcome], bool]) -> list[Outcome]:
        outcomes: list[Outcome] = []
        for scenario, seed in flights:
            self.flown.append((scenario, seed))
            outcomes.append(self.outcome(scenario))
            if is_last(outcomes[-1]):
                break
        return outcomes

    def outcome(self, scenario: Scenario) -> Outcome:
        margin = self.limit - 0.05 * scenario.wind.mean_m_s * scenario.link.zenoh.delay_s
        return Outcome(margin=margin, tier="unsafe" if margin < 0.0 else "S3", reason="windy")


SPACE = Space(names=NAMES, draw=draw)


def found_with(air: Air) -> Found:
    found = search(SPACE, air.fly, first_seed=7, landings=500)
    assert found is not None
    return found


def test_search_says_which_landing_was_the_first_unsafe_one() -> None:
    air = Air(limit=0.9)
    found = found_with(air)
    outcomes = [air.outcome(scenario) for scenario, _ in air.flown]
    assert [one.is_unsafe for one in outcomes].index(True) == found.landing - 1 == len(outcomes) - 1
    assert draw(found.seed, found.chosen) == air.flown[found.landing - 1][0]


def test_search_flies_no_more_than_it_may() -> None:
    air = Air(limit=5.0)
    assert search(SPACE, air.fly, first_seed=7, landings=101) is None
    assert len(air.flown) == 101


def test_each_start_is_about_another_seed() -> None:
    air = Air(limit=5.0)
    search(SPACE, air.fly, first_seed=7, landings=900)
    seeds = [seed for _, seed in air.flown]
    assert seeds == sorted(seeds)
    assert set(seeds) == set(range(7, max(seeds) + 1))
    assert max(seeds) > 8


def test_search_goes_on_where_landings_have_no_result() -> None:
    lost = Outcome(margin=None, tier=None, reason=None, error="ValueError: no")
    assert search(SPACE, lambda flights, _: [lost] * len(flights), first_seed=1, landings=60) is None


def reduced(air: Air, landings: int) -> Reduction:
    reduction = Reduction(found_with(air), SPACE, air.fly, landings=landings)
    reduction.put_to_medians()
    reduction.make_ideal()
    return reduction


def test_reduction_puts_back_what_the_failure_does_not_need() -> None:
    case = reduced(Air(limit=0.9), 300).case
    assert set(case.chosen) == {NAMES[WIND], NAMES[DELAY]}
    assert case.outcome.is_unsafe


def test_reduced_case_keeps_half_of_how_far_it_was_beyond_the_limit() -> None:
    air = Air(limit=0.9)
    found = found_with(air)
    case = reduced(air, 300).case
    assert case.outcome.margin is not None
    assert found.outcome.margin is not None
    assert case.outcome.margin <= 0.5 * found.outcome.margin


def test_reduction_makes_ideal_what_the_failure_does_not_need() -> None:
    scenario = reduced(Air(limit=0.9), 300).case.scenario
    assert scenario.wind.turbulence == "none"
    assert scenario.wind.mean_m_s > 0.0
    assert scenario.link.mavlink.delay_s == 0.0
    assert scenario.link.zenoh.delay_s > 0.0


@pytest.mark.parametrize("landings", [0, 1, 7])
def test_reduction_flies_no_more_than_it_may_and_still_has_an_unsafe_case(landings: int) -> None:
    air = Air(limit=0.9)
    searched = found_with(air).landing
    air.flown.clear()
    case = reduced(air, landings).case
    assert len(air.flown) <= searched + landings
    assert case.outcome.is_unsafe


def test_reduction_flies_no_scenario_twice() -> None:
    air = Air(limit=0.9)
    reduced(air, 300)
    texts = [scenario.model_dump_json() for scenario, _ in air.flown]
    assert len(texts) == len(set(texts))


def test_every_case_that_is_kept_is_unsafe_and_smaller_than_the_one_before() -> None:
    air = Air(limit=0.9)
    kept: list[Case] = []
    reduction = Reduction(found_with(air), SPACE, air.fly, landings=300, keep=kept.append)
    reduction.put_to_medians()
    assert kept[-1] == reduction.case
    assert all(air.outcome(case.scenario) == case.outcome and case.outcome.is_unsafe for case in kept)
    sizes = [len(case.chosen) for case in kept]
    assert sizes == sorted(set(sizes), reverse=True)
