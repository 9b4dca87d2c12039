"""The fastest way from a relative position and velocity to rest, under a speed and an acceleration limit.

State `[e, w]` per axis: relative position m and velocity m/s; the acceleration is +a, 0 or -a. Source: the
time-optimal control of the double integrator, e.g. Bryson and Ho 1975, section 3.9, with a bound on w.
"""

from dataclasses import dataclass

import numpy as np

from companion.data import Array

_TINY = 1e-12


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Intercept:
    """Three phases per axis, arrays (k,): constant acceleration, cruise, braking to rest at the origin.

    Attributes:
        error_m: relative position at the start.
        rate_m_s: relative velocity at the start.
        cruise_m_s: relative velocity between first and last phase.
        first_s: duration of the first phase.
        cruise_s: duration of the cruise.
        last_s: duration of the last phase.
    """

    error_m: Array
    rate_m_s: Array
    cruise_m_s: Array
    first_s: Array
    cruise_s: Array
    last_s: Array

    @property
    def duration_s(self) -> Array:
        """Time until rest at the origin, (k,)."""
        return self.first_s + self.cruise_s + self.last_s

    def at(self, t_s: Array) -> tuple[Array, Array, Array]:
        """Return relative position, velocity and acceleration (k, n) at `t_s` (n,) >= 0."""
        first, cruise, last = self.first_s[:, None], self.cruise_s[:, None], self.last_s[:, None]
        start, middle = self.rate_m_s[:, None], self.cruise_m_s[:, None]
        gain = (middle - start) / np.maximum(first, _TINY)
        brake = -middle / np.maximum(last, _TINY)
        in_first = np.minimum(t_s, first)
        in_cruise = np.clip(t_s - first, 0.0, cruise)
        in_last = np.clip(t_s - (first + cruise), 0.0, last)
        position = (
            self.error_m[:, None]
            + (start + 0.5 * gain * in_first) * in_first
            + middle * in_cruise
            + (middle + 0.5 * brake * in_last) * in_last
        )
        velocity = start + gain * in_first + brake * in_last
        braking = (t_s >= first + cruise) & (t_s < first + cruise + last)
        acceleration = gain * (t_s < first) + brake * braking
        return position, velocity, acceleration


def plan_intercept(
    error_m: Array, rate_m_s: Array, acceleration_m_s2: Array, rate_min_m_s: Array, rate_max_m_s: Array
) -> Intercept:
    """Return the time-optimal way to rest at the origin.

    Args:
        error_m: (k,) relative position.
        rate_m_s: (k,) relative velocity, allowed to start outside its bounds.
        acceleration_m_s2: (k,) magnitude, > 0.
        rate_min_m_s: (k,) < 0.
        rate_max_m_s: (k,) > 0.
    """
    stop = error_m + rate_m_s * np.abs(rate_m_s) / (2.0 * acceleration_m_s2)
    way = np.where(stop > 0.0, -1.0, 1.0)
    ahead = -way * error_m
    speed = way * rate_m_s
    bound = np.where(way > 0.0, rate_max_m_s, -rate_min_m_s)
    peak = np.sqrt(np.maximum(acceleration_m_s2 * ahead + 0.5 * speed**2, 0.0))
    cruise = np.minimum(peak, bound)
    first_s = np.abs(cruise - speed) / acceleration_m_s2
    last_s = cruise / acceleration_m_s2
    covered = 0.5 * (speed + cruise) * first_s + 0.5 * cruise * last_s
    return Intercept(
        error_m=error_m,
        rate_m_s=rate_m_s,
        cruise_m_s=way * cruise,
        first_s=first_s,
        cruise_s=np.where(peak > bound, np.maximum(ahead - covered, 0.0) / np.maximum(cruise, _TINY), 0.0),
        last_s=last_s,
    )
