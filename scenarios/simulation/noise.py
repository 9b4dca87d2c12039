"""Noise, loss and delay of the sensor models, each a small object that owns its own seeded generator."""

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from link.messages import Vector3
from scenarios.config import ChannelConfig, DelayConfig, Scenario
from sim_autopilot.core.noise import NoiseSeed, named_seed


class NoiseSource(Protocol):
    """All random numbers of a run, where no single number decides them."""

    def stream(self, name: str) -> np.random.Generator:
        """Return a fresh generator of what belongs to `name`, independent of other names'."""


Seed = int | NoiseSource
"""What decides everything random in a run."""


def named_rng(seed: Seed, name: str) -> np.random.Generator:
    """Return the generator of `seed` that belongs to `name`; other names' generators are independent of it."""
    if not isinstance(seed, int):
        return seed.stream(name)
    return np.random.default_rng(named_seed(seed, name))


def part_seed(seed: Seed, name: str) -> NoiseSeed:
    """Return of what a part of the simulated autopilot makes its generator: the seed or the noise of its name."""
    return named_seed(seed, name) if isinstance(seed, int) else seed.stream(name)


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


class SensorSchedule:
    """When a sensor takes samples, which are lost, and when the others leave it.

    It draws from a generator of its own, seeded by the sensor's name.
    """

    def __init__(self, config: DelayConfig, seed: Seed, name: str) -> None:
        self._config = config
        self._rng = named_rng(seed, f"{name} link")
        self._period_ns = round(1e9 / config.rate_hz)
        self._due_ns: int | None = None
        self._taken_ns: int | None = None

    def due(self, t_ns: int) -> bool:
        """Return whether a sample is to be taken now."""
        return self._due_ns is None or t_ns >= self._due_ns

    def take(self, t_ns: int) -> float:
        """Plan the next sample and return the seconds since the one before."""
        if self._due_ns is None or t_ns - self._due_ns > self._period_ns:
            self._due_ns = t_ns
        self._due_ns += self._period_ns
        elapsed_s = 0.0 if self._taken_ns is None else (t_ns - self._taken_ns) * 1e-9
        self._taken_ns = t_ns
        return elapsed_s

    def release_ns(self, t_ns: int) -> int | None:
        """Return when a sample taken at `t_ns` leaves, None if it is lost."""
        loss, shift = map(float, self._rng.random(2))
        if loss < self._config.loss:
            return None
        delay_s = self._config.delay_s + (2.0 * shift - 1.0) * self._config.jitter_s
        return t_ns + round(max(0.0, delay_s) * 1e9)


Span = tuple[int, int]


def instant_s(scenario: Scenario, seed: Seed, name: str, at_s: float | None) -> float:
    """Return when the disturbance `name` begins, in seconds since the start of the simulation; `at_s` None draws it."""
    return (
        at_s
        if at_s is not None
        else float(named_rng(seed, f"{name} instant").uniform(*scenario.run.disturbed_between_s))
    )


def outages_ns(channel: ChannelConfig, scenario: Scenario, seed: Seed, name: str, start_ns: int) -> list[Span]:
    """Return the outages of the link `name`, from start to end in UTC: one, or none where it never fails.

    Args:
        channel: of the link.
        scenario: says when.
        seed: draws instant and length.
        name: of the link.
        start_ns: UTC at the start of the simulation.
    """
    shortest_s, longest_s = channel.outage_range_s
    if longest_s == 0.0:
        return []
    begin_ns = start_ns + round(instant_s(scenario, seed, f"{name} outage", channel.outage_at_s) * 1e9)
    length_s = float(named_rng(seed, f"{name} outage").uniform(shortest_s, longest_s))
    return [(begin_ns, begin_ns + round(length_s * 1e9))]
