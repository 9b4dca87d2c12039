"""The one interface of all estimators of the ground vehicle, and any filter model as one of them.

An estimator is a pair of pure functions over its own immutable memory. Measurements are fused at the time they were
taken, whatever order they arrive in: a delay buffer is in front, predictions are behind.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, NewType, Protocol, TypeVar

from companion.config.estimation import BufferConfig
from companion.core.data import Array, Forecast, Measurement, Quantity, VehicleEstimate
from companion.vehicle.delay_buffer import DelayBuffer, fuse
from companion.vehicle.filter_step import QUANTITIES, FilterModel, Tally, is_forgotten

S = TypeVar("S")


@dataclass(frozen=True, slots=True, kw_only=True)
class BufferHealth:
    """What became of the measurements, and whether they agree with the filter.

    Attributes:
        fused: accepted.
        gated: rejected as outliers.
        late: dropped, older than the buffer.
        recoveries: times the filter was opened to data it had rejected for too long.
        nis_per_dof: mean over the whole run, 1 for a consistent filter; None before the second measurement.
        nis_dof: degrees of freedom that it is the mean of.
        recent_nis_per_dof: the same over what the buffer holds, rejected data included.
    """

    fused: int
    gated: int
    late: int
    recoveries: int
    nis_per_dof: float | None
    nis_dof: int
    recent_nis_per_dof: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class BufferedEstimator(Generic[S]):
    """`companion.vehicle.buffered.Estimator` over a `FilterModel`; holds configuration only."""

    model: FilterModel[S]
    config: BufferConfig

    def fuse(self, memory: DelayBuffer[S] | None, measurements: Sequence[Measurement]) -> DelayBuffer[S] | None:
        """Return the memory after `measurements`; late ones are fused at their own time, outliers are gated."""
        return fuse(self.model, self.config, memory, measurements)

    def estimate(self, memory: DelayBuffer[S] | None, t_ns: int) -> VehicleEstimate | None:
        """Return the vehicle at `t_ns`, or None before the first fix and long after the last."""
        state = self._state_at(memory, t_ns)
        return None if state is None else self.model.describe(state, t_ns)

    def forecast(self, memory: DelayBuffer[S] | None, t_ns: int, offset_s: Array) -> Forecast | None:
        """Return the vehicle at `t_ns + offset_s`, `offset_s` (n,) not falling, or None as `estimate` does."""
        state = self._state_at(memory, t_ns)
        return None if state is None else self.model.forecast(state, t_ns, offset_s)

    def newest_fix_ns(self, memory: DelayBuffer[S] | None) -> int | None:
        """Return the time at which the newest accepted position was taken."""
        return self.newest_ns(memory, Quantity.POSITION)

    def newest_ns(self, memory: DelayBuffer[S] | None, quantity: Quantity) -> int | None:
        """Return the time at which the newest accepted `quantity` was taken."""
        return None if memory is None else memory.newest.tally.accepted_ns[QUANTITIES.index(quantity)]

    def health(self, memory: DelayBuffer[S] | None) -> BufferHealth:
        """Return the counters and the consistency of the memory."""
        tally = Tally() if memory is None else memory.newest.tally
        recent = [] if memory is None else [e.nis_per_dof for e in memory.entries if e.nis_per_dof is not None]
        return BufferHealth(
            fused=tally.fused,
            gated=tally.gated,
            late=0 if memory is None else memory.late,
            recoveries=tally.recoveries,
            nis_per_dof=tally.nis_sum / tally.nis_dof if tally.nis_dof else None,
            nis_dof=tally.nis_dof,
            recent_nis_per_dof=sum(recent) / len(recent) if recent else None,
        )

    def _state_at(self, memory: DelayBuffer[S] | None, t_ns: int) -> S | None:
        if memory is None:
            return None
        snapshot = memory.before(t_ns)
        if snapshot.state is None or t_ns <= snapshot.t_ns:
            return snapshot.state
        if is_forgotten(self.config, snapshot, t_ns):
            return None
        return self.model.predict(snapshot.state, (t_ns - snapshot.t_ns) * 1e-9)


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
