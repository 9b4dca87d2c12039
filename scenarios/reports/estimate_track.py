"""The companion's recorded estimates against the truth, in the frame that the drone flies in.

That frame is the autopilot's local one with the autopilot's own error: an estimate that is right there lands the drone,
and one that is right in the world does not. `scenarios.scoring.accuracy` compares in the same frame.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from link.frames.geodesy import LocalFrame, Projection
from link.messages import BodyTruth
from link.units import NS_PER_S
from scenarios.config import Scenario
from scenarios.scoring.truth_log import TruthLog
from scenarios.simulation.vehicle_node import datum_of
from sim_autopilot.core.places import Origin, local_from_world

Array = NDArray[np.float64]
Fields = dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class EstimateTrack:
    """The companion's estimate of the antenna against the truth at the same instants.

    Attributes:
        t_s: (n,).
        error_m: (n, 3) in the local frame that the drone flies in.
        std_m: (n, 3).
        nees: (n,) squared error of the position over its covariance; 3 on average if that is right.
    """

    t_s: Array
    error_m: Array
    std_m: Array
    nees: Array


def time_s(fields: Fields, start_ns: int) -> float:
    """Return the time of a record since `start_ns`."""
    t_ns = int(fields["header.stamp.sec"]) * NS_PER_S + int(fields["header.stamp.nanosec"])
    return (t_ns - start_ns) / NS_PER_S


def estimate_track(
    estimates: Sequence[Fields], own: Sequence[BodyTruth], log: TruthLog, antenna_enu_m: Array, scenario: Scenario
) -> EstimateTrack | None:
    """Return the estimates against the truth, None where there are none.

    Args:
        estimates: as they were recorded.
        own: the drone as its autopilot reported it.
        log: the truth.
        antenna_enu_m: (n, 3) true position of the vehicle's antenna at the log's times, in W.
        scenario: that was flown.
    """
    start_ns = int(log.t_ns[0])
    own_s, own_enu_m = reported(own, start_ns, int(log.t_ns[-1]))
    if not estimates or not len(own_s):
        return None
    truth_s = (log.t_ns - start_ns) / NS_PER_S
    times_s = np.array([time_s(fields, start_ns) for fields in estimates])
    inside = (times_s >= own_s[0]) & (times_s <= own_s[-1])  # beyond them the drone's own error is not known
    times_s = times_s[inside]
    drone = _at(times_s, truth_s, _in_local_frame(log.position_enu_m, scenario))
    own_error = _at(times_s, own_s, own_enu_m) - drone
    true = _at(times_s, truth_s, _in_local_frame(antenna_enu_m, scenario)) + own_error
    error = np.array([fields["position_m"] for fields in estimates])[inside] - true
    covariance = np.array([fields["covariance"].reshape(9, 9)[:3, :3] for fields in estimates])[inside]
    return EstimateTrack(
        t_s=times_s,
        error_m=error,
        std_m=np.sqrt(np.diagonal(covariance, axis1=1, axis2=2)),
        nees=np.einsum("ni,ni->n", error, np.linalg.solve(covariance, error[:, :, None])[:, :, 0]),
    )


def reported(own: Sequence[BodyTruth], start_ns: int, end_ns: int) -> tuple[Array, Array]:
    """Return when, since `start_ns`, and where (n, 3) an autopilot reported the drone, from the first to the last time.

    Before the autopilot's clock has settled a report may have any time; such a one would displace all others.
    """
    inside = sorted((one.t_ns, one.position_enu_m) for one in own if start_ns <= one.t_ns <= end_ns)
    times_s = np.array([(t_ns - start_ns) / NS_PER_S for t_ns, _ in inside])
    return times_s, np.array([position for _, position in inside])


def _at(times_s: Array, known_s: Array, values: Array) -> Array:
    """Return values (n, 3) at `times_s`, from those (m, 3) at `known_s`."""
    return np.stack([np.interp(times_s, known_s, column) for column in values.T], axis=1)


def _in_local_frame(positions_enu_m: Array, scenario: Scenario) -> Array:
    """Return places in W (n, 3) as the scenario's firmware lays them out about the datum, its origin at boot."""
    datum = datum_of(scenario.run.datum)
    origin = Origin(world=datum, frame=LocalFrame(origin=datum, projection=Projection(scenario.firmware)))
    return np.array([local_from_world(origin, (x, y, z)) for x, y, z in positions_enu_m.tolist()])
