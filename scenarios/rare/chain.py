"""A chain of landings, each beside the one before: how a copied landing leaves what it was copied from.

A change of the noise is taken if the landing that comes of it is worse than the level, else the chain stays where it
is. This is Metropolis' rule for the noise's own distribution among the landings worse than the level, which it leaves
as it is. A redrawing begins at a share of the landing's duration T, which is another one after it, T': it is taken with
the probability T / T' at most, for with that factor it is as likely to come back as to go.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from scenarios.rare.noise import Move, MovedNoise, NoiseInFlight


@dataclass(frozen=True, slots=True, kw_only=True)
class Landing:
    """What was flown with a noise.

    Attributes:
        margin: negative exactly if it is unsafe.
        duration_s: of the run.
    """

    margin: float
    duration_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class WholeStep:
    """A change that is tried: a move of the whole noise by an angle."""

    seed: int
    angle_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LaterStep:
    """A change that is tried: new noise from a share of the landing's duration on, 0 to 1."""

    seed: int
    share: float


Step = WholeStep | LaterStep


@dataclass(frozen=True, slots=True, kw_only=True)
class Walk:
    """What a chain begins with, and what it tries; without steps it flies the landing itself.

    Attributes:
        noise: of the landing at its beginning.
        landing: that landing, None where it is still to be flown.
        level: that a landing's margin has to be below.
        steps: tried one after the other.
    """

    noise: MovedNoise
    landing: Landing | None = None
    level: float = float("inf")
    steps: tuple[Step, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Walked:
    """Where a chain has ended.

    Attributes:
        noise: of the landing at its end.
        landing: at its end, None where it could not be flown.
        flown: how many landings that took.
        taken: the indices of the steps that were.
        error: what a landing raised, None where all went well.
    """

    noise: MovedNoise
    landing: Landing | None
    flown: int
    taken: tuple[int, ...]
    error: str | None = None


FlyOne = Callable[[NoiseInFlight], Landing]
"""Flies the landing that a noise decides."""


def walk(start: Walk, fly_one: FlyOne) -> Walked:
    """Return where a chain ends."""
    noise, landing = start.noise, start.landing
    flown, taken = len(start.steps), []
    if landing is None:
        landing, flown = fly_one(NoiseInFlight(noise)), flown + 1
    for index, step in enumerate(start.steps):
        tried = _tried(noise, landing, step)
        found = fly_one(tried)
        if found.margin < start.level and _may_come_back(step, landing, found):
            noise, landing = tried.flown(), found
            taken.append(index)
    return Walked(noise=noise, landing=landing, flown=flown, taken=tuple(taken))


def _tried(noise: MovedNoise, landing: Landing, step: Step) -> NoiseInFlight:
    if isinstance(step, WholeStep):
        return NoiseInFlight(noise.changed(Move(seed=step.seed, angle_rad=step.angle_rad)))
    return NoiseInFlight(noise, redraw_seed=step.seed, from_s=step.share * landing.duration_s)


def _may_come_back(step: Step, before: Landing, after: Landing) -> bool:
    if isinstance(step, WholeStep) or after.duration_s <= before.duration_s:
        return True
    return bool(np.random.default_rng(step.seed).random() < before.duration_s / after.duration_s)
