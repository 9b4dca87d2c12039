"""The random numbers of all forecasts, made once: the same in each step, so that a forecast changes by what it knows.

Each branch is a Latin hypercube (McKay, Beckman and Conover 1979): of every number of a sample's, each n-th of its
distribution is drawn once. Gusts are drawn independently.
"""

from functools import cache

import numpy as np
from msgspec import Struct
from scipy.special import ndtri

from companion.core.data import Array
from companion.forecast.samples import IndexArray

STEPS_MAX = 134  # as far as the pad is forecast, 4 s: 3.5 s of sinking and the longest wait
MODE = 7  # the column of the uniform numbers that chooses a sample's model of the estimator
_SEED = 1_912
_STEADY_COUNT, _EVENT_COUNT = 64, 32
_NORMALS, _UNIFORMS, _TILTS = 20, 8, 4


class Draws(Struct, frozen=True, kw_only=True, eq=False):
    """Numbers of n samples in four branches.

    Attributes:
        branch: (n,) what the sample's vehicle does, as `branches` counts them.
        share: (n,) of a sample in its branch.
        normals: (n, 20) standard normal.
        uniforms: (n, 8) from 0 to 1, exclusive.
        pushes: (n, `STEPS_MAX`, 2) standard normal.
        tilts: (n, 4) standard normal.
    """

    branch: IndexArray
    share: Array
    normals: Array
    uniforms: Array
    pushes: Array
    tilts: Array


@cache
def draws() -> Draws:
    """Return the numbers."""
    counts = (_STEADY_COUNT, _EVENT_COUNT, _EVENT_COUNT, _EVENT_COUNT)
    generator = np.random.default_rng(_SEED)
    numbers = np.concatenate([_hypercube(generator, count, _NORMALS + _UNIFORMS) for count in counts])
    pushes = generator.standard_normal((sum(counts), STEPS_MAX, 2))
    return Draws(
        branch=np.repeat(np.arange(len(counts)), counts),
        share=np.repeat(1.0 / np.array(counts), counts),
        normals=np.asarray(ndtri(numbers[:, :_NORMALS])),
        uniforms=numbers[:, _NORMALS:].copy(),
        pushes=pushes,
        tilts=np.asarray(ndtri(np.concatenate([_hypercube(generator, count, _TILTS) for count in counts]))),
    )


def _hypercube(generator: np.random.Generator, count: int, size: int) -> Array:
    """Return (count, size) numbers from 0 to 1, exclusive."""
    places = generator.permuted(np.tile(np.arange(count)[:, None], (1, size)), axis=0)
    return np.asarray((places + generator.uniform(0.05, 0.95, places.shape)) / count)
