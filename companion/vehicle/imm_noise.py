"""What drives the turning model of `imm_kernels`, compiled: noise over a step, and what fades meanwhile.

The curvature and the grade's change fade so that their standard deviations stay those of vehicles and roads.
"""

import math

import numpy as np

from companion.core.data import Array
from companion.vehicle.compiled import compiled_kernel
from companion.vehicle.imm_kernels import BEND, CLOCK, LEAK, course
from companion.vehicle.imm_swing import MOUNT, OWN_RATE, PITCH, ROLL, SIZE, UNIT_HEADING
from companion.vehicle.small_matrices import white_jerk

MOTION = 8  # leading states that the non-linear motion touches
FOLLOWS = (0, 0, 1, 1, 1, 1, 2, 1)  # each of them: 2 is the curvature, 1 its integral, 0 its second one
ALONG_NOISE, ACROSS_NOISE, RECEIVER_NOISE, OWN_NOISE = 0, 2, 6, 7
HEADING_NOISE, CLOCK_NOISE, CURVATURE_STD, HEADING_AT_REST = 4, 8, 9, 10  # their places in the noise
BEND_STD, BEND_ACCELERATION_STD, BEND_LENGTH, ROAD_NOISE, LEAK_NOISE, AFLOAT = 5, 11, 12, 13, 14, 15
OWN_RATE_NOISE, UNIT_NOISE = 16, 17


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
def process_noise(x: Array, dt_s: float, noise: Array, heave_noise: Array, tilt_noise: Array) -> Array:
    """Return Q `(26, 26)` over `dt_s`.

    Args:
        x: state (26,), whose velocity says what is along and what is across.
        dt_s: step.
        noise: (18,) jerk along and across the track, m^2/s^5; lateral acceleration, m^2/s^5; lowest speed for the
            curvature, m/s; heading, rad^2/s; standard deviation of the grade's change, 1/m; the receiver's and the
            drone's own wandering, m^2/s; clock, s^2/s; standard deviation of the curvature in the long run, rad/m;
            heading at rest, rad^2/s; standard deviation of a vertical curve's acceleration, m/s^2; its length, m;
            height of the road, m^2/m; what the accelerometer reads too much, m^2/s^5; 1 for a vehicle that heaves at
            rest, too, else 0; the rate of the drone's own height, m^2/s^3; what the unit tells of the heading too much,
            rad^2/s.
        heave_noise: (3, 3) of the heave over `dt_s`, its place first.
        tilt_noise: (2, 2, 2) of roll and pitch.
    """
    Q = np.zeros((SIZE, SIZE))
    share = min(math.hypot(x[2], x[3]) / noise[3], 1.0)  # a standing vehicle has no known "along"
    add_jerk(Q, x, dt_s, noise, share)
    add_curvature(Q, x, dt_s, noise)
    Q[7, 7] += (noise[HEADING_NOISE] * share + noise[HEADING_AT_REST] * (1.0 - share)) * dt_s
    put_road(Q, x, dt_s, noise)
    shakes = max(share, noise[AFLOAT])  # it is the road that shakes a vehicle
    Q[8, 8] += heave_noise[0, 0] * shakes
    Q[8, 10:12], Q[10:12, 8] = heave_noise[0, 1:] * shakes, heave_noise[1:, 0] * shakes
    Q[10:12, 10:12] = heave_noise[1:, 1:] * shakes
    Q[ROLL:PITCH, ROLL:PITCH], Q[PITCH:MOUNT, PITCH:MOUNT] = tilt_noise[0], tilt_noise[1]
    for place, offset in ((0, 12), (1, 13), (8, 14)):  # where the drone errs about itself, both move
        Q[place, place] += noise[OWN_NOISE] * dt_s
        Q[place, offset] = Q[offset, place] = noise[OWN_NOISE] * dt_s
        Q[offset, offset] = (noise[RECEIVER_NOISE] + noise[OWN_NOISE]) * dt_s
    Q[CLOCK, CLOCK], Q[LEAK, LEAK] = noise[CLOCK_NOISE] * dt_s, noise[LEAK_NOISE] * dt_s
    Q[OWN_RATE, OWN_RATE], Q[UNIT_HEADING, UNIT_HEADING] = noise[OWN_RATE_NOISE] * dt_s, noise[UNIT_NOISE] * dt_s
    return Q


@compiled_kernel
def add_jerk(Q: Array, x: Array, dt_s: float, noise: Array, share: float) -> None:
    """Add the jerk along the track and across it.

    Args:
        Q: (26, 26) changed.
        x: state (26,).
        dt_s: step.
        noise: as `process_noise` takes it.
        share: by which the track is known, 0 to 1.
    """
    _, ux, uy = course(x)
    if ux == 0.0 and uy == 0.0:
        ux = 1.0
    across = noise[1] * share + noise[0] * (1.0 - share)
    qxx = noise[0] * ux * ux + across * uy * uy
    qyy = noise[0] * uy * uy + across * ux * ux
    qxy = (noise[0] - across) * ux * uy
    white = white_jerk(dt_s)
    for i in range(3):
        for j in range(3):
            g = white[i][j]
            Q[2 * i, 2 * j], Q[2 * i + 1, 2 * j + 1] = g * qxx, g * qyy
            Q[2 * i, 2 * j + 1], Q[2 * i + 1, 2 * j] = g * qxy, g * qxy


@compiled_kernel
def add_curvature(Q: Array, x: Array, dt_s: float, noise: Array) -> None:
    """Add what the curvature's change within the step does to all that it has turned by its end.

    Left out, a curve that begins between two measurements leaves a velocity that nothing explains and that is held for
    certain.
    """
    speed, white = math.hypot(x[2], x[3]), white_jerk(dt_s)
    left = curvature_left(speed, dt_s, noise)
    turning = noise[CURVATURE_STD] ** 2 * (1.0 - left * left) / dt_s
    rates = (-speed * x[3], speed * x[2], -speed * x[3], speed * x[2], -speed * x[5], speed * x[4], 1.0, speed)
    for i in range(MOTION):
        for j in range(MOTION):
            Q[i, j] += turning * white[FOLLOWS[i]][FOLLOWS[j]] * rates[i] * rates[j]


@compiled_kernel
def put_road(Q: Array, x: Array, dt_s: float, noise: Array) -> None:
    """Write what the road adds to height, grade and the grade's change, with the distance driven."""
    s = forward_speed(x) * dt_s
    _, bends = bend_step(x, dt_s, noise)
    Q[8, 8], Q[9, 9], Q[BEND, BEND] = bends * s**4 / 20 + noise[ROAD_NOISE] * abs(s), bends * s**2 / 3, bends
    Q[8, 9] = Q[9, 8] = bends * s**3 / 8
    Q[8, BEND] = Q[BEND, 8] = bends * s**2 / 6
    Q[9, BEND] = Q[BEND, 9] = bends * s / 2
