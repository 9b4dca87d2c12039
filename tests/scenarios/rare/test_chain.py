import numpy as np

from scenarios.rare.chain import FlyOne, Landing, LaterStep, Walk, WholeStep, walk
from scenarios.rare.noise import Move, MovedNoise, NoiseInFlight, Redraw
from tests.scenarios.rare.limit_states import at_once, linear

FIRST = MovedNoise(seed=3)
STEPS = tuple(WholeStep(seed=seed, angle_rad=0.8) for seed in range(10, 22))


def test_walk_without_a_landing_flies_it() -> None:
    margin = linear(0.1)
    end = walk(Walk(noise=FIRST), at_once(margin))
    assert (end.noise, end.flown, end.taken) == (FIRST, 1, ())
    assert end.landing == Landing(margin=margin(FIRST), duration_s=0.0)


def test_chain_takes_what_is_below_the_level_and_nothing_else() -> None:
    margin = linear(0.1)
    level = margin(FIRST) + 0.05
    first = Landing(margin=margin(FIRST), duration_s=0.0)
    end = walk(Walk(noise=FIRST, landing=first, level=level, steps=STEPS), at_once(margin))
    at = FIRST
    for step in STEPS:
        tried = at.changed(Move(seed=step.seed, angle_rad=step.angle_rad))
        at = tried if margin(tried) < level else at
    assert end.noise == at
    assert end.landing is not None
    assert end.landing.margin == margin(at) < level
    assert 0 < len(end.taken) < len(STEPS) == end.flown


def lasting(duration_s: float, instants_s: list[float]) -> FlyOne:
    """Landings below every level that note from when on they were drawn anew."""

    def fly_one(noise: NoiseInFlight) -> Landing:
        stream = noise.stream("z")
        clock = iter(np.arange(0.0, 100.0, 0.5).tolist())
        now_s = 0.0
        noise.now_s = lambda: now_s
        for now_s in clock:  # noqa: B007 (the clock reads it)
            stream.standard_normal()
        (redraw,) = noise.flown().changes
        assert isinstance(redraw, Redraw)
        instants_s.append(0.5 * redraw.kept_of("z"))
        return Landing(margin=-1.0, duration_s=duration_s)

    return fly_one


def test_later_step_draws_anew_from_its_share_of_the_duration_on() -> None:
    instants_s: list[float] = []
    before = Landing(margin=0.5, duration_s=40.0)
    start = Walk(noise=FIRST, landing=before, level=1.0, steps=(LaterStep(seed=5, share=0.75),))
    assert walk(start, lasting(40.0, instants_s)).taken == (0,)
    assert instants_s == [30.0]


def test_landing_that_lasts_longer_is_taken_as_seldom_as_it_would_come_back() -> None:
    before = Landing(margin=0.5, duration_s=30.0)
    fly_one = lasting(40.0, [])
    steps = [LaterStep(seed=seed, share=0.5) for seed in range(200)]
    taken = sum(len(walk(Walk(noise=FIRST, landing=before, level=1.0, steps=(step,)), fly_one).taken) for step in steps)
    assert abs(taken / 200 - 0.75) < 4.0 * np.sqrt(0.75 * 0.25 / 200)
