"""How the drone of a sample of a rollout steers and follows; compiled.

Its virtual model follows what is known of the vehicle as the planner does near its target: within jerk and
acceleration, on the way of least jerk that ends there at rest after the planner's shortest time W, or a longer one that
takes no more jerk than there is; it is laid anew all the time,

    j = 60 / W^3 (p - e) + 36 / W^2 (v - e') + 9 / W (a - s'')

and the drone follows the model by its autopilot's cascade (`autopilots.response`), whose deviation gusts move. The
planner foresees that deviation, so e' is the velocity once the drone leans as the model accelerates. It leans
for the pad's acceleration, by the cascade's a, and by what its integrator holds against the air: i' = -u / T, where
a + i is what it is seen to lean against the air while it is pushed steadily, so that i = air + u at first.
"""

import math

from companion.core.data import Array
from companion.forecast.compiled import compiled_kernel
from companion.forecast.samples import DT_S, Follower

_LONGER, _LONGER_WAYS = 1.2, 7  # a way is tried by steps of a fifth, up to three times as long


@compiled_kernel
def steer(model: Array, state: Array, off: Array, known: Array, drone: Follower) -> tuple[float, float]:
    """Return the jerk, east and north, by which the drone comes over what is known of the pad, by the shortest way.

    Args:
        model: (3, 2) the virtual model, off the pad's forecast.
        state: (4, 2) of the cascade.
        off: (2, 2) place and velocity of the drone off what is known of the pad.
        known: (3, 2) of the pad, off its forecast.
        drone: with how long a way takes.
    """
    # Axis by axis in plain numbers: in a hundred steps of each sample arrays take twice as long.
    lag_s = (1.0 - drone.led_share) / drone.turns_hz
    rate_x, rate_y = off[1, 0] + lag_s * (state[2, 0] - model[2, 0]), off[1, 1] + lag_s * (state[2, 1] - model[2, 1])
    way_s, jx, jy = drone.way_s, 0.0, 0.0
    for _ in range(_LONGER_WAYS):
        place, rate, acceleration = 60.0 / way_s**3, 36.0 / way_s**2, 9.0 / way_s
        jx = -place * off[0, 0] - rate * rate_x - acceleration * (model[2, 0] - known[2, 0])
        jy = -place * off[0, 1] - rate * rate_y - acceleration * (model[2, 1] - known[2, 1])
        if jx * jx + jy * jy <= drone.jerk_max_m_s3**2:
            break
        way_s *= _LONGER
    return jx, jy


@compiled_kernel
def lean_change(
    asked: tuple[float, float],
    before: tuple[float, float],
    beside: tuple[float, float],
    leans_max_m_s2: float,
    change_max_m_s2: float,
) -> tuple[float, float]:
    """Return by how much the acceleration of a path changes, so that its drone leans by no more than it may.

    Args:
        asked: acceleration that the path is to have.
        before: that it has.
        beside: thrust by mass that the drone leans by beside the path's acceleration.
        leans_max_m_s2: of the horizontal thrust by mass.
        change_max_m_s2: of the acceleration.
    """
    lx, ly = asked[0] + beside[0], asked[1] + beside[1]
    back = min(1.0, leans_max_m_s2 / max(math.hypot(lx, ly), 1e-9))
    jx, jy = lx * back - beside[0] - before[0], ly * back - beside[1] - before[1]
    back = min(1.0, change_max_m_s2 / max(math.hypot(jx, jy), 1e-9))
    return jx * back, jy * back


@compiled_kernel
def plan(
    model: Array, jerk: tuple[float, float], expected: Array, beside: Array, bounds: tuple[float, float, float]
) -> None:
    """Move the virtual model (3, 2) by one step with a jerk, within bounds.

    Args:
        model: off the pad's forecast.
        jerk: as `steer` returns it.
        expected: (2,) acceleration of the forecast.
        beside: (2,) thrust by mass that it leans by beside the path's acceleration.
        bounds: of the jerk (m/s^3), the acceleration, and the horizontal thrust by mass.
    """
    jerk_max_m_s3, most_m_s2, leans_m_s2 = bounds
    share = DT_S * min(1.0, jerk_max_m_s3 / max(math.hypot(jerk[0], jerk[1]), 1e-9))
    bx, by = expected[0] + model[2, 0], expected[1] + model[2, 1]
    ax, ay = bx + jerk[0] * share, by + jerk[1] * share
    back = min(1.0, most_m_s2 / max(math.hypot(ax, ay), 1e-9))
    change = lean_change((ax * back, ay * back), (bx, by), (beside[0], beside[1]), leans_m_s2, jerk_max_m_s3 * DT_S)
    model[2, 0] += change[0]
    model[2, 1] += change[1]
    for i in range(2):
        model[0, i] += (model[1, i] + 0.5 * model[2, i] * DT_S) * DT_S
        model[1, i] += model[2, i] * DT_S


@compiled_kernel
def follow(state: Array, before: Array, acceleration: Array, pushes: Array, drone: Follower) -> None:
    """Move the cascade's state (4, 2) by one step behind a model with that `acceleration` (2,), in gusts.

    Led setpoints bring the lean along with what has changed of the model's acceleration since the step `before` (2,).
    """
    push = drone.push_std_m_s2 * math.sqrt(2.0 * drone.forgets_hz * DT_S)
    turned = 1.0 - math.exp(-drone.turns_hz * DT_S)
    for i in range(2):
        state[2, i] += drone.led_share * (acceleration[i] - before[i])
        rate = state[2, i] + state[3, i] - acceleration[i]
        back = drone.damping_per_s * state[1, i] + drone.stiffness_per_s2 * state[0, i]
        wanted = drone.path_share * acceleration[i] - back
        state[2, i] += (wanted - state[2, i]) * turned
        state[3, i] -= (drone.forgets_hz * state[3, i] + drone.drag_per_s * acceleration[i]) * DT_S
        state[3, i] += push * pushes[i]
        state[1, i] += rate * DT_S
        state[0, i] += state[1, i] * DT_S
