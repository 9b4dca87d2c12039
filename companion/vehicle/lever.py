"""Where the end of a lever arm is, and how fast it goes, on a vehicle that turns, climbs and tilts; compiled."""

import math

import numpy as np

from companion.core.data import Array
from companion.vehicle.angle import short_way_round
from companion.vehicle.compiled import compiled_kernel


@compiled_kernel
def turned(forward: float, left: float, yaw_rad: float) -> tuple[float, float]:
    """Return what is horizontal in V, turned by the heading into W: east and north."""
    c, s = math.cos(yaw_rad), math.sin(yaw_rad)
    return c * forward - s * left, s * forward + c * left


@compiled_kernel
def turned_lever(
    yaw_rad: Array, grade: Array, offset_s: Array, lever_x_m: float, lever_y_m: float
) -> tuple[Array, Array]:
    """Return a horizontal lever arm of V in W over a horizon, and its rate of change, each (n, 3).

    Args:
        yaw_rad: (n,) of V, wrapped or not; n > 1.
        grade: (n,) by which V pitches, m of height per m.
        offset_s: (n,) rising.
        lever_x_m: forward in V.
        lever_y_m: left in V.
    """
    n = len(yaw_rad)
    turn_rad, step_s = np.empty(n - 1), np.diff(offset_s)
    for i in range(n - 1):
        turn_rad[i] = short_way_round(yaw_rad[i + 1] - yaw_rad[i])
    arm, swing = np.zeros((n, 3)), np.zeros((n, 3))
    for i in range(n):
        arm[i, 0], arm[i, 1] = turned(lever_x_m, lever_y_m, yaw_rad[i])
        before, after = max(i - 1, 0), min(i, n - 2)
        # of second order within, where the slopes to both sides are weighed by each other's step
        share = step_s[before] / (step_s[before] + step_s[after])
        rate = (1.0 - share) * turn_rad[before] / step_s[before] + share * turn_rad[after] / step_s[after]
        swing[i, 0], swing[i, 1] = -rate * arm[i, 1], rate * arm[i, 0]
        arm[i, 2], swing[i, 2] = lever_x_m * grade[i], lever_x_m * slope_at(i, grade, step_s)
    return arm, swing


@compiled_kernel
def tilted_arm(x_m: float, y_m: float, z_m: float, roll_rad: float, pitch_rad: float) -> tuple[Array, Array]:
    """Return by how much roll, then pitch move the end of an arm in V untilted (3,), m, and the Jacobian (3, 2).

    To the second order: a ship's tilt of 3 degrees shortens an arm of 15 m by 2 cm, always in the same sense, which is
    more than sightings leave unknown after seconds.
    """
    moved, by_tilt = np.empty(3), np.empty((3, 2))
    moved[0] = pitch_rad * (z_m + roll_rad * y_m - 0.5 * pitch_rad * x_m)
    moved[1] = -roll_rad * (z_m + 0.5 * roll_rad * y_m)
    moved[2] = roll_rad * y_m - pitch_rad * x_m - 0.5 * (roll_rad**2 + pitch_rad**2) * z_m
    by_tilt[0, 0], by_tilt[0, 1] = pitch_rad * y_m, z_m + roll_rad * y_m - pitch_rad * x_m
    by_tilt[1, 0], by_tilt[1, 1] = -z_m - roll_rad * y_m, 0.0
    by_tilt[2, 0], by_tilt[2, 1] = y_m - roll_rad * z_m, -x_m - pitch_rad * z_m
    return moved, by_tilt


@compiled_kernel
def tilted_lever(
    yaw_rad: Array, tilt: Array, lever_x_m: float, lever_y_m: float, lever_z_m: float
) -> tuple[Array, Array]:
    """Return by how much a tilt moves the end of a lever arm in W, and how fast, each (n, 3).

    Args:
        yaw_rad: (n,) of V.
        tilt: (n, 4) roll and its rate, pitch and its rate, rad and rad/s.
        lever_x_m: forward in V.
        lever_y_m: left in V.
        lever_z_m: upwards.
    """
    n = len(yaw_rad)
    moved, rate = np.empty((n, 3)), np.empty((n, 3))
    for i in range(n):
        place, by_tilt = tilted_arm(lever_x_m, lever_y_m, lever_z_m, tilt[i, 0], tilt[i, 2])
        change = by_tilt[:, 0] * tilt[i, 1] + by_tilt[:, 1] * tilt[i, 3]
        for out, (forward, left, up) in ((moved, place), (rate, change)):
            out[i, 0], out[i, 1] = turned(forward, left, yaw_rad[i])
            out[i, 2] = up
    return moved, rate


@compiled_kernel
def yaw_rate(yaw_rad: Array, offset_s: Array) -> Array:
    """Return how fast a heading turns, rad/s, (n,), the short way round from each instant to the next.

    Args:
        yaw_rad: (n,) wrapped or not; n > 1.
        offset_s: (n,) rising.
    """
    n = len(yaw_rad)
    unwrapped, step_s, rate = yaw_rad.copy(), np.diff(offset_s), np.empty(n)
    for i in range(1, n):
        turns = math.floor((yaw_rad[i] - unwrapped[i - 1] + math.pi) / (2.0 * math.pi))
        unwrapped[i] = yaw_rad[i] - 2.0 * math.pi * turns
    for i in range(n):
        rate[i] = slope_at(i, unwrapped, step_s)
    return rate


@compiled_kernel
def slope_at(i: int, values: Array, step_s: Array) -> float:
    """Return the derivative of `values` (n,) at the `i`-th of them, of second order within (numpy's `gradient`).

    Args:
        i: from 0.
        values: at n instants.
        step_s: (n - 1,) between these.
    """
    if i in (0, len(step_s)):
        last = max(i - 1, 0)
        return float((values[last + 1] - values[last]) / step_s[last])
    before, after = step_s[i - 1], step_s[i]
    back, ahead = -after / (before * (before + after)), before / (after * (before + after))
    return float(back * values[i - 1] + (after - before) / (before * after) * values[i] + ahead * values[i + 1])
