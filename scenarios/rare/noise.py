"""The noise of a run as a point that can be moved a little, without changing how it is distributed.

All that is random in a run is a function of a vector z of independent standard normal numbers: each named generator
draws its own part of it, and a uniform number is the normal distribution's value at one of them. The move

    z' = z cos(a) + x sin(a),  x standard normal

leaves that distribution as it is for every angle a (preconditioned Crank-Nicolson; S. L. Cotter et al., Statist. Sci.
28 (2013) 424; in subset simulation I. Papaioannou et al., Probab. Eng. Mech. 41 (2015) 89), whatever the length of z.
Nothing needs to know that length: a point is the seed of its first z and the seed and angle of each move since.
"""

import math
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

_BLOCK_FIRST, _BLOCK_MAX = 16, 4096  # values made at once: many parts draw a single number, others all the time
_BELOW_ONE = float(np.nextafter(1.0, 0.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """A move by `angle_rad`, 0 to pi / 2, towards the noise of `seed`; pi / 2 leaves nothing of what was before."""

    seed: int
    angle_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MovedNoise:
    """All random numbers of a run: the noise of `seed` after `moves`. It is small, and can be sent and kept."""

    seed: int
    moves: tuple[Move, ...] = ()

    def __str__(self) -> str:
        return f"{self.seed}-{zlib.crc32(repr(self.moves).encode()):08x}"

    def moved(self, move: Move) -> "MovedNoise":
        """Return the noise after one more move."""
        return MovedNoise(seed=self.seed, moves=(*self.moves, move))

    def stream(self, name: str) -> np.random.Generator:
        """Return a fresh generator of what belongs to `name`, independent of other names'."""
        seeds, weights = [self.seed], [1.0]
        for move in self.moves:
            weights = [weight * math.cos(move.angle_rad) for weight in weights] + [math.sin(move.angle_rad)]
            seeds.append(move.seed)
        generators = [_generator(seed, name) for seed in seeds]
        return MovedStream(generators, weights)


def _generator(seed: int, name: str) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(zlib.crc32(name.encode()),)))


class MovedStream(np.random.Generator):
    """A generator whose normal and uniform numbers are made of the sum of several generators' normal ones.

    Other distributions are drawn from the first generator alone: right in themselves, and the same after every move.

    Args:
        generators: at least one, independent of each other.
        weights: of each, whose squares sum up to 1.
    """

    def __init__(self, generators: list[np.random.Generator], weights: list[float]) -> None:
        super().__init__(generators[0].bit_generator.jumped())  # type: ignore[attr-defined] # PCG64 has it
        self._parts = list(zip(weights, generators, strict=True))
        self._values: NDArray[np.float64] = np.empty(0)
        self._used = 0
        self._block = _BLOCK_FIRST

    def standard_normal(self, size: Any = None, dtype: Any = np.float64, out: Any = None) -> Any:
        """Return normal numbers; `dtype` and `out` are as they are."""
        _check_plain(dtype, out)
        return self._shaped(size, uniform=False)

    def normal(self, loc: Any = 0.0, scale: Any = 1.0, size: Any = None) -> Any:
        """Return normal numbers of a mean and a standard deviation."""
        return loc + scale * self._shaped(size, uniform=False)

    def random(self, size: Any = None, dtype: Any = np.float64, out: Any = None) -> Any:
        """Return uniform numbers from 0 to below 1; `dtype` and `out` are as they are."""
        _check_plain(dtype, out)
        return self._shaped(size, uniform=True)

    def uniform(self, low: Any = 0.0, high: Any = 1.0, size: Any = None) -> Any:
        """Return uniform numbers from `low` to below `high`."""
        return low + (high - low) * self._shaped(size, uniform=True)

    def _shaped(self, size: Any, *, uniform: bool) -> Any:
        one_length = isinstance(size, int)  # by far the most calls
        values = self._take(size if one_length else math.prod(np.atleast_1d(1 if size is None else size)))
        if uniform:
            values = np.minimum(ndtr(values), _BELOW_ONE)
        if one_length:
            return values
        return float(values[0]) if size is None else values.reshape(size)

    def _take(self, count: int) -> NDArray[np.float64]:
        """Return the next `count` normal numbers, the same ones however they are divided among calls."""
        if self._used + count > len(self._values):
            missing = self._used + count - len(self._values)
            size = max(missing, self._block)
            self._block = min(2 * self._block, _BLOCK_MAX)
            fresh = sum((weight * generator.standard_normal(size) for weight, generator in self._parts), np.zeros(size))
            self._values, self._used = np.concatenate([self._values[self._used :], fresh]), 0
        taken = self._values[self._used : self._used + count]
        self._used += count
        return taken


def _check_plain(dtype: Any, out: Any) -> None:
    if dtype is not np.float64 or out is not None:
        raise ValueError(f"a moved stream gives new arrays of float64, not of {dtype} into {out}")
