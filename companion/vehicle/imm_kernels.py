"""Compiled arithmetic of the turning model: one step of motion. Its noise is in `imm_noise`.

State `x` (26,) of the vehicle in W:
  0:2  p   horizontal position, m: the antenna's, and the pad's while it moves (`imm_mixing.glide`)
  2:4  v   horizontal velocity of the pad's centre, m/s, where the vehicle's body follows the road
  4:6  b   what changes the velocity apart from turning, m/s^2; decays with time constant tau
  6    k   curvature of the track, rad/m, left positive
  7    psi heading of V, rad, not wrapped
  8   z    height, m: the antenna's, and the pad's while it moves, as `p`
  9   g    grade of the road in the direction in which the vehicle heads, m of height per m; V pitches by it
  10:12 h  rate of the heave, m/s, and its change, m/s^2: a damped oscillator
  12:15 o  what the vehicle's receiver must be corrected by to be in the drone's frame, m
  15   c   how far the vehicle's clock is ahead of the drone's, s: what it stamps with now was true c ago
  16  e    change of the grade per metre, 1/m
  17  f    what the vehicle's accelerometer reads too much along V, m/s^2: gravity by a pitch that it does not tell, and
           its own offset (Gauss-Markov)
  18:24    roll and pitch of the body against the road, see `imm_swing`; zero until the vehicle tells them
  24  d    how fast the drone's own height, and with it all of W, comes to be too high, m/s (Gauss-Markov)
  25  m    what the vehicle's unit tells of the heading too much, rad (Gauss-Markov)
With `w = k |v|` and J the turn by +90 degrees: `dp = v, dv = w J v + b, db = w J b - b/tau, dpsi = w`. At constant
`w` this has a closed form: in a frame that turns with the vehicle, `v` relaxes along `b` and nothing else happens.
At rest `w` is zero, so a standing vehicle turns by `imm_spin` alone. Braking ends at standstill. The curvature is
driven by the lateral acceleration that drivers change, `q / v^4`, and fades (Ornstein-Uhlenbeck) so that its standard
deviation stays that of what a vehicle can steer: a random walk would let a vehicle that stands turn about its own
antenna.
Along the distance s that is driven in the direction of the heading, `dz/ds = g, dg/ds = e`; e is driven by noise per
metre and fades over the length of a vertical curve. So height changes with the distance only: a vehicle that stands
neither climbs nor heaves, a fast one meets a grade all the sooner.
It is the heave's rate that swings about zero, w'' + 2 d f w' + f^2 w = noise, and moves z. An oscillator of its place
would tie the acceleration to a mean height that two or three waves do not tell, and would drive the rate by white
noise, which no mass follows: seas and bodies on wheels are smoother.
Source: constant turn rate models in Bar-Shalom, Li and Kirubarajan 2001, 11.7; curvature after Baca et al. 2019;
vertical curves of roads: AASHTO, A Policy on Geometric Design of Highways and Streets, 3.4.6.
"""

import math
from typing import NamedTuple

import numpy as np

from companion.core.data import Array
from companion.vehicle.compiled import compiled_kernel
from companion.vehicle.imm_swing import MOUNT, OWN_RATE, PITCH, ROLL, SIZE

CURVATURE, HEADING, CLOCK, BEND, LEAK = 6, 7, 15, 16, 17
UNKNOWN_HEADING_VARIANCE = math.pi**2 / 3.0  # of an angle that may be anything


class Turn(NamedTuple):
    """How the vehicle turns and relaxes within a step.

    Attributes:
        ux: east of its course at first, as a unit vector; 0 at rest.
        uy: north of it.
        speed_m_s: in the middle of the step.
        angle_rad: by which it turns.
        c: cosine of that angle.
        s: its sine.
        mean_c: the cosine's mean over the step.
        mean_s: the sine's.
        left: share of `b` that is left.
        by_b_s: what `b` adds to the velocity.
        by_b_s2: what it adds to the place.
    """

    ux: float
    uy: float
    speed_m_s: float
    angle_rad: float
    c: float
    s: float
    mean_c: float
    mean_s: float
    left: float
    by_b_s: float
    by_b_s2: float


@compiled_kernel
def course(x: Array) -> tuple[float, float, float]:
    """Return the horizontal speed, m/s, and its direction as a unit vector, (0, 0) at rest."""
    speed = math.hypot(x[2], x[3])
    return (speed, x[2] / speed, x[3] / speed) if speed > 1e-6 else (speed, 0.0, 0.0)


@compiled_kernel
def turn_over(x: Array, dt_s: float, tau_s: float) -> Turn:
    """Return how the vehicle turns and relaxes within `dt_s`."""
    speed, ux, uy = course(x)
    left = math.exp(-dt_s / tau_s)
    by_b_s = tau_s * (1.0 - left)
    by_b_s2 = tau_s * (dt_s - by_b_s)
    speed_m_s = max(speed + 0.5 * dt_s * (ux * x[4] + uy * x[5]), 0.0)
    turn = x[6] * speed_m_s * dt_s
    half = math.sin(0.5 * turn) / (0.5 * turn) if abs(turn) > 1e-6 else 1.0
    mean_c, mean_s = half * math.cos(0.5 * turn), half * math.sin(0.5 * turn)
    return Turn(ux, uy, speed_m_s, turn, math.cos(turn), math.sin(turn), mean_c, mean_s, left, by_b_s, by_b_s2)


@compiled_kernel
def standstill_s(v: Array, b: Array, tau_s: float, dt_s: float) -> float:
    """Return when, within `dt_s`, braking has used up the speed; a negative time if it does not."""
    speed2 = v[0] * v[0] + v[1] * v[1]
    braking = -(v[0] * b[0] + v[1] * b[1])
    relaxed = tau_s * (1.0 - math.exp(-dt_s / tau_s))
    if braking <= 0.0 or braking * relaxed < speed2:
        return -1.0
    return -tau_s * math.log(max(1.0 - speed2 / (braking * tau_s), 1e-12))


@compiled_kernel
def climb(x: Array, y: Array, F: Array, by_v_s: float, by_b_s2: float) -> None:
    """Write height and grade into `y`, and their rows into `F`, after a drive from `x`.

    Args:
        x: state (26,) before.
        y: the state afterwards, under way.
        F: its Jacobian, under way.
        by_v_s: what the velocity adds to the place, s.
        by_b_s2: what the acceleration adds to it, s^2.
    """
    hx, hy = math.cos(x[7]), math.sin(x[7])
    forward, pull = hx * x[2] + hy * x[3], hx * x[4] + hy * x[5]
    aside = by_v_s * (hx * x[3] - hy * x[2]) + by_b_s2 * (hx * x[5] - hy * x[4])
    along = forward * by_v_s + pull * by_b_s2
    y[8] = x[8] + (x[9] + 0.5 * x[BEND] * along) * along
    y[9] = x[9] + x[BEND] * along
    F[8, 9], F[8, BEND], F[9, BEND] = along, 0.5 * along**2, along
    for row, change in ((8, y[9]), (9, x[BEND])):
        F[row, 2], F[row, 3] = change * by_v_s * hx, change * by_v_s * hy
        F[row, 4], F[row, 5] = change * by_b_s2 * hx, change * by_b_s2 * hy
        F[row, 7] = change * aside


@compiled_kernel
def advance(x: Array, dt_s: float, tau_s: float, heave: Array, tilt: Array) -> tuple[Array, Array]:
    """Return the state `dt_s` later and its Jacobian `(26, 26)`.

    Args:
        x: state (26,).
        dt_s: step, short against a turn (0.1 s).
        tau_s: time constant of `b`.
        heave: transition (3, 3) of height, rate and acceleration of the heave over `dt_s`.
        tilt: transitions (2, 2, 2) of roll and pitch.
    """
    t = turn_over(x, dt_s, tau_s)
    vx, vy, bx, by = x[2], x[3], x[4], x[5]
    y = x.copy()
    wx, wy = vx + bx * t.by_b_s, vy + by * t.by_b_s
    mx, my = vx * dt_s + bx * t.by_b_s2, vy * dt_s + by * t.by_b_s2
    y[0] = x[0] + t.mean_c * mx - t.mean_s * my
    y[1] = x[1] + t.mean_s * mx + t.mean_c * my
    y[2], y[3] = t.c * wx - t.s * wy, t.s * wx + t.c * wy
    y[4], y[5] = t.left * (t.c * bx - t.s * by), t.left * (t.s * bx + t.c * by)
    y[7] = x[7] + t.angle_rad
    y[10] = heave[1, 1] * x[10] + heave[1, 2] * x[11]
    y[11] = heave[2, 1] * x[10] + heave[2, 2] * x[11]
    y[ROLL:PITCH] = tilt[0, :, 0] * x[ROLL] + tilt[0, :, 1] * x[ROLL + 1]
    y[PITCH:MOUNT] = tilt[1, :, 0] * x[PITCH] + tilt[1, :, 1] * x[PITCH + 1]
    F = np.eye(SIZE)
    put_turn(F, x, y, dt_s, t)
    F[8, 10:12], F[10:12, 10:12] = heave[0, 1:], heave[1:, 1:]
    F[ROLL:PITCH, ROLL:PITCH], F[PITCH:MOUNT, PITCH:MOUNT] = tilt[0], tilt[1]
    stop_s = standstill_s(x[2:4], x[4:6], tau_s, dt_s)
    if stop_s >= 0.0:
        halt(x, y, F, tau_s, stop_s)
    else:
        climb(x, y, F, dt_s, t.by_b_s2)
    y[8] += heave[0, 1] * x[10] + heave[0, 2] * x[11] + dt_s * x[OWN_RATE]
    y[14] += dt_s * x[OWN_RATE]
    F[8, OWN_RATE], F[14, OWN_RATE] = dt_s, dt_s
    return y, F


@compiled_kernel
def put_turn(F: Array, x: Array, y: Array, dt_s: float, t: Turn) -> None:
    """Write the rows of place, velocity, acceleration and heading into the Jacobian.

    Args:
        F: the Jacobian (26, 26), the identity in these rows.
        x: state (26,) before.
        y: the state afterwards, as if nothing stopped.
        dt_s: step.
        t: the turn within it.
    """
    c, s, ch, sh = t.c, t.s, t.mean_c, t.mean_s
    F[0, 2], F[0, 3], F[1, 2], F[1, 3] = ch * dt_s, -sh * dt_s, sh * dt_s, ch * dt_s
    F[0, 4], F[0, 5], F[1, 4], F[1, 5] = ch * t.by_b_s2, -sh * t.by_b_s2, sh * t.by_b_s2, ch * t.by_b_s2
    F[2, 2], F[2, 3], F[3, 2], F[3, 3] = c, -s, s, c
    F[2, 4], F[2, 5], F[3, 4], F[3, 5] = c * t.by_b_s, -s * t.by_b_s, s * t.by_b_s, c * t.by_b_s
    F[4, 4], F[4, 5], F[5, 4], F[5, 5] = t.left * c, -t.left * s, t.left * s, t.left * c
    d_turn = np.array([-0.5 * (y[1] - x[1]), 0.5 * (y[0] - x[0]), -y[3], y[2], -y[5], y[4]])
    by_speed = x[6] * dt_s
    for i in range(6):
        F[i, 2] += d_turn[i] * by_speed * t.ux
        F[i, 3] += d_turn[i] * by_speed * t.uy
        F[i, 6] = d_turn[i] * t.speed_m_s * dt_s
    F[7, 2], F[7, 3], F[7, 6] = by_speed * t.ux, by_speed * t.uy, t.speed_m_s * dt_s


@compiled_kernel
def halt(x: Array, y: Array, F: Array, tau_s: float, stop_s: float) -> None:
    """Write the state of a vehicle that stands after `stop_s` of braking into `y`, and its height's rows into `F`.

    Args:
        x: state (26,) before.
        y: the state afterwards, as if nothing stopped.
        F: its Jacobian.
        tau_s: time constant of `b`.
        stop_s: until it stands.
    """
    speed, ux, uy = course(x)
    by_b_s2 = tau_s * (stop_s - tau_s * (1.0 - math.exp(-stop_s / tau_s)))
    rolls = speed * stop_s + (ux * x[4] + uy * x[5]) * by_b_s2
    y[0], y[1] = x[0] + rolls * ux, x[1] + rolls * uy
    y[2:6] = 0.0
    y[7] = x[7] + x[6] * rolls
    climb(x, y, F, stop_s, by_b_s2)
