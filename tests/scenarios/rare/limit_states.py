"""Margins in closed form, whose probability of being negative is known exactly, and a splitting of them."""

import math
from collections.abc import Callable

from scipy import stats

from scenarios.rare.chain import FlyOne, Landing, walk
from scenarios.rare.noise import MovedNoise, NoiseInFlight
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


def at_once(margin_of: MarginOf) -> FlyOne:
    """Landings that take no time."""
    return lambda noise: Landing(margin=margin_of(noise.flown()), duration_s=0.0)


def waiting(probability: float, end: float = 0.1) -> FlyOne:
    """Landings that end in each second with the probability `end`; those that last too long are unsafe."""
    longest_s = math.log(probability) / math.log(1.0 - end)

    def fly_one(noise: NoiseInFlight) -> Landing:
        now_s, stream = 1, noise.stream("end")
        noise.now_s = lambda: now_s
        while (last := stream.random()) > end:
            now_s += 1
        fraction = last / end  # tells apart what lasts as long
        return Landing(margin=math.ceil(longest_s) - now_s + 0.9 * fraction, duration_s=now_s)

    return fly_one


def waiting_probability(probability: float, end: float = 0.1) -> float:
    """What `probability` comes to in whole seconds."""
    return float((1.0 - end) ** math.ceil(math.log(probability) / math.log(1.0 - end)))


def split_margin(margin_of: MarginOf, *, particles: int, seed: int, least: float = 1e-9) -> Population:
    """Return the population of a splitting in this process, of landings that take no time."""
    return split_landings(at_once(margin_of), particles=particles, seed=seed, in_time=False, least=least)


def split_landings(
    fly_one: FlyOne, *, particles: int, seed: int, in_time: bool = True, least: float = 1e-9
) -> Population:
    """Return the population of a splitting in this process."""
    settings = Settings(particles=particles, steps=4, in_time=in_time, least=least, seed=seed)
    return split(settings, lambda walks: [walk(one, fly_one) for one in walks], lambda _: None)
