"""What the view has shown so far, as columns for trails and plots."""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from link.messages import Vector3
from scenarios.view.shapes import estimated_vehicle, true_vehicle
from scenarios.view.state import ViewState

Array = NDArray[np.float64]
_UNKNOWN = math.nan  # of the plots only: a gap in a line
_NOWHERE = (_UNKNOWN, _UNKNOWN, _UNKNOWN)
ROWS_MAX = 36_000
"""Of what goes on: half an hour at 20 Hz."""
NAMES = ("height_m", "distance_m", "relative_speed_m_s", "drone_speed_m_s", "vehicle_speed_m_s", "error_m")


@dataclass(slots=True)
class History:
    """Rows in the order of time.

    Attributes:
        rows_max: when there are more, the older half goes; None keeps all.
        start_ns: of the first row.
        times_s: since then.
        drone: its positions in W; not a number where unknown, as in the other columns.
        pad: the pad's centre, true or else estimated.
        values: one of `NAMES` each.
    """

    rows_max: int | None = None
    start_ns: int | None = None
    times_s: list[float] = field(default_factory=list)
    drone: list[Vector3] = field(default_factory=list)
    pad: list[Vector3] = field(default_factory=list)
    values: list[tuple[float, ...]] = field(default_factory=list)

    def add(self, state: ViewState) -> None:
        """Add a state; one that is not newer than the last is left out, one long before it begins a new history."""
        t_s = 0.0 if self.start_ns is None else (state.t_ns - self.start_ns) * 1e-9
        if not state.t_ns or (self.times_s and 0.0 <= self.times_s[-1] - t_s < 1.0):
            return
        if self.times_s and t_s < self.times_s[-1]:
            self.clear()
        if self.start_ns is None:
            self.start_ns, t_s = state.t_ns, 0.0
        if self.rows_max is not None and len(self.times_s) >= self.rows_max:
            for column in (self.times_s, self.drone, self.pad, self.values):
                del column[: self.rows_max // 2]
        self.times_s.append(t_s)
        self.drone.append(_NOWHERE if state.drone is None else state.drone.position_enu_m)
        self.pad.append(_pad(state))
        self.values.append(_values(state))

    def clear(self) -> None:
        """Forget all."""
        self.start_ns = None
        for column in (self.times_s, self.drone, self.pad, self.values):
            column.clear()

    def trail(self, column: list[Vector3], end: int, length: int, every: int) -> Array:
        """Return (n, 3) of the last `length` rows before `end`, every so many, without those unknown."""
        points = np.array(column[max(end - length, 0) : end : every], dtype=np.float64).reshape(-1, 3)
        return np.asarray(points[np.isfinite(points[:, 0])])

    def columns(self, end: int, points_max: int) -> tuple[Array, Array]:
        """Return times (n,) and values (n, 6) before row `end`, thinned out to `points_max`."""
        every = max(math.ceil(end / points_max), 1)
        times_s = np.array(self.times_s[:end:every])
        return times_s, np.array(self.values[:end:every]).reshape(-1, len(NAMES))


def _pad(state: ViewState) -> Vector3:
    pose, pad = true_vehicle(state) or estimated_vehicle(state), state.pad
    if pose is None:
        return _NOWHERE
    (x_m, y_m, z_m), _ = pose
    return x_m, y_m, z_m + (0.0 if pad is None else pad.height_m)


def _values(state: ViewState) -> tuple[float, ...]:
    status = state.status
    position = None if status is None else status.relative_position_enu_m
    velocity = None if status is None else status.relative_velocity_enu_m_s
    true, estimated = true_vehicle(state), estimated_vehicle(state)
    return (
        _UNKNOWN if position is None else position[2],
        _UNKNOWN if position is None else math.hypot(*position[:2]),
        _UNKNOWN if velocity is None else math.hypot(*velocity),
        _UNKNOWN if state.drone is None else math.hypot(*state.drone.velocity_flu_m_s),
        _vehicle_speed_m_s(state),
        _UNKNOWN if true is None or estimated is None else math.dist(true[0][:2], estimated[0][:2]),
    )


def _vehicle_speed_m_s(state: ViewState) -> float:
    if state.vehicle_truth is not None:
        return math.hypot(*state.vehicle_truth.velocity_flu_m_s)
    return _UNKNOWN if state.estimate is None else math.hypot(*state.estimate.velocity_enu_m_s)
