"""The range finder that looks down, as a data sheet describes it."""

from dataclasses import dataclass

import numpy as np

from sim_autopilot.core.noise import NoiseSeed

_BLOCK = 1024  # errors that are drawn at once


@dataclass(frozen=True, slots=True, kw_only=True)
class RangeFinderModel:
    """A range finder along the body's axis; by default one that is always right.

    Attributes:
        seed: of its errors, or the generator that draws them.
        white_std_m: of a reading.
        min_m: what is nearer is told as so far.
        max_m: what is farther, or not there, is told as so far.
    """

    seed: NoiseSeed = 0
    white_std_m: float = 0.0
    min_m: float = 0.0
    max_m: float = 100.0


class RangeErrors:
    """The errors of the readings, step by step; the same seed gives the same ones."""

    def __init__(self, model: RangeFinderModel) -> None:
        self._std_m = model.white_std_m
        self._generator = np.random.default_rng(model.seed)
        self._drawn: list[float] = []

    def advance(self) -> float:
        """Return by how much a reading would be off a step later, m."""
        if self._std_m == 0.0:
            return 0.0
        if not self._drawn:
            self._drawn = (self._std_m * self._generator.standard_normal(_BLOCK)).tolist()
        return self._drawn.pop()
