"""A chain of landings, each a little beside the one before: how a copied landing leaves what it was copied from.

A move is taken if the landing that comes of it is worse than the level, else the chain stays where it is. This is
Metropolis' rule for the noise's own distribution among the landings worse than the level, which it leaves as it is.
"""

from collections.abc import Callable
from dataclasses import dataclass

from scenarios.rare.noise import Move, MovedNoise


@dataclass(frozen=True, slots=True, kw_only=True)
class Walk:
    """What a chain begins with, and what it tries; without moves it flies the landing itself.

    Attributes:
        noise: of the landing at its beginning.
        margin: of that landing, None where it is still to be flown.
        level: that a landing's margin has to be below.
        moves: tried one after the other.
    """

    noise: MovedNoise
    margin: float | None = None
    level: float = float("inf")
    moves: tuple[Move, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Walked:
    """Where a chain has ended.

    Attributes:
        noise: of the landing at its end.
        margin: of that landing.
        flown: how many landings that took.
        taken: how many of the moves were.
        error: what a landing raised, None where all went well.
    """

    noise: MovedNoise
    margin: float
    flown: int
    taken: int
    error: str | None = None


MarginOf = Callable[[MovedNoise], float]
"""Flies the landing that a noise decides and returns its margin, negative exactly if it is unsafe."""


def walk(start: Walk, margin_of: MarginOf) -> Walked:
    """Return where a chain ends."""
    noise, margin, flown, taken = start.noise, start.margin, 0, 0
    if margin is None:
        margin, flown = margin_of(noise), 1
    for move in start.moves:
        tried = noise.moved(move)
        tried_margin = margin_of(tried)
        flown += 1
        if tried_margin < start.level:
            noise, margin, taken = tried, tried_margin, taken + 1
    return Walked(noise=noise, margin=margin, flown=flown, taken=taken)
