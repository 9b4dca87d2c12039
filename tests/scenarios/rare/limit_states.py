"""Margins in closed form, whose probability of being negative is known exactly, and a splitting of them."""

import math
from collections.abc import Callable

from scipy import stats

from scenarios.rare.chain import walk
from scenarios.rare.noise import MovedNoise
from scenarios.rare.splitting import Population, Settings, split

MarginOf = Callable[[MovedNoise], float]


def linear(probability: float, dimensions: int = 50) -> MarginOf:
    """A plane at its distance from the origin, askew to every axis."""
    distance = -stats.norm.ppf(probability)

    def margin(noise: MovedNoise) -> float:
        z = noise.stream("z").standard_normal(dimensions)
        return float(distance - z.sum() / math.sqrt(dimensions))

    return margin


def two_regions(probability: float) -> MarginOf:
    """Either of two planes across each other; the one is approached faster than the other."""
    each = 1.0 - math.sqrt(1.0 - probability)
    distance = -stats.norm.ppf(each)
    return lambda noise: min(region(noise, "a", distance), 0.8 * region(noise, "b", distance))


def region(noise: MovedNoise, name: str, distance: float) -> float:
    """The distance from one plane."""
    return distance - float(noise.stream(name).standard_normal(10)[3])


def split_margin(margin_of: MarginOf, *, particles: int, seed: int, moves: int = 4, least: float = 1e-9) -> Population:
    """Return the population of a splitting in this process."""
    settings = Settings(particles=particles, moves=moves, least=least, seed=seed)
    return split(settings, lambda walks: [walk(one, margin_of) for one in walks], lambda _: None)
