"""When the vehicle passes a place: the instant at which it is nearest, on truth."""

import numpy as np

from scenarios.scoring.truth_log import Array, TruthLog

_PASSED_M = 1.0  # farther than its closest approach by this, the vehicle has passed
_SAME_M = 1e-6


def passing_ns(log: TruthLog, place_enu_m: Array, around_ns: int) -> int | None:
    """Return when the vehicle is nearest to a place on that one of its passings which is at, or next to, an instant.

    A vehicle that stands is nearest all the time, of which the instant itself counts.

    Args:
        log: of the run.
        place_enu_m: (2,) in W.
        around_ns: within the log.

    Returns:
        None where the vehicle is still coming nearer at the end of the log.
    """
    aside_m = np.linalg.norm(log.vehicle_position_enu_m[:, :2] - place_enu_m, axis=1)
    around = min(int(np.searchsorted(log.t_ns, around_ns)), len(aside_m) - 1)
    first = around + 1 - _samples_until_passed(aside_m[around::-1])
    last = around + _samples_until_passed(aside_m[around:])
    within_m = aside_m[first:last]
    nearest = np.flatnonzero(within_m <= within_m.min() + _SAME_M) + first
    index = int(nearest[np.argmin(np.abs(nearest - around))])
    return None if index == len(aside_m) - 1 else int(log.t_ns[index])


def _samples_until_passed(aside_m: Array) -> int:
    passed = np.flatnonzero(aside_m > np.minimum.accumulate(aside_m) + _PASSED_M)
    return int(passed[0]) if len(passed) else len(aside_m)
