"""Compiled arithmetic of the turning model: one step of motion, its noise, and the Kalman update.

State `x` (24,) of the vehicle in W:
  0:2  p   horizontal position, m: the antenna's, and the pad's while it moves (`imm_mixing.glide`)
  2:4  v   horizontal velocity of the pad's centre, m/s, where the vehicle's body follows the road
  4:6  b   what changes the velocity apart from turning, m/s^2; decays with time constant tau
  6    k   curvature of the track, rad/m, left positive
  7    psi heading of V, rad, not wrapped
  8   z    height without heave, m: the antenna's, and the pad's while it moves, as `p`
  9   g    grade of the road in the direction in which the vehicle heads, m of height per m; V pitches by it
  10:12 h  heave about the road, m, and its rate, m/s: a damped oscillator
  12:15 o  what the vehicle's receiver must be corrected by to be in the drone's frame, m
  15   c   how far the vehicle's clock is ahead of the drone's, s: what it stamps with now was true c ago
  16  e    change of the grade per metre, 1/m
  17  f    what the vehicle's accelerometer reads too much along V, m/s^2: gravity by a pitch that it does not tell, and
           its own offset (Gauss-Markov)
  18:24    roll and pitch of the body against the road, see `imm_swing`; zero until the vehicle tells them
With `w = k |v|` and J the turn by +90 degrees: `dp = v, dv = w J v + b, db = w J b - b/tau, dpsi = w`. At constant
`w` this has a closed form: in a frame that turns with the vehicle, `v` relaxes along `b` and nothing else happens.
At rest `w` is zero, so a standing vehicle cannot turn. Braking ends at standstill. The curvature is driven by the
lateral acceleration that drivers change, `q / v^4`, and fades (Ornstein-Uhlenbeck) so that its standard deviation stays
that of what a vehicle can steer: a random walk would let a vehicle that stands turn about its own antenna.
Along the distance s that is driven in the direction of the heading, `dz/ds = g, dg/ds = e`; e is driven by noise per
metre and fades over the length of a vertical curve. So height changes with the distance only: a vehicle that stands
neither climbs nor heaves, a fast one meets a grade all the sooner.
Source: constant turn rate models in Bar-Shalom, Li and Kirubarajan 2001, 11.7; curvature after Baca et al. 2019;
vertical curves of roads: AASHTO, A Policy on Geometric Design of Highways and Streets, 3.4.6.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.vehicle.compiled import compiled_kernel
from companion.vehicle.imm_swing import MOUNT, PITCH, ROLL, SIZE
from companion.vehicle.small_matrices import inverse_of, less_outer, times

MOTION = 8  # leading states that the non-linear motion touches
FOLLOWS = (0, 0, 1, 1, 1, 1, 2, 1)  # each of them: 2 is the curvature, 1 its integral, 0 its second one
CLOCK, BEND, LEAK = 15, 16, 17
HEADING_NOISE, CLOCK_NOISE, CURVATURE_STD, HEADING_AT_REST = 4, 8, 9, 10  # their places in the noise
BEND_STD, BEND_ACCELERATION_STD, BEND_LENGTH, ROAD_NOISE, LEAK_NOISE, AFLOAT = 5, 11, 12, 13, 14, 15


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
        x: state (24,) before.
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
    """Return the state `dt_s` later and its Jacobian `(24, 24)`.

    Args:
        x: state (24,).
        dt_s: step, short against a turn (0.1 s).
        tau_s: time constant of `b`.
        heave: transition (2, 2) of the heave over `dt_s`.
        tilt: transitions (2, 2, 2) of roll and pitch.
    """
    vx, vy, bx, by = x[2], x[3], x[4], x[5]
    speed = math.hypot(vx, vy)
    ux, uy = (vx / speed, vy / speed) if speed > 1e-6 else (0.0, 0.0)
    decay = math.exp(-dt_s / tau_s)
    t1 = tau_s * (1.0 - decay)
    t2 = tau_s * (dt_s - t1)
    speed_mid = max(speed + 0.5 * dt_s * (ux * bx + uy * by), 0.0)
    turn = x[6] * speed_mid * dt_s
    c, s = math.cos(turn), math.sin(turn)
    half = math.sin(0.5 * turn) / (0.5 * turn) if abs(turn) > 1e-6 else 1.0
    ch, sh = half * math.cos(0.5 * turn), half * math.sin(0.5 * turn)

    y = x.copy()
    wx, wy = vx + bx * t1, vy + by * t1
    mx, my = vx * dt_s + bx * t2, vy * dt_s + by * t2
    y[0] = x[0] + ch * mx - sh * my
    y[1] = x[1] + sh * mx + ch * my
    y[2], y[3] = c * wx - s * wy, s * wx + c * wy
    y[4], y[5] = decay * (c * bx - s * by), decay * (s * bx + c * by)
    y[7] = x[7] + turn
    y[10] = heave[0, 0] * x[10] + heave[0, 1] * x[11]
    y[11] = heave[1, 0] * x[10] + heave[1, 1] * x[11]
    y[ROLL:PITCH] = tilt[0, :, 0] * x[ROLL] + tilt[0, :, 1] * x[ROLL + 1]
    y[PITCH:MOUNT] = tilt[1, :, 0] * x[PITCH] + tilt[1, :, 1] * x[PITCH + 1]

    F = np.eye(SIZE)
    F[0, 2], F[0, 3], F[1, 2], F[1, 3] = ch * dt_s, -sh * dt_s, sh * dt_s, ch * dt_s
    F[0, 4], F[0, 5], F[1, 4], F[1, 5] = ch * t2, -sh * t2, sh * t2, ch * t2
    F[2, 2], F[2, 3], F[3, 2], F[3, 3] = c, -s, s, c
    F[2, 4], F[2, 5], F[3, 4], F[3, 5] = c * t1, -s * t1, s * t1, c * t1
    F[4, 4], F[4, 5], F[5, 4], F[5, 5] = decay * c, -decay * s, decay * s, decay * c
    d_turn = np.array([-0.5 * (y[1] - x[1]), 0.5 * (y[0] - x[0]), -y[3], y[2], -y[5], y[4]])
    by_speed = x[6] * dt_s
    for i in range(6):
        F[i, 2] += d_turn[i] * by_speed * ux
        F[i, 3] += d_turn[i] * by_speed * uy
        F[i, 6] = d_turn[i] * speed_mid * dt_s
    F[7, 2], F[7, 3], F[7, 6] = by_speed * ux, by_speed * uy, speed_mid * dt_s
    F[10:12, 10:12] = heave
    F[ROLL:PITCH, ROLL:PITCH], F[PITCH:MOUNT, PITCH:MOUNT] = tilt[0], tilt[1]

    stop_s = standstill_s(x[2:4], x[4:6], tau_s, dt_s)
    if stop_s >= 0.0:
        stop_t2 = tau_s * (stop_s - tau_s * (1.0 - math.exp(-stop_s / tau_s)))
        rolls = speed * stop_s + (ux * bx + uy * by) * stop_t2
        y[0], y[1] = x[0] + rolls * ux, x[1] + rolls * uy
        y[2:6] = 0.0
        y[7] = x[7] + x[6] * rolls
        climb(x, y, F, stop_s, stop_t2)
    else:
        climb(x, y, F, dt_s, t2)
    return y, F


@compiled_kernel
def curvature_left(speed_m_s: float, dt_s: float, noise: Array) -> float:
    """Return which share of the curvature is left after `dt_s`, with `noise` as `process_noise` takes it."""
    psd = noise[2] / max(speed_m_s, noise[3]) ** 4
    return math.exp(-0.5 * psd * dt_s / noise[CURVATURE_STD] ** 2)


@compiled_kernel
def forward_speed(x: Array) -> float:
    """Return the speed in the direction of the heading, m/s."""
    return float(math.cos(x[7]) * x[2] + math.sin(x[7]) * x[3])


@compiled_kernel
def bend_step(x: Array, dt_s: float, noise: Array) -> tuple[float, float]:
    """Return which share of the grade's change per metre is left after `dt_s`, and the variance that its noise adds.

    Nobody drives over a crest much faster than comfort allows, so the change is bounded by its acceleration, too.
    """
    speed = abs(forward_speed(x))
    left = math.exp(-speed * dt_s / noise[BEND_LENGTH])
    std = min(noise[BEND_STD], noise[BEND_ACCELERATION_STD] / max(speed, 0.1) ** 2)
    return left, std**2 * (1.0 - left * left)


@compiled_kernel
def heave_step(dt_s: float, frequency_rad_s: float, damping: float, std_m: float) -> tuple[Array, Array]:
    """Return transition and noise, each (2, 2), of a damped oscillator driven by white noise to a steady `std_m`."""
    damped = frequency_rad_s * math.sqrt(1.0 - damping**2)
    fade = math.exp(-damping * frequency_rad_s * dt_s)
    c, s = math.cos(damped * dt_s), math.sin(damped * dt_s)
    ratio = damping * frequency_rad_s / damped
    A = np.empty((2, 2))
    A[0, 0], A[0, 1] = fade * (c + ratio * s), fade * (s / damped)
    A[1, 0], A[1, 1] = fade * (-(frequency_rad_s**2) / damped * s), fade * (c - ratio * s)
    place, rate = std_m**2, (std_m * frequency_rad_s) ** 2
    noise = np.empty((2, 2))
    noise[0, 0] = place - (A[0, 0] * place * A[0, 0] + A[0, 1] * rate * A[0, 1])
    noise[1, 1] = rate - (A[1, 0] * place * A[1, 0] + A[1, 1] * rate * A[1, 1])
    noise[0, 1] = noise[1, 0] = -(A[0, 0] * place * A[1, 0] + A[0, 1] * rate * A[1, 1])
    return A, noise


@compiled_kernel
def process_noise(x: Array, dt_s: float, noise: Array, heave_noise: Array, tilt_noise: Array) -> Array:
    """Return Q `(24, 24)` over `dt_s`.

    Args:
        x: state (24,), whose velocity says what is along and what is across.
        dt_s: step.
        noise: (16,) jerk along and across the track, m^2/s^5; lateral acceleration, m^2/s^5; lowest speed for the
            curvature, m/s; heading, rad^2/s; standard deviation of the grade's change, 1/m; the receiver's and the
            drone's own wandering, m^2/s; clock, s^2/s; standard deviation of the curvature in the long run, rad/m;
            heading at rest, rad^2/s; standard deviation of a vertical curve's acceleration, m/s^2; its length, m;
            height of the road, m^2/m; what the accelerometer reads too much, m^2/s^5; 1 for a vehicle that heaves at
            rest, too, else 0.
        heave_noise: (2, 2) of the heave over `dt_s`.
        tilt_noise: (2, 2, 2) of roll and pitch.
    """
    Q = np.zeros((SIZE, SIZE))
    speed = math.hypot(x[2], x[3])
    share = min(speed / noise[3], 1.0)  # a standing vehicle has no known "along"
    ux, uy = (x[2] / speed, x[3] / speed) if speed > 1e-6 else (1.0, 0.0)
    across = noise[1] * share + noise[0] * (1.0 - share)
    qxx = noise[0] * ux * ux + across * uy * uy
    qyy = noise[0] * uy * uy + across * ux * ux
    qxy = (noise[0] - across) * ux * uy
    d = dt_s
    white_jerk = ((d**5 / 20, d**4 / 8, d**3 / 6), (d**4 / 8, d**3 / 3, d**2 / 2), (d**3 / 6, d**2 / 2, d))
    for i in range(3):
        for j in range(3):
            g = white_jerk[i][j]
            Q[2 * i, 2 * j], Q[2 * i + 1, 2 * j + 1] = g * qxx, g * qyy
            Q[2 * i, 2 * j + 1], Q[2 * i + 1, 2 * j] = g * qxy, g * qxy
    # What the curvature does within the step has turned velocity and heading by its end: left out, a curve that begins
    # between two measurements leaves a velocity that nothing explains and that is held for certain.
    left = curvature_left(speed, d, noise)
    turning = noise[CURVATURE_STD] ** 2 * (1.0 - left * left) / d
    rates = (-speed * x[3], speed * x[2], -speed * x[3], speed * x[2], -speed * x[5], speed * x[4], 1.0, speed)
    for i in range(MOTION):
        for j in range(MOTION):
            Q[i, j] += turning * white_jerk[FOLLOWS[i]][FOLLOWS[j]] * rates[i] * rates[j]
    Q[7, 7] += (noise[HEADING_NOISE] * share + noise[HEADING_AT_REST] * (1.0 - share)) * d
    s = forward_speed(x) * d
    _, bends = bend_step(x, d, noise)
    Q[8, 8], Q[9, 9], Q[BEND, BEND] = bends * s**4 / 20 + noise[ROAD_NOISE] * abs(s), bends * s**2 / 3, bends
    Q[8, 9] = Q[9, 8] = bends * s**3 / 8
    Q[8, BEND] = Q[BEND, 8] = bends * s**2 / 6
    Q[9, BEND] = Q[BEND, 9] = bends * s / 2
    Q[10:12, 10:12] = heave_noise * max(share, noise[AFLOAT])  # it is the road that shakes a vehicle
    Q[ROLL:PITCH, ROLL:PITCH], Q[PITCH:MOUNT, PITCH:MOUNT] = tilt_noise[0], tilt_noise[1]
    for place, offset in ((0, 12), (1, 13), (8, 14)):  # where the drone errs about itself, both move
        Q[place, place] += noise[7] * d
        Q[place, offset] = Q[offset, place] = noise[7] * d
        Q[offset, offset] = (noise[6] + noise[7]) * d
    Q[CLOCK, CLOCK], Q[LEAK, LEAK] = noise[CLOCK_NOISE] * d, noise[LEAK_NOISE] * d
    return Q


@compiled_kernel
def correct(x: Array, P: Array, residual: Array, H: Array, R: Array) -> tuple[Array, Array, float, float]:
    """Return mean, covariance, NIS and log-likelihood after a measurement.

    The covariance is Joseph's form `(1 - KH) P (1 - KH)' + KRK'`, multiplied out in an order that has m rows only.

    Args:
        x: mean (n,).
        P: covariance (n, n).
        residual: measured minus expected (m,).
        H: Jacobian (m, n).
        R: covariance of the measurement (m, m).
    """
    HP = times(H, P)
    inverse, log_determinant = inverse_of(times(H, HP.T) + R)
    K = times(inverse, HP)  # transposed, (m, n)
    nis = 0.0
    for i in range(len(residual)):
        for j in range(len(residual)):
            nis += residual[i] * inverse[i, j] * residual[j]
    kept = less_outer(P, K, HP)
    joseph = less_outer(kept, times(H, kept.T) - times(R, K), K)
    log_likelihood = -0.5 * (nis + log_determinant + len(residual) * math.log(2.0 * math.pi))
    y = x.copy()
    for i in range(len(residual)):
        y += residual[i] * K[i]
    return y, 0.5 * (joseph + joseph.T), nis, log_likelihood
