"""The distributions that a quantity may have, each by its quantile function.

A world draws one uniform number u in (0, 1) for each quantity, and the quantity is its quantile at u. So a search can
choose u in place of chance, and a change of one distribution moves no other quantity. The quantile functions are
scipy's special functions, a normal and a lognormal one being cut off at their bounds: u runs between the bounds'
probabilities.
"""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from link.program.toml_config import Positive, StrictModel

Value = float | str | bool


class _Bounded(StrictModel):
    """A distribution between bounds."""

    low: float
    high: float

    @model_validator(mode="after")
    def _bounds_ascend(self) -> Self:
        if self.low >= self.high:
            raise ValueError(f"low, {self.low:g}, must be below high, {self.high:g}")
        return self


class Uniform(_Bounded):
    """Evenly from `low` to `high`."""

    kind: Literal["uniform"]

    def quantile(self, u: float) -> float:
        """Return the value below which the share `u` of the values lies."""
        return self.low + u * (self.high - self.low)


class LogUniform(_Bounded):
    """A value whose logarithm is even: each decade is as likely as another."""

    kind: Literal["log_uniform"]
    low: Positive

    def quantile(self, u: float) -> float:
        """Return the value below which the share `u` of the values lies."""
        return float(self.low * (self.high / self.low) ** u)


class Normal(_Bounded):
    """A normal distribution of which only the part between the bounds is left."""

    kind: Literal["normal"]
    mean: float
    std: Positive

    def quantile(self, u: float) -> float:
        """Return the value below which the share `u` of the values lies."""
        z = _normal_between(u, (self.low - self.mean) / self.std, (self.high - self.mean) / self.std)
        return min(self.high, max(self.low, self.mean + self.std * z))


class LogNormal(_Bounded):
    """A value whose logarithm is normal: `spread` is its standard deviation, 0.1 about a tenth of the value."""

    kind: Literal["lognormal"]
    median: Positive
    spread: Positive
    low: Positive

    def quantile(self, u: float) -> float:
        """Return the value below which the share `u` of the values lies."""
        z = _normal_between(
            u, math.log(self.low / self.median) / self.spread, math.log(self.high / self.median) / self.spread
        )
        return min(self.high, max(self.low, self.median * math.exp(self.spread * z)))


class Beta(_Bounded):
    """A beta distribution stretched from `low` to `high`."""

    kind: Literal["beta"]
    a: Positive
    b: Positive

    def quantile(self, u: float) -> float:
        """Return the value below which the share `u` of the values lies."""
        from scipy import special  # noqa: PLC0415 (0.2 s, and only who draws a world needs it)

        return self.low + (self.high - self.low) * float(special.betaincinv(self.a, self.b, u))


class Exponential(_Bounded):
    """Waiting times of events at a constant rate, 1 / `scale`, from `low` on; only those below `high` are left."""

    kind: Literal["exponential"]
    scale: Positive
    low: float = 0.0

    def quantile(self, u: float) -> float:
        """Return the value below which the share `u` of the values lies."""
        kept = -math.expm1(-(self.high - self.low) / self.scale)
        return min(self.high, self.low - self.scale * math.log1p(-u * kept))


class Weibull(_Bounded):
    """A Weibull distribution, by which wind speeds are described, of which only the part between the bounds is left."""

    kind: Literal["weibull"]
    scale: Positive
    shape: Positive
    low: Annotated[float, Field(ge=0.0)] = 0.0

    def quantile(self, u: float) -> float:
        """Return the value below which the share `u` of the values lies."""
        below, above = (-math.expm1(-((bound / self.scale) ** self.shape)) for bound in (self.low, self.high))
        value = float(self.scale * (-math.log1p(-(below + u * (above - below)))) ** (1.0 / self.shape))
        return min(self.high, max(self.low, value))


class Choice(StrictModel):
    """One of some values, each with its weight."""

    kind: Literal["choice"]
    values: Annotated[tuple[Value, ...], Field(min_length=1)]
    weights: tuple[Positive, ...]

    @model_validator(mode="after")
    def _weights_fit(self) -> Self:
        if len(self.weights) != len(self.values):
            raise ValueError(f"{len(self.values)} values need as many weights, not {len(self.weights)}")
        return self

    def quantile(self, u: float) -> Value:
        """Return the first value at which the weights so far exceed the share `u` of all."""
        so_far, share = 0.0, u * math.fsum(self.weights)
        for value, weight in zip(self.values, self.weights, strict=True):
            so_far += weight
            if share < so_far:
                return value
        return self.values[-1]

    def shares(self, value: Value) -> tuple[float, float]:
        """Return the shares between which `value` is the quantile.

        Raises:
            ValueError: it is none of the values.
        """
        place, total = self.values.index(value), math.fsum(self.weights)
        return math.fsum(self.weights[:place]) / total, math.fsum(self.weights[: place + 1]) / total


class Graded(StrictModel):
    """A value that goes from `poor` to `good` with a quality from 0 to 1, evenly in its logarithm, and scatters.

    Attributes:
        quality: the name of the quality's quantity.
        poor: median at quality 0.
        good: median at quality 1.
        spread: standard deviation of the logarithm about it, cut off at two of them.
    """

    kind: Literal["graded"]
    quality: str
    poor: Positive
    good: Positive
    spread: Positive

    def quantile_at(self, quality: float, u: float) -> float:
        """Return the value below which the share `u` of the values lies at this quality."""
        z = _normal_between(u, -_CUT, _CUT)
        return float(self.poor * (self.good / self.poor) ** quality * math.exp(self.spread * z))


_CUT = 2.0
_LEAST = 2.0**-53  # as near to 1 as a number can be
Plain = Annotated[
    Uniform | LogUniform | Normal | LogNormal | Beta | Exponential | Weibull | Choice | Graded,
    Field(discriminator="kind"),
]


def share_below(distribution: Plain, value: float) -> float | None:
    """Return the share of a distribution of numbers that lies below `value`, None for one beyond its bounds.

    Raises:
        TypeError: it is a choice, or goes by a quality.
    """
    from scipy import optimize  # noqa: PLC0415 (as above)

    if isinstance(distribution, Choice | Graded):
        raise TypeError(f"a distribution of kind '{distribution.kind}' has no share below a number")
    if not distribution.quantile(_LEAST) <= value <= distribution.quantile(1.0 - _LEAST):
        return None
    return float(optimize.brentq(lambda u: distribution.quantile(u) - value, _LEAST, 1.0 - _LEAST))


def _normal_between(u: float, low: float, high: float) -> float:
    """Return the quantile at `u` of a standard normal distribution between two bounds."""
    from scipy import special  # noqa: PLC0415 (as above)

    below, above = special.ndtr(low), special.ndtr(high)
    return float(special.ndtri(below + u * (above - below)))
