"""The one interface of all estimators of the ground vehicle.

An estimator is a pair of pure functions over its own immutable memory. Measurements are fused at the time
they were taken, whatever order they arrive in; the present and the future are predictions from there.
"""

from collections.abc import Sequence
from typing import NewType, Protocol

from companion.core.data import Array, Forecast, Measurement, VehicleEstimate
from companion.vehicle.buffered import BufferHealth

EstimatorMemory = NewType("EstimatorMemory", object)
"""What an estimator remembers; only that estimator reads it."""


class Estimator(Protocol):
    """What the companion asks of an estimator; the memory is None until the first fix."""

    def fuse(self, memory: EstimatorMemory | None, measurements: Sequence[Measurement]) -> EstimatorMemory | None:
        """Return the memory after `measurements`; late ones are fused at their own time, outliers are gated."""

    def estimate(self, memory: EstimatorMemory | None, t_ns: int) -> VehicleEstimate | None:
        """Return the vehicle at `t_ns`, or None before the first fix and long after the last."""

    def forecast(self, memory: EstimatorMemory | None, t_ns: int, offset_s: Array) -> Forecast | None:
        """Return the vehicle at `t_ns + offset_s`, `offset_s` (n,), or None as `estimate` does."""

    def newest_fix_ns(self, memory: EstimatorMemory | None) -> int | None:
        """Return the time at which the newest accepted position was taken."""

    def health(self, memory: EstimatorMemory | None) -> BufferHealth:
        """Return the counters and the consistency of the memory."""
