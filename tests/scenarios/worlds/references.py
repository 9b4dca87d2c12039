"""The distributions of the domain as scipy has them: an outside authority for our quantile functions."""

import math
from typing import Any

import numpy as np
from scipy import stats

from scenarios.worlds.distributions import (
    Beta,
    Exponential,
    LogNormal,
    LogUniform,
    Normal,
    Uniform,
    Weibull,
)

Bounded = Uniform | LogUniform | Normal | LogNormal | Beta | Exponential | Weibull
"""Every distribution of a number by itself."""

LEVELS = (1e-9, 0.013, 0.21, 0.5, 0.68, 0.97, 1.0 - 1e-9)
PLAIN: tuple[Bounded, ...] = (
    Uniform(kind="uniform", low=-3.0, high=0.7),
    LogUniform(kind="log_uniform", low=0.02, high=7.0),
    Normal(kind="normal", mean=1.0, std=2.0, low=-0.5, high=6.0),
    LogNormal(kind="lognormal", median=3.0, spread=0.7, low=0.4, high=9.0),
    Beta(kind="beta", a=2.0, b=0.8, low=-1.0, high=4.0),
    Exponential(kind="exponential", scale=3.0, low=0.5, high=8.0),
    Weibull(kind="weibull", scale=4.5, shape=2.0, low=0.3, high=12.0),
)


def reference_of(plain: object) -> Any:  # noqa: PLR0911 (one case for each distribution)
    """Return scipy's frozen distribution."""
    match plain:
        case Uniform(low=low, high=high):
            return stats.uniform(low, high - low)
        case LogUniform(low=low, high=high):
            return stats.loguniform(low, high)
        case Normal(mean=mean, std=std, low=low, high=high):
            return stats.truncnorm((low - mean) / std, (high - mean) / std, mean, std)
        case LogNormal(median=median, spread=spread, low=low, high=high):
            ends = (math.log(low / median) / spread, math.log(high / median) / spread)
            return _Transformed(stats.truncnorm(*ends, math.log(median), spread), math.log)
        case Beta(a=a, b=b, low=low, high=high):
            return stats.beta(a, b, low, high - low)
        case Exponential(scale=scale, low=low, high=high):
            return stats.truncexpon((high - low) / scale, low, scale)
        case Weibull(scale=scale, shape=shape, low=low, high=high):
            return _Truncated(stats.weibull_min(shape, scale=scale), low, high)
    raise TypeError(f"no reference for {plain}")


class _Truncated:
    """A distribution between two bounds; `stats.truncate` has the same and takes 0.1 s a call."""

    def __init__(self, of: Any, low: float, high: float) -> None:
        self._of = of
        self._ends = of.cdf([low, high])

    def cdf(self, values: Any) -> Any:
        low, high = self._ends
        return (self._of.cdf(values) - low) / (high - low)


class _Transformed:
    """A distribution of a function of the value."""

    def __init__(self, of: Any, function: Any) -> None:
        self._of = of
        self._function = function

    def cdf(self, values: Any) -> Any:
        return self._of.cdf(np.vectorize(self._function)(values))
