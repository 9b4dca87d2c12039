"""What rollouts of a descent are made from, and how the vehicle of a sample drives; compiled.

Places, velocities and accelerations are off the pad's forecast, horizontal, in W.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from companion.core.data import Array
from companion.forecast.compiled import compiled_kernel

IndexArray = NDArray[np.intp]

DT_S = 0.03
STEADY, ALONG, ASIDE = 0, 1, 2
"""What a sample's vehicle does: nothing new, another acceleration along its way, or to its left."""

CONTACT, IN_S, ERROR, SPEED, SINK, TILT = range(6)
"""Columns of what a sample ends with: 1 for a contact, after which time, and what the limits bound."""


class Follower(NamedTuple):
    """How the drone follows: gains and lags of its cascade, of its planner, and the limits of both.

    A drone that levels, below `level_below_m`, leans by `level_m_s2` at most: thrust by mass, steady flight included.
    `led_share` is of a change of the acceleration asked for what the lean follows at once: 1 where setpoints are led.
    `way_s` is how long the planner's shortest way takes. The vehicle's velocity is known with an error of
    `error_std_m_s` along an axis, which becomes another one `relearns_hz` times a second. How the vehicle turns is told
    by an antenna that passes `trails_s` after the pad; 0 where a sensor tells it.
    """

    stiffness_per_s2: float
    damping_per_s: float
    path_share: float
    led_share: float
    turns_hz: float
    forgets_hz: float
    drag_per_s: float
    push_std_m_s2: float
    way_s: float
    believes_s: float
    trails_s: float
    relearns_hz: float
    error_std_m_s: float
    acceleration_max_m_s2: float
    jerk_max_m_s3: float
    level_m_s2: float
    level_below_m: float


class Rules(NamedTuple):
    """What keeps a descent from its contact, and the drone's feet.

    After a longer wait than `waits_max_s` in all, the contact is another descent's.
    """

    waits_max_s: float
    waits_below_m: float
    commits_below_m: float
    cone_at_pad_m: float
    cone_slope: float
    near_speed_m_s: float
    over_pad_m: float
    stops_sinking_s: float
    climbs_m_s2: float
    foot_radius_m: float


class Course(NamedTuple):
    """What is expected, each step from now on.

    Attributes:
        direction: (m, 2) of the vehicle, a unit vector.
        speed_m_s: (m,) along it.
        along_m_s2: (m,) acceleration along it.
        left_m_s2: (m,) to its left.
        way_down: (3, m) height over the pad, rate and acceleration.
        slope: (m, 2) of the deck, height per length in W.
        shake_enu: (2, m, 2) place and velocity of the pad beside the forecast, by a swing that is not followed.
        air_enu_m_s2: (2,) horizontal thrust by mass that holds against the air.
        model: (3, 2) place, velocity and acceleration of the virtual model beside the pad now.
    """

    direction: Array
    speed_m_s: Array
    along_m_s2: Array
    left_m_s2: Array
    way_down: Array
    slope: Array
    shake_enu: Array
    air_enu_m_s2: Array
    model: Array


class Samples(NamedTuple):
    """What differs from sample to sample.

    Attributes:
        vehicle: (n, 3, 2) place, velocity and acceleration of the vehicle off its forecast at the newest datum.
        kind: (n,) what it does.
        event: (n, 4) when that begins, s after the newest datum; to which acceleration, m/s^2; within which time, s;
            and after which time the acceleration of before is released, s.
        delay_s: (n,) of what is known of it.
        ahead_s: (n,) until a plan of now moves the drone; what was sent before does until then.
        deviation: (n, 4, 2) state of the cascade now.
        vertical: (n, 2) height that the drone is lower than believed, m, and how much faster it sinks, m/s.
        deck: (n, 3, 2) slope of the deck, place and velocity of the pad's shake at the contact, off the course's.
        pushes: (n, m, 2) standard normal: of the sample's gusts, and of the errors of the one after it.
    """

    vehicle: Array
    kind: IndexArray
    event: Array
    delay_s: Array
    ahead_s: Array
    deviation: Array
    vertical: Array
    deck: Array
    pushes: Array


class Descent(NamedTuple):
    """What all samples have in common."""

    course: Course
    drone: Follower
    rules: Rules


@compiled_kernel
def drive(samples: Samples, sample: int, course: Course, before: int) -> Array:
    """Return place, velocity and acceleration (b + m, 3, 2) of a sample's vehicle off its forecast.

    Args:
        samples: all of them.
        sample: which.
        course: expected, m steps from now on.
        before: b, steps from the newest datum to the present.
    """
    vehicle, kind, event = samples.vehicle[sample], samples.kind[sample], samples.event[sample]
    steps = before + len(course.speed_m_s)
    path = np.empty((steps, 3, 2))
    x, y, vx, vy = vehicle[0, 0], vehicle[0, 1], vehicle[1, 0], vehicle[1, 1]
    cx, cy = course.direction[0, 0], course.direction[0, 1]
    off_along, off_left = vehicle[2, 0] * cx + vehicle[2, 1] * cy, vehicle[2, 1] * cx - vehicle[2, 0] * cy
    first_along = course.along_m_s2[0] + off_along
    onset_s, size_m_s2, ramp_s, release_s = event[0], event[1], event[2], event[3]
    for k in range(steps):
        at, t_s = max(k - before, 0), k * DT_S
        cx, cy = course.direction[at, 0], course.direction[at, 1]
        expected_along, expected_left = course.along_m_s2[at], course.left_m_s2[at]
        along = first_along if t_s < release_s else 0.0
        left = expected_left + off_left
        if t_s > onset_s:
            share = min((t_s - onset_s) / ramp_s, 1.0)
            if kind == ALONG:
                along += share * (size_m_s2 - along)
            elif kind == ASIDE:
                left += share * (size_m_s2 - left)
        speed = course.speed_m_s[at] + vx * cx + vy * cy
        if speed + along * DT_S < 0.0 and along < 0.0:
            along = -speed / DT_S if speed > 0.0 else 0.0
        more_along, more_left = along - expected_along, left - expected_left
        ax, ay = more_along * cx - more_left * cy, more_along * cy + more_left * cx
        path[k, 0, 0], path[k, 0, 1], path[k, 1, 0], path[k, 1, 1] = x, y, vx, vy
        path[k, 2, 0], path[k, 2, 1] = ax, ay
        x += (vx + 0.5 * ax * DT_S) * DT_S
        y += (vy + 0.5 * ay * DT_S) * DT_S
        vx += ax * DT_S
        vy += ay * DT_S
    return path
