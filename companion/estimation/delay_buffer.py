"""Fuses measurements at the time they were taken, whatever order they arrive in.

The buffer keeps the measurements of the last second or two, each with the filter's state after it. A late
measurement is put in its place and everything after it is run again. The order of arrival therefore leaves no
trace; a measurement older than the buffer is dropped and counted. Outliers are gated by their normalised
innovation squared (NIS); when one quantity is rejected for too long, the filter is told to recover on the new data.
"""

import math
from bisect import bisect_left, bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Generic, Protocol, TypeVar

from scipy.special import gammaincinv

from companion.data import Array, Forecast, Measurement, Quantity, VehicleEstimate
from companion.estimation.config import BufferConfig

S = TypeVar("S")

START_REACH_NS = 1_000_000_000

QUANTITIES = tuple(Quantity)
_RANK = {quantity: rank for rank, quantity in enumerate(QUANTITIES)}
_NEVER: tuple[int | None, ...] = (None,) * len(QUANTITIES)

Place = tuple[int, int, tuple[float, ...]]
"""Of a measurement in the order of fusion: by time, then by quantity, then by value."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Update(Generic[S]):
    """A filter's answer to a measurement: the state after it, and how well it fitted.

    Attributes:
        state: the filter with the measurement in it.
        nis: normalised innovation squared.
        gate_nis: what the gate judges; the same unless the filter weighs several models.
        dof: its degrees of freedom.
    """

    state: S
    nis: float
    gate_nis: float
    dof: int


class FilterModel(Protocol[S]):
    """A recursive filter as pure functions of its state."""

    def start(self, fix: Measurement) -> S:
        """Return the state after a first position."""

    def predict(self, state: S, dt_s: float) -> S:
        """Return the state `dt_s` later."""

    def update(self, state: S, measurement: Measurement) -> Update[S] | None:
        """Return the state after `measurement`, or None when this filter has no use for it."""

    def recover(self, state: S, measurement: Measurement) -> S:
        """Return a state open to `measurement`, after many like it were rejected."""

    def describe(self, state: S, t_ns: int) -> VehicleEstimate:
        """Return the state as the rest of the companion reads it."""

    def forecast(self, state: S, t_ns: int, offset_s: Array) -> Forecast:
        """Return the future of a state that holds at `t_ns`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Tally:
    """What happened to the measurements up to a moment; tuples run over `QUANTITIES`."""

    fused: int = 0
    gated: int = 0
    recoveries: int = 0
    nis_sum: float = 0.0
    nis_dof: int = 0
    accepted_ns: tuple[int | None, ...] = _NEVER
    rejected_since_ns: tuple[int | None, ...] = _NEVER


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Snapshot(Generic[S]):
    """The filter at `t_ns`; the state is None until the first position."""

    t_ns: int
    state: S | None
    tally: Tally


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Entry(Generic[S]):
    """A measurement and its place, the filter after it, and its NIS per degree of freedom (None when not used)."""

    measurement: Measurement
    place: Place
    after: Snapshot[S]
    nis_per_dof: float | None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DelayBuffer(Generic[S]):
    """The filter before the oldest kept measurement, the kept ones in order of time, and how many came too late."""

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
    ordered = sorted(measurements, key=_place)
    if buffer is None:
        buffer = _empty(ordered[0].t_ns)
    in_time = [measurement for measurement in ordered if measurement.t_ns >= buffer.base.t_ns]
    late = len(ordered) - len(in_time)
    if not in_time:
        return _all_late(model, config, buffer, ordered)
    first = bisect_left(buffer.entries, _place(in_time[0]), key=_entry_place)
    again = sorted([*in_time, *(entry.measurement for entry in buffer.entries[first:])], key=_place)
    kept = buffer.entries[:first]
    entries = kept + tuple(_run(model, config, kept[-1].after if kept else buffer.base, again))
    return _prune(
        DelayBuffer(base=buffer.base, entries=entries, late=buffer.late + late, late_in_a_row=0), config.keep_s
    )


def nis_threshold(gate_probability: float | None, dof: int) -> float:
    """Return the NIS above which a measurement of `dof` components is an outlier (chi-square quantile)."""
    return math.inf if gate_probability is None else _chi2_quantile(gate_probability, dof)


def _empty(t_ns: int) -> DelayBuffer[S]:
    """A buffer that has seen nothing; it reaches back a second, for what is already on its way."""
    base: Snapshot[S] = Snapshot(t_ns=t_ns - START_REACH_NS, state=None, tally=Tally())
    return DelayBuffer(base=base, entries=(), late=0, late_in_a_row=0)


def _all_late(
    model: FilterModel[S], config: BufferConfig, buffer: DelayBuffer[S], measurements: Sequence[Measurement]
) -> DelayBuffer[S] | None:
    """Drop and count; a long row of nothing but late data means that an earlier stamp lay in the future."""
    in_a_row = buffer.late_in_a_row + len(measurements)
    late = buffer.late + len(measurements)
    if in_a_row <= config.late_in_a_row_max:
        return replace(buffer, late=late, late_in_a_row=in_a_row)
    started = fuse(model, config, None, measurements)
    return None if started is None else replace(started, late=late)


def _run(
    model: FilterModel[S], config: BufferConfig, snapshot: Snapshot[S], measurements: Sequence[Measurement]
) -> Iterator[Entry[S]]:
    for measurement in measurements:
        snapshot, nis_per_dof = _step(model, config, snapshot, measurement)
        yield Entry(measurement=measurement, place=_place(measurement), after=snapshot, nis_per_dof=nis_per_dof)


def _step(
    model: FilterModel[S], config: BufferConfig, snapshot: Snapshot[S], measurement: Measurement
) -> tuple[Snapshot[S], float | None]:
    """Predict to the measurement, then fuse it, gate it, or recover on it."""
    t_ns = measurement.t_ns
    if snapshot.state is None:
        return _start(model, snapshot, measurement), None
    state = snapshot.state
    if t_ns > snapshot.t_ns:
        state = model.predict(state, (t_ns - snapshot.t_ns) * 1e-9)
    update = model.update(state, measurement)
    if update is None:
        return Snapshot(t_ns=t_ns, state=state, tally=snapshot.tally), None
    rank = _RANK[measurement.quantity]
    nis_per_dof = update.nis / update.dof
    if update.gate_nis <= nis_threshold(config.gate_probability, update.dof):
        return Snapshot(t_ns=t_ns, state=update.state, tally=_accepted(snapshot.tally, rank, t_ns, update)), nis_per_dof
    since_ns = snapshot.tally.rejected_since_ns[rank]
    if since_ns is None or t_ns - since_ns < config.recover_after_s * 1e9:
        return Snapshot(t_ns=t_ns, state=state, tally=_rejected(snapshot.tally, rank, t_ns)), nis_per_dof
    return _recover(model, Snapshot(t_ns=t_ns, state=state, tally=snapshot.tally), measurement), nis_per_dof


def _start(model: FilterModel[S], snapshot: Snapshot[S], measurement: Measurement) -> Snapshot[S]:
    """Start on a position; anything else waits for one."""
    tally = snapshot.tally
    if measurement.quantity is not Quantity.POSITION:
        return Snapshot(t_ns=measurement.t_ns, state=None, tally=tally)
    accepted = _put(tally.accepted_ns, _RANK[Quantity.POSITION], measurement.t_ns)
    started = replace(tally, fused=tally.fused + 1, accepted_ns=accepted)
    return Snapshot(t_ns=measurement.t_ns, state=model.start(measurement), tally=started)


def _recover(model: FilterModel[S], snapshot: Snapshot[S], measurement: Measurement) -> Snapshot[S]:
    """Open the filter to data that it has rejected for too long, and fuse them."""
    if snapshot.state is None:
        return snapshot
    state = model.recover(snapshot.state, measurement)
    update = model.update(state, measurement)
    rank = _RANK[measurement.quantity]
    tally = replace(
        snapshot.tally,
        recoveries=snapshot.tally.recoveries + 1,
        accepted_ns=_put(snapshot.tally.accepted_ns, rank, measurement.t_ns),
        rejected_since_ns=_NEVER,
    )
    return Snapshot(t_ns=measurement.t_ns, state=state if update is None else update.state, tally=tally)


def _accepted(tally: Tally, rank: int, t_ns: int, update: Update[S]) -> Tally:
    return Tally(
        fused=tally.fused + 1,
        gated=tally.gated,
        recoveries=tally.recoveries,
        nis_sum=tally.nis_sum + update.nis,
        nis_dof=tally.nis_dof + update.dof,
        accepted_ns=_put(tally.accepted_ns, rank, t_ns),
        rejected_since_ns=_put(tally.rejected_since_ns, rank, None),
    )


def _rejected(tally: Tally, rank: int, t_ns: int) -> Tally:
    since_ns = tally.rejected_since_ns[rank]
    since = _put(tally.rejected_since_ns, rank, t_ns if since_ns is None else since_ns)
    return replace(tally, gated=tally.gated + 1, rejected_since_ns=since)


def _put(values: tuple[int | None, ...], index: int, value: int | None) -> tuple[int | None, ...]:
    return (*values[:index], value, *values[index + 1 :])


def _prune(buffer: DelayBuffer[S], keep_s: float) -> DelayBuffer[S]:
    """Fold what is older than `keep_s` into the base."""
    oldest_ns = buffer.newest.t_ns - round(keep_s * 1e9)
    count = bisect_left(buffer.entries, oldest_ns, key=_time)
    if not count:
        return buffer
    return replace(buffer, base=buffer.entries[count - 1].after, entries=buffer.entries[count:])


def _place(measurement: Measurement) -> Place:
    """A total order, so that equal stamps leave no trace of the order of arrival either."""
    return measurement.t_ns, _RANK[measurement.quantity], tuple(measurement.value.tolist())


def _entry_place(entry: Entry[S]) -> Place:
    return entry.place


def _time(entry: Entry[S]) -> int:
    return entry.measurement.t_ns


@lru_cache(maxsize=64)
def _chi2_quantile(probability: float, dof: int) -> float:
    return float(2.0 * gammaincinv(0.5 * dof, probability))  # scipy.stats would take 37 MB for this one function
