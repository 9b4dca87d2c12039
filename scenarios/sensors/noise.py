"""Random processes of the sensor models, each a small object that owns its own seeded generator."""

import math
import zlib
from dataclasses import dataclass

import numpy as np

from link.messages import Vector3


def named_rng(seed: int, name: str) -> np.random.Generator:
    """Return the generator of `seed` that belongs to `name`; other names' generators are independent of it."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(zlib.crc32(name.encode()),)))


def normal3(rng: np.random.Generator, std: float) -> Vector3:
    """Return three independent normal values of standard deviation `std`."""
    x, y, z = rng.standard_normal(3).tolist()
    return std * x, std * y, std * z


class GaussMarkov:
    """A first-order Gauss-Markov process on each of three axes, stationary from its first value on."""

    def __init__(self, rng: np.random.Generator, *, std: float, tau_s: float) -> None:
        self._rng = rng
        self._std = std
        self._tau_s = tau_s
        self._value = normal3(rng, std)

    def step(self, elapsed_s: float) -> Vector3:
        """Return the value `elapsed_s` after the one before, exact for any step."""
        if self._std == 0.0:
            return self._value
        decay = math.exp(-elapsed_s / self._tau_s)
        x, y, z = self._value
        dx, dy, dz = normal3(self._rng, self._std * math.sqrt(1.0 - decay * decay))
        self._value = (decay * x + dx, decay * y + dy, decay * z + dz)
        return self._value


class Dropouts:
    """A two-state Markov chain that is off for `share` of the time, in dropouts of `mean_s` on average."""

    def __init__(self, rng: np.random.Generator, *, share: float, mean_s: float) -> None:
        self._rng = rng
        self._to_on_hz = 1.0 / mean_s
        self._to_off_hz = share / (1.0 - share) / mean_s if share < 1.0 else math.inf
        self._off = bool(rng.random() < share)

    def step(self, elapsed_s: float) -> bool:
        """Return whether it is off `elapsed_s` after the step before."""
        rate_hz = self._to_on_hz if self._off else self._to_off_hz
        if self._rng.random() < -math.expm1(-rate_hz * elapsed_s):
            self._off = not self._off
        return self._off


@dataclass(frozen=True, slots=True, kw_only=True)
class StampClock:
    """A clock that was `offset_s` fast at `start_ns` and gains `drift` seconds in a second."""

    start_ns: int
    offset_s: float
    drift: float

    def stamp_ns(self, t_ns: int) -> int:
        """Return what this clock shows at the true instant `t_ns`."""
        return t_ns + round(self.offset_s * 1e9 + self.drift * (t_ns - self.start_ns))
