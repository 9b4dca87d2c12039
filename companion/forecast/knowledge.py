"""What a drone knows of the vehicle that a sample of a rollout drives; compiled.

It is `delay` older, but for the error of the estimate: that of its place stays, and that of its velocity becomes
another one, as likely, with each velocity that the filter learns. A change of its acceleration is believed with the
filter's lag, and what is known is carried on to the present with it. Where no sensor tells how the vehicle turns, its
antenna does, which passes T after the pad: to the side it drives with v - T a. When a bend begins or ends, one that
trails moves the wrong way, and v is off by T (a - a believed) until a is known.
"""

import math

from companion.core.data import Array
from companion.forecast.compiled import compiled_kernel
from companion.forecast.samples import DT_S, Follower


@compiled_kernel
def relearn(error: Array, numbers: Array, left: float, std_m_s: float) -> None:
    """Move the error (2, 2) of place and velocity by one step, with standard normal `numbers` (2,).

    Of the velocity's there is a share `left`; the rest is made up for by what is new, so that its deviation stays.
    """
    new_m_s = std_m_s * math.sqrt(1.0 - left * left)
    error[1, 0], error[1, 1] = left * error[1, 0] + new_m_s * numbers[0], left * error[1, 1] + new_m_s * numbers[1]


@compiled_kernel
def believe(path: Array, at: int, left: tuple[float, float], drone: Follower, known: Array) -> tuple[float, float]:
    """Move the acceleration that is known by one step, and return by how much the vehicle is taken to drive too slowly.

    Args:
        path: (b + m, 3, 2) of the vehicle.
        at: where on it the vehicle was of which the newest datum tells.
        left: unit vector to the vehicle's left.
        drone: with how what is new is believed.
        known: (3, 2) of the step before.
    """
    before, now = path[max(at - 1, 0)], path[at]
    turned = (now[2, 0] - before[2, 0]) * left[0] + (now[2, 1] - before[2, 1]) * left[1]
    shown = drone.trails_s * turned / DT_S  # by which the antenna's acceleration is less
    share = min(DT_S / drone.believes_s, 1.0)
    for i in range(2):
        known[2, i] += (now[2, i] - shown * left[i] - known[2, i]) * share
    off = (now[2, 0] - known[2, 0]) * left[0] + (now[2, 1] - known[2, 1]) * left[1]
    return drone.trails_s * off * left[0], drone.trails_s * off * left[1]


@compiled_kernel
def know(seen: Array, error: Array, slow: tuple[float, float], delay_s: float, known: Array) -> None:
    """Write into `known` (3, 2) what is known of a vehicle's place and velocity off its forecast.

    Args:
        seen: (3, 2) the vehicle `delay_s` ago.
        error: (2, 2) by which its place and velocity were more than the estimate's then.
        slow: by which it is taken to drive too slowly, as `believe` returns it.
        delay_s: since then.
        known: with the acceleration.
    """
    for i in range(2):
        rate = seen[1, i] - error[1, i] - slow[i]
        known[1, i] = rate + known[2, i] * delay_s
        known[0, i] = seen[0, i] - error[0, i] + (rate + 0.5 * known[2, i] * delay_s) * delay_s
