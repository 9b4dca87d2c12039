from collections.abc import Callable, Mapping, Sequence

import pytest

from scenarios.catalogue.catalogue import load_scenario
from scenarios.config import Scenario
from scenarios.falsify.aim import Aim
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


GAP, STRENGTH = NAMES[5], NAMES[9]
LONGEST_S, TOUCHES_S = 20.0, 6.4


def gust_at(_seed: int, _chosen: Mapping[str, float], begins_s: float) -> Mapping[str, float] | None:
    return {GAP: begins_s / LONGEST_S} if 0.0 < begins_s < LONGEST_S else None


def draw_gust(_seed: int, chosen: Mapping[str, float]) -> Scenario:
    gust = {"gust_m_s": chosen[STRENGTH], "gust_at_s": LONGEST_S * chosen[GAP]}
    return PLAIN.model_copy(update={"wind": PLAIN.wind.model_copy(update=gust)})


AIMING = Space(names=NAMES, draw=draw_gust, aim=Aim(gap=GAP, strength=(STRENGTH,), at=gust_at))


class GustyAir(Air):
    """A strong gust is unsafe that begins 0.2 to 0.4 s before the contact."""

    def __init__(self, touches_s: float | None = TOUCHES_S, reaches: float = 0.9) -> None:
        super().__init__(limit=1.0)
        self.touches_s = touches_s
        self.reaches = reaches

    def outcome(self, scenario: Scenario) -> Outcome:
        lead_s = (self.touches_s or 0.0) - (scenario.wind.gust_at_s or 0.0)
        margin = self.reaches - scenario.wind.gust_m_s if 0.2 < lead_s < 0.4 else self.reaches
        tier = "unsafe" if margin < 0.0 else "S3"
        return Outcome(margin=margin, tier=tier, reason="gust", time_to_contact_s=self.touches_s)


def test_event_that_is_aimed_is_found_with_a_tenth_of_the_landings_that_chance_needs() -> None:
    seeds = range(100, 600, 100)
    aimed = [search(AIMING, GustyAir().fly, first_seed=seed, landings=500) for seed in seeds]
    drawn = [search(AIMING, GustyAir().fly, first_seed=seed, landings=5000, random=True) for seed in seeds]
    needed, chance = (sum(one.landing for one in found if one is not None) for found in (aimed, drawn))
    assert None not in (*aimed, *drawn)
    assert needed < 0.1 * chance


def test_first_landing_of_a_start_meets_no_event() -> None:
    air = GustyAir()
    search(AIMING, air.fly, first_seed=7, landings=1)
    [(scenario, seed)] = air.flown
    assert (scenario.wind.gust_at_s or 0.0) > TOUCHES_S
    assert seed == 7


@pytest.mark.parametrize("touches_s", [None, 0.1, LONGEST_S + 5.0])
def test_world_without_a_contact_to_aim_at_is_left_for_the_next(touches_s: float | None) -> None:
    air = GustyAir(touches_s)
    assert search(AIMING, air.fly, first_seed=7, landings=30) is None
    assert [seed for _, seed in air.flown] == list(range(7, 37))


def test_start_that_does_not_come_near_is_given_up_after_one_generation() -> None:
    air = GustyAir(reaches=3.0)
    search(AIMING, air.fly, first_seed=7, landings=100)
    by_seed = [sum(seed == one for _, seed in air.flown) for one in range(7, 12)]
    assert by_seed == [by_seed[0]] * 5
    assert by_seed[0] < 10


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
