"""When a sensor takes samples, which of them are lost, and when the others leave it."""

from scenarios.config import DelayConfig
from scenarios.sensors.noise import named_rng


class SensorSchedule:
    """Of one sensor; draws from a generator of its own, seeded by the sensor's name."""

    def __init__(self, config: DelayConfig, seed: int, name: str) -> None:
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
