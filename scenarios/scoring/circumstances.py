"""What the vehicle did in the seconds before the decisive instant of a run, from ground truth alone.

The decisive instant is that of the first contact; without one, that at which the drone was closest to the pad. Speeds
and accelerations of the vehicle are differences of its true places over 0.1 s: a jolt of the road counts as what it
does to a landing, not as what an accelerometer would read.

Frames: W is ENU; along and to the left are horizontal, by the vehicle's velocity.
"""

import numpy as np

from scenarios.scoring.truth_log import Array, TruthLog

BEFORE_S = 3.0
"""How long before the instant counts: about as long as a drone sinks from where it waits to the pad."""
_DIFFERENCE_S = 0.1
_STANDS_M_S = 0.1
_DRIVES_M_S = 0.5  # as fast, relative to the deck, as a contact of S2 may be
_CURVATURE_FROM_M_S = 1.0  # slower than this, noise of the places bends the path more than the road does
_SPEED_LEAST_M_S = 1e-3

Circumstances = dict[str, float | bool | None]


def vehicle_circumstances(log: TruthLog, at_ns: int) -> Circumstances:
    """Return what the vehicle did at an instant and in the seconds before it.

    Args:
        log: of the run.
        at_ns: within the log.

    Returns:
        `vehicle_speed_m_s` and `vehicle_curvature_per_m` (its size, None of one that hardly moves) at the instant, and
        of the seconds before: `before_brake_m_s2` and `before_speed_up_m_s2` along its way, `before_lateral_m_s2` by
        how much its acceleration to the side changed, `before_rise_m_s` by how much its vertical speed did, and
        `before_departs`, whether it stood and drives now.
    """
    at = min(int(np.searchsorted(log.t_ns, at_ns)), len(log.t_ns) - 1)
    first = int(np.searchsorted(log.t_ns, log.t_ns[at] - round(BEFORE_S * 1e9)))
    margin = _samples(log)
    span = slice(max(0, first - 2 * margin), at + 2 * margin + 1)
    t_s = (log.t_ns[span] - log.t_ns[at]) * 1e-9
    velocity_m_s = _differences(log.vehicle_position_enu_m[span], t_s, margin)
    acceleration_m_s2 = _differences(velocity_m_s, t_s, margin)
    inside = slice(first - span.start, at - span.start + 1)
    velocity_m_s, acceleration_m_s2 = velocity_m_s[inside], acceleration_m_s2[inside]
    speed_m_s = np.linalg.norm(velocity_m_s[:, :2], axis=1)
    along, left = _along_and_left(velocity_m_s, acceleration_m_s2, speed_m_s)
    now_m_s = float(speed_m_s[-1])
    return {
        "vehicle_speed_m_s": now_m_s,
        "vehicle_curvature_per_m": abs(float(left[-1])) / now_m_s**2 if now_m_s >= _CURVATURE_FROM_M_S else None,
        "before_brake_m_s2": max(0.0, -float(along.min())),
        "before_speed_up_m_s2": max(0.0, float(along.max())),
        "before_lateral_m_s2": float(np.ptp(left)),
        "before_rise_m_s": float(np.ptp(velocity_m_s[:, 2])),
        "before_departs": bool(speed_m_s.min() < _STANDS_M_S and now_m_s > _DRIVES_M_S),
    }


def closest_ns(log: TruthLog, roof_height_m: float, from_ns: int) -> int:
    """Return when the drone was closest to the pad's centre, from an instant on; the end of a log that is older."""
    distance_m = np.linalg.norm(log.position_v_m - np.array([0.0, 0.0, roof_height_m]), axis=1)
    considered = np.where(log.t_ns >= from_ns, distance_m, np.inf)
    return int(log.t_ns[-1 if np.isinf(considered).all() else int(np.argmin(considered))])


def _samples(log: TruthLog) -> int:
    """Return how many samples make half of a difference."""
    period_s = float(np.median(np.diff(log.t_ns))) * 1e-9
    return max(1, round(0.5 * _DIFFERENCE_S / period_s))


def _differences(values: Array, t_s: Array, margin: int) -> Array:
    """Return the rate of change (n, k) of `values` (n, k), over `margin` samples to either side, fewer at the ends."""
    place = np.arange(len(t_s))
    low, high = np.maximum(place - margin, 0), np.minimum(place + margin, len(t_s) - 1)
    return np.asarray((values[high] - values[low]) / (t_s[high] - t_s[low])[:, None])


def _along_and_left(velocity_m_s: Array, acceleration_m_s2: Array, speed_m_s: Array) -> tuple[Array, Array]:
    """Return the acceleration (n,) along the velocity and (n,) to its left, both 0 where the vehicle stands."""
    east, north = (velocity_m_s[:, :2] / np.maximum(speed_m_s, _SPEED_LEAST_M_S)[:, None]).T
    along = acceleration_m_s2[:, 0] * east + acceleration_m_s2[:, 1] * north
    left = acceleration_m_s2[:, 1] * east - acceleration_m_s2[:, 0] * north
    return along, left
