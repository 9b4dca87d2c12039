"""The one interface of all estimators of the ground vehicle, and any filter model as one of them behind a delay buffer.

An estimator is a pair of pure functions over its own immutable memory. Measurements are fused at the time they were
taken, whatever order they arrive in: the buffer keeps those of the last second or two, each with the filter's state
after it. A late one is put in its place and everything after it is run again. The order of arrival therefore leaves no
trace; a measurement older than the buffer is dropped and counted.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator, Sequence
from operator import itemgetter
from typing import Generic, NewType, Protocol, TypeVar

from msgspec import Struct

from companion.config.estimation import BufferConfig
from companion.core.data import Array, Forecast, Measurement, Quantity, VehicleEstimate
from companion.vehicle.filter_step import QUANTITIES, RANK, FilterModel, Snapshot, Tally, is_forgotten, step
from link.records import replace

S = TypeVar("S")

START_REACH_NS = 1_000_000_000

Place = tuple[int, int, tuple[float, ...]]
"""Of a measurement in the order of fusion: by time, then by quantity, then by value."""

_PLACE = itemgetter(0)


class Entry(Struct, Generic[S], frozen=True, kw_only=True, eq=False):
    """A measurement and its place, and the filter after it."""

    measurement: Measurement
    place: Place
    after: Snapshot[S]


class DelayBuffer(Struct, Generic[S], frozen=True, kw_only=True, eq=False):
    """The filter before the oldest kept measurement, and the kept ones in order of time.

    Attributes:
        base: the filter before the oldest kept one.
        entries: those that are kept.
        late: how many came too late.
        late_in_a_row: how many places did since anything came in time.
    """

    base: Snapshot[S]
    entries: tuple[Entry[S], ...]
    late: int
    late_in_a_row: int

    @property
    def newest(self) -> Snapshot[S]:
        """The filter after everything it knows."""
        return self.entries[-1].after if self.entries else self.base

    def before(self, t_ns: int) -> Snapshot[S]:
        """The filter after everything taken at or before `t_ns`, as far back as the buffer reaches."""
        count = bisect_right(self.entries, t_ns, key=_time)
        return self.entries[count - 1].after if count else self.base


def fuse(
    model: FilterModel[S], config: BufferConfig, buffer: DelayBuffer[S] | None, measurements: Sequence[Measurement]
) -> DelayBuffer[S] | None:
    """Return the buffer with `measurements` in their places and the filter run again from the earliest of them.

    Args:
        model: the filter.
        config: how much is kept and what is gated.
        buffer: None before the first measurement.
        measurements: in any order.
    """
    if not measurements:
        return buffer
    if buffer is None:
        buffer = _empty(min(measurement.t_ns for measurement in measurements))
    placed = [(_place(one), one) for one in measurements if one.t_ns >= buffer.base.t_ns]
    late = len(measurements) - len(placed)
    if not placed:
        return _all_late(model, config, buffer, measurements)
    first = bisect_left(buffer.entries, min(placed, key=_PLACE)[0], key=_entry_place)
    later = [(entry.place, entry.measurement) for entry in buffer.entries[first:]]
    again = sorted([*placed, *later], key=_PLACE)
    kept = buffer.entries[:first]
    entries = kept + tuple(_run(model, config, kept[-1].after if kept else buffer.base, again))
    return _prune(
        DelayBuffer(base=buffer.base, entries=entries, late=buffer.late + late, late_in_a_row=0), config.keep_s
    )


def _empty(t_ns: int) -> DelayBuffer[S]:
    """A buffer that has seen nothing; it reaches back a second, for what is already on its way."""
    base: Snapshot[S] = Snapshot(t_ns=t_ns - START_REACH_NS, told_ns=t_ns, state=None, tally=Tally())
    return DelayBuffer(base=base, entries=(), late=0, late_in_a_row=0)


def _all_late(
    model: FilterModel[S], config: BufferConfig, buffer: DelayBuffer[S], measurements: Sequence[Measurement]
) -> DelayBuffer[S] | None:
    """Drop and count; where all comes late, places too, and for long, an earlier stamp lay in the future.

    A sensor whose stamps alone are old, such as an IMU at 100 Hz between fixes, says nothing of the others.
    """
    in_a_row = buffer.late_in_a_row + sum(one.quantity is model.placed_by for one in measurements)
    late = buffer.late + len(measurements)
    if in_a_row <= config.late_in_a_row_max:
        return replace(buffer, late=late, late_in_a_row=in_a_row)
    started = fuse(model, config, None, measurements)
    return None if started is None else replace(started, late=late)


def _run(
    model: FilterModel[S], config: BufferConfig, snapshot: Snapshot[S], placed: Iterable[tuple[Place, Measurement]]
) -> Iterator[Entry[S]]:
    for place, measurement in placed:
        snapshot = step(model, config, snapshot, measurement)
        yield Entry(measurement=measurement, place=place, after=snapshot)


def _prune(buffer: DelayBuffer[S], keep_s: float) -> DelayBuffer[S]:
    """Fold what is older than `keep_s` into the base."""
    oldest_ns = buffer.newest.t_ns - round(keep_s * 1e9)
    count = bisect_left(buffer.entries, oldest_ns, key=_time)
    if not count:
        return buffer
    return replace(buffer, base=buffer.entries[count - 1].after, entries=buffer.entries[count:])


def _place(measurement: Measurement) -> Place:
    """A total order, so that equal stamps leave no trace of the order of arrival either."""
    return measurement.t_ns, RANK[measurement.quantity], tuple(measurement.value.tolist())


def _entry_place(entry: Entry[S]) -> Place:
    return entry.place


def _time(entry: Entry[S]) -> int:
    return entry.measurement.t_ns


class BufferHealth(Struct, frozen=True, kw_only=True):
    """What became of the measurements, and whether they agree with the filter.

    Attributes:
        accepted: of each of `QUANTITIES`.
        rejected: of each of `QUANTITIES`, as outliers; those that the filter was opened to among them.
        late: dropped, older than the buffer.
        recoveries: times the filter was opened to data it had rejected for too long.
        nis_per_dof: mean over the whole run, 1 for a consistent filter; None before the second measurement.
        nis_dof: degrees of freedom that it is the mean of.
        moves_to_sightings: times the pad was moved to where sightings had it that were rejected for too long.
        place_step: times fixes that went on moved the vehicle where it was not expected, and how far the last did, m.
    """

    accepted: tuple[int, ...]
    rejected: tuple[int, ...]
    late: int
    recoveries: int
    nis_per_dof: float | None
    nis_dof: int
    moves_to_sightings: int = 0
    place_step: tuple[int, float] = (0, 0.0)

    def counts(self, quantity: Quantity) -> tuple[int, int]:
        """Return how many of `quantity` were accepted and rejected."""
        rank = RANK[quantity]
        return self.accepted[rank], self.rejected[rank]


class BufferedEstimator(Struct, Generic[S], frozen=True, kw_only=True):
    """`Estimator` over a `FilterModel`; holds configuration only."""

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
        """Return the time at which the newest accepted place was taken."""
        return self.newest_ns(memory, self.model.placed_by)

    def newest_ns(self, memory: DelayBuffer[S] | None, quantity: Quantity) -> int | None:
        """Return the time at which the newest accepted `quantity` was taken."""
        return None if memory is None else memory.newest.tally.accepted_ns[QUANTITIES.index(quantity)]

    def health(self, memory: DelayBuffer[S] | None) -> BufferHealth:
        """Return the counters and the consistency of the memory."""
        tally = Tally() if memory is None else memory.newest.tally
        return BufferHealth(
            accepted=tally.accepted,
            rejected=tally.rejected,
            late=0 if memory is None else memory.late,
            recoveries=tally.recoveries,
            nis_per_dof=tally.nis_sum / tally.nis_dof if tally.nis_dof else None,
            nis_dof=tally.nis_dof,
            moves_to_sightings=tally.moves_to_sightings,
            place_step=tally.place_step,
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
        """Return the time at which the newest accepted place was taken: a fix, or a sighting of a silent vehicle."""

    def health(self, memory: EstimatorMemory | None) -> BufferHealth:
        """Return the counters and the consistency of the memory."""
