from scenarios.rare.chain import Walk, walk
from scenarios.rare.noise import Move, MovedNoise
from tests.scenarios.rare.limit_states import linear

FIRST = MovedNoise(seed=3)
MOVES = tuple(Move(seed=seed, angle_rad=0.8) for seed in range(10, 22))


def test_walk_without_a_margin_flies_the_landing_itself() -> None:
    margin = linear(0.1)
    end = walk(Walk(noise=FIRST), margin)
    assert (end.noise, end.margin, end.flown, end.taken) == (FIRST, margin(FIRST), 1, 0)


def test_chain_takes_what_is_below_the_level_and_nothing_else() -> None:
    margin = linear(0.1)
    level = margin(FIRST) + 0.05
    end = walk(Walk(noise=FIRST, margin=margin(FIRST), level=level, moves=MOVES), margin)
    at = FIRST
    for move in MOVES:
        if margin(at.moved(move)) < level:
            at = at.moved(move)
    assert end.noise == at
    assert end.margin == margin(at) < level
    assert 0 < end.taken < len(MOVES) == end.flown
