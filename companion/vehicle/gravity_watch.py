"""Whether what a vehicle's accelerometer tells is in m/s^2 and along the vehicle's axes, as gravity shows.

On the mean of some seconds a vehicle feels gravity, straight upwards, and next to nothing else. A unit that leaves
gravity out tells nothing then. One that tells g or ten times too much, whose sign is the other way, or whose axes are
exchanged or count downwards, tells something else: by it a brake is none, or a push forwards. Axes that are turned
about the vertical show nothing here.
"""

import math

from companion.core.data import GRAVITY_M_S2, STEP_MAX_S
from link.frames.rotations import rotate, yaw_of
from link.messages import Quaternion, Vector3

_OVER_S = 5.0  # longer than a brake or a crest lasts
_JUDGED_AFTER_S = 1.0
# A cheap unit's offset and scale: 0.08 g and 3 % (data sheet of the MPU-6000); and a crest.
_OFF_MAX_M_S2 = 1.5
# Of a unit that leaves gravity out: less than 1 g that is told as 1.
_UP_MAX_M_S2 = 0.7
# No road vehicle turns or brakes so hard for so long: 0.7 of gravity, which a horizontal axis tells whole.
_LEVEL_MAX_M_S2 = 0.7 * GRAVITY_M_S2
FORCE_MAX_M_S2 = 100.0
"""No specific force of an axis counts for more: one absurd reading says nothing of the others."""


class GravityWatch:
    """Takes the specific forces of a vehicle's unit, in the order in which they come."""

    def __init__(self) -> None:
        self._mean_m_s2: Vector3 = (0.0, 0.0, 0.0)  # ahead, to the left and up
        self._heard_s = 0.0
        self._newest_ns: int | None = None

    def take(self, t_ns: int, force_flu_m_s2: Vector3, q_WV: Quaternion | None) -> None:
        """Take a specific force.

        Args:
            t_ns: when it was felt.
            force_flu_m_s2: along the vehicle's axes.
            q_WV: its attitude, None of a unit that tells none.
        """
        bounded_m_s2 = bounded_force(force_flu_m_s2)
        felt_m_s2 = bounded_m_s2 if q_WV is None else _level(bounded_m_s2, q_WV)
        passed_s = 0.0 if self._newest_ns is None else min(max((t_ns - self._newest_ns) * 1e-9, 0.0), STEP_MAX_S)
        self._newest_ns = t_ns
        self._heard_s += passed_s
        share = passed_s / min(self._heard_s, _OVER_S) if self._heard_s > 0.0 else 1.0
        ahead, left, up = (mean + share * (one - mean) for mean, one in zip(self._mean_m_s2, felt_m_s2, strict=True))
        self._mean_m_s2 = ahead, left, up

    @property
    def is_believed(self) -> bool:
        """Whether what it tells is in m/s^2 and along the vehicle's axes, as far as gravity shows."""
        return self._is_judged and self._has_gravity_or_none

    @property
    def doubt(self) -> str | None:
        """What is told of it where it is not; None where it is, and before that shows."""
        if not self._is_judged or self._has_gravity_or_none:
            return None
        told = ", ".join(f"{round(one, 1) + 0.0:.1f}" for one in self._mean_m_s2)
        return f"mean acceleration ({told}) is neither (0, 0, 9.8) nor 0: see m/s^2, axes (FLU)"

    @property
    def _is_judged(self) -> bool:
        return self._heard_s >= _JUDGED_AFTER_S

    @property
    def _has_gravity_or_none(self) -> bool:
        ahead_m_s2, left_m_s2, up_m_s2 = self._mean_m_s2
        if math.hypot(ahead_m_s2, left_m_s2) > _LEVEL_MAX_M_S2:
            return False
        return abs(up_m_s2) <= _UP_MAX_M_S2 or abs(up_m_s2 - GRAVITY_M_S2) <= _OFF_MAX_M_S2


def bounded_force(force_m_s2: Vector3) -> Vector3:
    """Return a specific force with no axis beyond what counts, so that turning it leaves numbers."""
    x, y, z = (min(max(one, -FORCE_MAX_M_S2), FORCE_MAX_M_S2) for one in force_m_s2)
    return x, y, z


def _level(force_flu_m_s2: Vector3, q_WV: Quaternion) -> Vector3:
    """Return a force ahead, to the left and up, of which the vehicle's tilt is no part."""
    east, north, up = rotate(q_WV, force_flu_m_s2)
    yaw_rad = yaw_of(q_WV)
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    return c * east + s * north, c * north - s * east, up
