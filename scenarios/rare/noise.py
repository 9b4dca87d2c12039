"""The noise of a run as a point that can be moved a little, without changing how it is distributed.

All that is random in a run is a function of a vector z of independent standard normal numbers: each named generator
draws its own part of it, and a uniform number is the normal distribution's value at one of them. Two kinds of changes
leave that distribution as it is, whatever the length of z:

- a move of the whole, z' = z cos(a) + x sin(a), with x standard normal, for every angle a (preconditioned
  Crank-Nicolson; S. L. Cotter et al., Statist. Sci. 28 (2013) 424; in subset simulation I. Papaioannou et al., Probab.
  Eng. Mech. 41 (2015) 89)
- new numbers for all that is drawn from an instant of the run on: up to there the run is the same one

Nothing needs to know the length: a point is the seed of its first z and what has changed it since. The instant of a
redrawing is kept as how many numbers each generator had drawn by then, for in a run that is then moved as a whole
things happen at other times.
"""

import math
import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from sim_autopilot.core.noise import named_seed

_BLOCK_FIRST, _BLOCK_MAX = 16, 4096  # values made at once: many parts draw a single number, others all the time
_WHOLE_RAD = 0.5 * math.pi
_BELOW_ONE = float(np.nextafter(1.0, 0.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """A move by `angle_rad`, 0 to pi / 2, towards the noise of `seed`; pi / 2 leaves nothing of what was before."""

    seed: int
    angle_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Redraw:
    """New numbers, of the noise of `seed`, for all but the first ones: how many those are, by the generator's name."""

    seed: int
    kept: tuple[tuple[str, int], ...]

    def kept_of(self, name: str) -> int:
        """Return how many numbers of a generator stay; of one that had drawn nothing, none does."""
        return dict(self.kept).get(name, 0)


@dataclass(frozen=True, slots=True, kw_only=True)
class MovedNoise:
    """All random numbers of a run: the noise of `seed` after some changes. It is small, and can be sent and kept."""

    seed: int
    changes: tuple[Move | Redraw, ...] = ()

    def __str__(self) -> str:
        return f"{self.seed}-{zlib.crc32(repr(self.changes).encode()):08x}"

    def changed(self, change: Move | Redraw) -> "MovedNoise":
        """Return the noise after one more change."""
        return MovedNoise(seed=self.seed, changes=(*self.changes, change))

    def stream(self, name: str) -> "MovedStream":
        """Return a fresh generator of what belongs to `name`, independent of other names'."""
        parts = [_Part(generator=_generator(change.seed, name), **_reach(change, name)) for change in self.changes]
        return MovedStream(_generator(self.seed, name), parts)


class NoiseInFlight:
    """The noise of one run that is flown now, of which what is drawn from an instant on may be redrawn.

    Args:
        noise: to fly with.
        redraw_seed: of the new numbers, None where none are wanted.
        from_s: the instant, in seconds since the run began.

    Attributes:
        now_s: returns the time since the run began; to be set once the run can tell it.
    """

    def __init__(self, noise: MovedNoise, *, redraw_seed: int | None = None, from_s: float = 0.0) -> None:
        self.now_s: Callable[[], float] = lambda: 0.0
        self._noise = noise
        self._redraw_seed = redraw_seed
        self._from_s = from_s
        self._streams: dict[str, MovedStream] = {}

    def __str__(self) -> str:
        return str(self._noise)

    def stream(self, name: str) -> "MovedStream":
        """Return a generator of what belongs to `name`; one that was asked for before is restarted."""
        stream = self._noise.stream(name)
        if self._redraw_seed is not None:
            stream.redraw_once(lambda: self.now_s() >= self._from_s, _generator(self._redraw_seed, name))
        self._streams[name] = stream
        return stream

    def flown(self) -> MovedNoise:
        """Return the noise that the run had, redrawing included, once the run is over."""
        if self._redraw_seed is None:
            return self._noise
        kept = tuple((name, stream.kept) for name, stream in self._streams.items())
        return self._noise.changed(Redraw(seed=self._redraw_seed, kept=kept))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Part:
    """What a change adds to one generator's numbers from the one with the index `kept` on."""

    generator: np.random.Generator
    angle_rad: float
    kept: int


def _reach(change: Move | Redraw, name: str) -> Any:
    if isinstance(change, Move):
        return {"angle_rad": change.angle_rad, "kept": 0}
    return {"angle_rad": _WHOLE_RAD, "kept": change.kept_of(name)}


def _generator(seed: int, name: str) -> np.random.Generator:
    return np.random.default_rng(named_seed(seed, name))


class MovedStream(np.random.Generator):
    """A generator whose normal and uniform numbers are mixed from several generators' normal ones.

    Other distributions are drawn from the first generator's bits: right in themselves, and the same after every change.

    Args:
        first: of the numbers before any change.
        parts: the changes, in their order.
    """

    def __init__(self, first: np.random.Generator, parts: Sequence[_Part]) -> None:
        super().__init__(first.bit_generator.jumped())  # type: ignore[attr-defined] # PCG64 has it
        self._first = first
        self._parts = list(parts)
        self._values: NDArray[np.float64] = np.empty(0)
        self._made = 0
        self._used = 0
        self._block = _BLOCK_FIRST
        self._is_due: Callable[[], bool] | None = None
        self._redrawn: np.random.Generator | None = None
        self._kept: int | None = None

    def redraw_once(self, is_due: Callable[[], bool], generator: np.random.Generator) -> None:
        """Take all numbers from `generator` as soon as one is drawn when `is_due`."""
        self._is_due, self._redrawn = is_due, generator

    @property
    def kept(self) -> int:
        """How many numbers have been drawn before that."""
        return self._drawn if self._kept is None else self._kept

    @property
    def _drawn(self) -> int:
        return self._made - (len(self._values) - self._used)

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
        values = self._take(size if one_length else int(np.prod(1 if size is None else size)))
        if uniform:
            values = np.minimum(ndtr(values), _BELOW_ONE)
        if one_length:
            return values
        return float(values[0]) if size is None else values.reshape(size)

    def _take(self, count: int) -> NDArray[np.float64]:
        """Return the next `count` normal numbers, the same ones however they are divided among calls."""
        if self._is_due is not None and self._redrawn is not None and self._is_due():
            self._begin_redrawing(self._redrawn)
        missing = self._used + count - len(self._values)
        if missing > 0:
            fresh = self._next_block(max(missing, self._block))
            self._block = min(2 * self._block, _BLOCK_MAX)
            self._values, self._used = np.concatenate([self._values[self._used :], fresh]), 0
        taken = self._values[self._used : self._used + count]
        self._used += count
        return taken

    def _begin_redrawing(self, generator: np.random.Generator) -> None:
        """Drop what was made ahead: from here on nothing of the other generators' numbers is left."""
        self._kept = self._made = self._drawn
        self._parts = [_Part(generator=generator, angle_rad=_WHOLE_RAD, kept=self._kept)]
        self._values, self._used, self._is_due = np.empty(0), 0, None

    def _next_block(self, size: int) -> NDArray[np.float64]:
        values = self._first.standard_normal(size)
        for part in self._parts:
            begin = max(0, part.kept - self._made)
            if begin < size:
                fresh = part.generator.standard_normal(size - begin)
                whole = part.angle_rad >= _WHOLE_RAD  # exactly nothing is left then; a cosine would leave 6e-17
                before = 0.0 if whole else math.cos(part.angle_rad) * values[begin:]
                values[begin:] = before + math.sin(part.angle_rad) * fresh
        self._made += size
        return values


def _check_plain(dtype: Any, out: Any) -> None:
    if dtype is not np.float64 or out is not None:
        raise ValueError(f"a moved stream gives new arrays of float64, not of {dtype} into {out}")
