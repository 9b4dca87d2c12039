"""One measurement and one filter: predicted to its time, then fused, gated, or recovered on; pure.

Outliers are gated by their normalised innovation squared (NIS); when one quantity is rejected for too long, the filter
is told to recover on the new data.
"""

import math
from functools import lru_cache
from typing import Generic, Protocol, TypeVar

import numpy as np
from msgspec import Struct
from scipy.special import gammaincinv

from companion.config.estimation import BufferConfig
from companion.core.data import Array, Forecast, Measurement, Quantity, VehicleEstimate
from link.records import replace


class Gaussian(Struct, frozen=True, kw_only=True, eq=False):
    """Mean `(n,)` and covariance `(n, n)`; which states and units, each filter says."""

    mean: Array
    covariance: Array


def symmetric(matrix: Array) -> Array:
    """Return the symmetric part of `(n, n)`, which rounding takes away."""
    return 0.5 * (matrix + matrix.T)


def squared_norm(innovation: Array, covariance: Array) -> float:
    """Return the normalised innovation squared, NIS, of `(m,)` with covariance `(m, m)`."""
    return float(innovation @ np.linalg.solve(covariance, innovation))


def std_of(variance: float) -> float:
    """Return the standard deviation, NaN where data that contradict each other have left no variance."""
    return math.sqrt(variance) if variance >= 0.0 else math.nan


S = TypeVar("S")

QUANTITIES = tuple(Quantity)
RANK = {quantity: rank for rank, quantity in enumerate(QUANTITIES)}
OF_DRONE = frozenset({Quantity.FRAME_STEP, Quantity.SURFACE})
"""What only the drone tells. No filter recovers on it: a range finder may see something else, or be stuck."""
_GOES_ON_S = 1.0  # between two fixes of a receiver that goes on
_NEVER: tuple[int | None, ...] = (None,) * len(QUANTITIES)
_NONE = (0,) * len(QUANTITIES)


class Update(Struct, Generic[S], frozen=True, kw_only=True, eq=False):
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

    @property
    def placed_by(self) -> Quantity:
        """What it starts on, and without which it grows old."""

    def start(self, place: Measurement) -> S:
        """Return the state after a first place."""

    def predict(self, state: S, dt_s: float) -> S:
        """Return the state `dt_s` later."""

    def update(self, state: S, measurement: Measurement) -> Update[S] | None:
        """Return the state after `measurement`, or None when this filter has no use for it."""

    def move_frame(self, state: S, step: Measurement) -> S:
        """Return a state in the drone's frame after a `Quantity.FRAME_STEP`."""

    def recover(self, state: S, measurement: Measurement) -> S:
        """Return a state open to `measurement`, after many like it were rejected."""

    def describe(self, state: S, t_ns: int) -> VehicleEstimate:
        """Return the state as the rest of the companion reads it."""

    def forecast(self, state: S, t_ns: int, offset_s: Array) -> Forecast:
        """Return the future of a state that holds at `t_ns`."""


class Tally(Struct, frozen=True, kw_only=True):
    """What happened to the measurements up to a moment; tuples but `place_step` run over `QUANTITIES`."""

    accepted: tuple[int, ...] = _NONE
    rejected: tuple[int, ...] = _NONE  # as outliers, with those that the filter recovered on
    recoveries: int = 0
    nis_sum: float = 0.0
    nis_dof: int = 0
    moves_to_sightings: int = 0  # recoveries on them
    place_step: tuple[int, float] = (0, 0.0)  # recoveries on fixes that went on, and by how much the last moved it, m
    opened_ns: int | None = None  # when the last recovery was
    accepted_ns: tuple[int | None, ...] = _NEVER
    rejected_since_ns: tuple[int | None, ...] = _NEVER


class Snapshot(Struct, Generic[S], frozen=True, kw_only=True, eq=False):
    """The filter at a moment.

    Attributes:
        t_ns: when.
        told_ns: of the newest that it has heard of the vehicle, used or not.
        state: None until the first place.
        tally: of what came until then.
    """

    t_ns: int
    told_ns: int
    state: S | None
    tally: Tally


def nis_threshold(gate_probability: float | None, dof: int) -> float:
    """Return the NIS above which a measurement of `dof` components is an outlier (chi-square quantile)."""
    return math.inf if gate_probability is None else _chi2_quantile(gate_probability, dof)


def is_forgotten(config: BufferConfig, snapshot: Snapshot[S], t_ns: int) -> bool:
    """Return whether at `t_ns` nothing was heard of the vehicle for so long that the filter restarts."""
    return t_ns - snapshot.told_ns > config.forget_after_s * 1e9


def step(model: FilterModel[S], config: BufferConfig, snapshot: Snapshot[S], measurement: Measurement) -> Snapshot[S]:
    """Predict to the measurement, then fuse it, gate it, or recover on it."""
    t_ns = measurement.t_ns
    is_of_drone = measurement.quantity in OF_DRONE
    if snapshot.state is None or is_forgotten(config, snapshot, t_ns):
        waits: Snapshot[S] = Snapshot(t_ns=t_ns, told_ns=snapshot.told_ns, state=None, tally=snapshot.tally)
        return waits if is_of_drone else _start(model, snapshot, measurement)
    state, told_ns = snapshot.state, snapshot.told_ns if is_of_drone else t_ns
    if t_ns > snapshot.t_ns:
        state = model.predict(state, (t_ns - snapshot.t_ns) * 1e-9)
    if measurement.quantity is Quantity.FRAME_STEP:
        state = model.move_frame(state, measurement)
        return Snapshot(t_ns=t_ns, told_ns=told_ns, state=state, tally=snapshot.tally)
    update = model.update(state, measurement)
    if update is None:
        return Snapshot(t_ns=t_ns, told_ns=told_ns, state=state, tally=snapshot.tally)
    rank = RANK[measurement.quantity]
    if update.gate_nis <= nis_threshold(config.gate_probability, update.dof):
        tally = _accept(snapshot.tally, rank, t_ns, update)
        return Snapshot(t_ns=t_ns, told_ns=told_ns, state=update.state, tally=tally)
    since_ns = snapshot.tally.rejected_since_ns[rank]
    is_new = since_ns is None or t_ns - since_ns < config.recover_after_s * 1e9
    if is_new or is_of_drone:
        tally = _reject(snapshot.tally, rank, t_ns)
        return Snapshot(t_ns=t_ns, told_ns=told_ns, state=state, tally=tally)
    return _recover(model, state, snapshot.tally, measurement)


def _start(model: FilterModel[S], snapshot: Snapshot[S], measurement: Measurement) -> Snapshot[S]:
    """Start on a place; anything else waits for one."""
    tally = snapshot.tally
    t_ns = measurement.t_ns
    if measurement.quantity is not model.placed_by:
        return Snapshot(t_ns=t_ns, told_ns=t_ns, state=None, tally=tally)
    rank = RANK[model.placed_by]
    accepted_ns = _put(tally.accepted_ns, rank, t_ns)
    started = replace(tally, accepted=_one_more(tally.accepted, rank), accepted_ns=accepted_ns)
    return Snapshot(t_ns=t_ns, told_ns=t_ns, state=model.start(measurement), tally=started)


def _recover(model: FilterModel[S], state: S, tally: Tally, measurement: Measurement) -> Snapshot[S]:
    """Open the filter, predicted to data that it has rejected for too long, to them, and fuse them."""
    before, t_ns, rank = state, measurement.t_ns, RANK[measurement.quantity]
    state = model.recover(state, measurement)
    update = model.update(state, measurement)
    state = state if update is None else update.state
    tally = replace(
        tally,
        rejected=_one_more(tally.rejected, rank),
        recoveries=tally.recoveries + 1,
        moves_to_sightings=tally.moves_to_sightings + (measurement.quantity is Quantity.PAD),
        place_step=_count_step(model, tally, measurement, before, state),
        opened_ns=t_ns,
        accepted_ns=_put(tally.accepted_ns, rank, t_ns),
        rejected_since_ns=_NEVER,
    )
    return Snapshot(t_ns=t_ns, told_ns=t_ns, state=state, tally=tally)


def _count_step(
    model: FilterModel[S], tally: Tally, measurement: Measurement, before: S, after: S
) -> tuple[int, float]:
    """Return the steps of the place with this one; what follows a silence is none, nor what the velocity shows, too."""
    since_ns, velocity = measurement.t_ns - round(_GOES_ON_S * 1e9), RANK[Quantity.VELOCITY]
    told = (tally.accepted_ns[RANK[Quantity.POSITION]], tally.accepted_ns[velocity])
    goes_on = all(one is not None and one >= since_ns for one in told) and tally.rejected_since_ns[velocity] is None
    is_open = tally.opened_ns is not None and tally.opened_ns >= since_ns
    if measurement.quantity is not Quantity.POSITION or is_open or not goes_on:
        return tally.place_step
    here, there = (model.describe(one, measurement.t_ns).position_enu_m for one in (before, after))
    return tally.place_step[0] + 1, math.hypot(*(there - here)[:2].tolist())


def _accept(tally: Tally, rank: int, t_ns: int, update: Update[S]) -> Tally:
    return Tally(
        accepted=_one_more(tally.accepted, rank),
        rejected=tally.rejected,
        recoveries=tally.recoveries,
        nis_sum=tally.nis_sum + update.nis,
        nis_dof=tally.nis_dof + update.dof,
        moves_to_sightings=tally.moves_to_sightings,
        place_step=tally.place_step,
        opened_ns=tally.opened_ns,
        accepted_ns=_put(tally.accepted_ns, rank, t_ns),
        rejected_since_ns=_put(tally.rejected_since_ns, rank, None),
    )


def _reject(tally: Tally, rank: int, t_ns: int) -> Tally:
    since_ns = tally.rejected_since_ns[rank]
    since = _put(tally.rejected_since_ns, rank, t_ns if since_ns is None else since_ns)
    return replace(tally, rejected=_one_more(tally.rejected, rank), rejected_since_ns=since)


def _one_more(counts: tuple[int, ...], rank: int) -> tuple[int, ...]:
    return (*counts[:rank], counts[rank] + 1, *counts[rank + 1 :])


def _put(values: tuple[int | None, ...], index: int, value: int | None) -> tuple[int | None, ...]:
    return (*values[:index], value, *values[index + 1 :])


@lru_cache(maxsize=64)
def _chi2_quantile(probability: float, dof: int) -> float:
    return float(2.0 * gammaincinv(0.5 * dof, probability))  # scipy.stats would take 37 MB for this one function
