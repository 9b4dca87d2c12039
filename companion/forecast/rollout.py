"""Samples of how a descent ends: the vehicle, what is known of it, and the drone that follows that; compiled.

All horizontal motion is told as its deviation from the pad's forecast, in W. A sample's vehicle begins at the newest
datum, off the forecast by what the estimate may err, keeps its acceleration until that is released, and may brake,
depart or turn in. What the drone knows of it is late, and errs (`knowledge`); how it flies says `steering`. What was
sent before leads it until a setpoint of now takes effect. The way down is the planned one. A drone that sees, above
where it commits, what it waits for stays at its height meanwhile, and does not come to the contact after a longer wait;
nor does one that breaks off below while it still can stop sinking.
"""

import math

import numpy as np

from companion.core.data import GRAVITY_M_S2, Array
from companion.forecast.compiled import compiled_kernel
from companion.forecast.knowledge import believe, know, relearn
from companion.forecast.samples import (
    CONTACT,
    DT_S,
    ERROR,
    IN_S,
    SINK,
    SPEED,
    TILT,
    Descent,
    Follower,
    Rules,
    Samples,
    drive,
)
from companion.forecast.steering import follow, plan, steer

_SINKS_M_S = 0.2  # at least, of a drone above the pad that comes to a contact


@compiled_kernel
def _waits(off: Array, height_m: float, rules: Rules) -> bool:
    """Return whether a drone that is seen `off` (2, 2) its pad by so much waits here."""
    if height_m > rules.waits_below_m or height_m <= rules.commits_below_m:
        return False
    beside_m, rate_m_s = math.hypot(off[0, 0], off[0, 1]), math.hypot(off[1, 0], off[1, 1])
    is_beside = beside_m > rules.cone_at_pad_m + rules.cone_slope * height_m
    return is_beside or rate_m_s > rules.near_speed_m_s


@compiled_kernel
def _breaks_off(off: Array, height_m: float, sink_m_s: float, rules: Rules) -> bool:
    """Return whether a drone that is seen `off` (2, 2) its pad by so much breaks off here, and still can."""
    if height_m > rules.commits_below_m:
        return False
    beside_m, rate_m_s = math.hypot(off[0, 0], off[0, 1]), math.hypot(off[1, 0], off[1, 1])
    stops_m = sink_m_s * rules.stops_sinking_s + 0.5 * sink_m_s**2 / rules.climbs_m_s2
    return (rate_m_s > rules.near_speed_m_s or beside_m > rules.over_pad_m) and height_m > stops_m


@compiled_kernel
def _contact_at(step: int, height_m: float, sink_m_s: float, steps: int) -> int:
    """Return the step at which a drone touches that goes on to sink."""
    return min(step + int(max(height_m, 0.0) / max(sink_m_s, _SINKS_M_S) / DT_S), steps - 1)


@compiled_kernel
def _levels(foot_m: float, sink_m_s: float, leans_m_s2: float, drone: Follower) -> bool:
    """Return whether a drone levels whose lowest foot is so high, and which leans so much."""
    early_m = max(sink_m_s, 0.0) * max(leans_m_s2 - drone.level_m_s2, 0.0) / drone.jerk_max_m_s3
    return foot_m < drone.level_below_m + early_m


@compiled_kernel
def _touch(off: Array, lean: Array, sink_m_s: float, air: Array, out: Array) -> None:
    """Write into `out` (6,) a contact: `off` (2, 2) its pad, with that thrust by mass beside the deck's upright."""
    trim = math.atan(math.hypot(air[0], air[1]) / GRAVITY_M_S2)
    tilt = math.hypot(lean[0], lean[1]) / GRAVITY_M_S2
    out[CONTACT], out[SINK], out[TILT] = 1.0, sink_m_s, math.atan(tilt) - trim
    out[ERROR], out[SPEED] = math.hypot(off[0, 0], off[0, 1]), math.hypot(off[1, 0], off[1, 1])


@compiled_kernel
def _fly(path: Array, samples: Samples, sample: int, descent: Descent, out: Array) -> None:
    """Write into `out` (6,) how the descent of one sample ends over a vehicle that drives `path`.

    Its time is without the stop and the new start that a wait takes, as long again.
    """
    course, drone, rules = descent.course, descent.drone, descent.rules
    steps = len(course.speed_m_s)
    before, late = len(path) - steps, samples.delay_s[sample] / DT_S
    model, state = course.model.copy(), samples.deviation[sample].copy()
    known, off, expected, lean = np.zeros((3, 2)), np.empty((2, 2)), np.empty(2), np.empty(2)
    before_m_s2, held, waited = np.empty(2), course.air_enu_m_s2 + state[3], 0
    holds, beside = np.empty(2), np.empty(2)
    # By another sample's numbers than those of its gusts, and so independent of them.
    error, others = path[0, :2].copy(), samples.pushes[sample - 1]
    left = math.exp(-drone.relearns_hz * DT_S)
    for k in range(steps):
        seen = max(before + k - late, 0.0)
        cx, cy = course.direction[k, 0], course.direction[k, 1]
        slow = believe(path, int(seen), (-cy, cx), drone, known)
        know(path[int(seen)], error, slow, (before + k - seen) * DT_S, known)
        relearn(error, others[k], left, drone.error_std_m_s)
        height_m, sink_m_s = course.way_down[0, k - waited], -course.way_down[1, k - waited]
        expected[0] = course.along_m_s2[k] * cx - course.left_m_s2[k] * cy
        expected[1] = course.along_m_s2[k] * cy + course.left_m_s2[k] * cx
        for i in range(2):
            off[0, i] = model[0, i] + state[0, i] - known[0, i]
            off[1, i] = model[1, i] + state[1, i] - known[1, i]
            lean[i] = expected[i] + state[2, i] + held[i]
            held[i] -= drone.forgets_hz * state[3, i] * DT_S
            holds[i] = held[i] - drone.damping_per_s * state[1, i] - drone.stiffness_per_s2 * state[0, i]
        if _waits(off, height_m, rules):
            waited += 1
        if waited * DT_S > rules.waits_max_s or _breaks_off(off, height_m, sink_m_s, rules):
            return
        lowest_m = rules.foot_radius_m * min(math.hypot(lean[0], lean[1]) / GRAVITY_M_S2, 1.0)
        if height_m - samples.vertical[sample, 0] - lowest_m <= 0.0:
            out[IN_S] = k * DT_S
            off += known[:2] - path[before + k, :2] - course.shake_enu[:, k] - samples.deck[sample, 1:]
            lean += GRAVITY_M_S2 * (course.slope[k] + samples.deck[sample, 0])
            _touch(off, lean, sink_m_s + samples.vertical[sample, 1], course.air_enu_m_s2, out)
            return
        beside[:] = holds + GRAVITY_M_S2 * course.slope[_contact_at(k, height_m, sink_m_s, steps)]
        leans = expected + model[2] + beside
        levels = _levels(height_m - lowest_m, sink_m_s, math.hypot(leans[0], leans[1]), drone)
        most_m_s2 = drone.level_m_s2 if levels else drone.level_m_s2 + GRAVITY_M_S2  # more than any plan leans
        before_m_s2[:] = model[2]
        bounds = (drone.jerk_max_m_s3, drone.acceleration_max_m_s2, most_m_s2)
        jerk = steer(model, state, off, known, drone) if k * DT_S >= samples.ahead_s[sample] else (0.0, 0.0)
        plan(model, jerk, expected, beside if levels else holds, bounds)
        follow(state, before_m_s2, model[2], samples.pushes[sample, k], drone)


@compiled_kernel
def roll_out(samples: Samples, descent: Descent, age_s: float) -> Array:
    """Return how the descent ends in each sample, (n, 6), zeros where it does not come to a contact.

    Args:
        samples: what differs.
        descent: what does not.
        age_s: of the newest datum.
    """
    before = int(age_s / DT_S + 0.5)
    out = np.zeros((len(samples.delay_s), 6))
    for sample in range(len(out)):
        path = drive(samples, sample, descent.course, before)
        _fly(path, samples, sample, descent, out[sample])
    return out
