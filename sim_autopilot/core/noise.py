"""Independent streams of random numbers from one seed, each by the name of what draws from it."""

import zlib
from typing import TypeAlias

import numpy as np

NoiseSeed: TypeAlias = int | np.random.SeedSequence | np.random.Generator
"""What a part makes its generator of, or that generator."""


def named_seed(seed: int, name: str) -> np.random.SeedSequence:
    """Return the seed of what belongs to `name`; other names' numbers are independent of its own."""
    return np.random.SeedSequence(seed, spawn_key=(zlib.crc32(name.encode()),))
