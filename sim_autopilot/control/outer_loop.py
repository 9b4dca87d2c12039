"""From a reference to the specific force that the rotors shall give: shared by the controllers with feed-forward.

`a = a_ref + kv (v_ref + c(p_ref - p) - v) - d`, with c the correction velocity: k = kp / kv times the error, never
faster than can still be braked (`sqrt(2 b (e - b / 2k^2))` beyond e = b / k^2) nor than the envelope allows. The whole
correction is bounded, so that a step asks for no more tilt than the torques can follow.

d is the disturbance (wind, drag, wrong mass) seen by an observer of the velocity with both poles at -w_o:
`v^' = a_model + d + 2 w_o (v - v^)`, `d' = w_o^2 (v - v^)`, a_model from the present attitude and rotor speeds. It is
the integral action: without a disturbance it is zero whatever the reference does, so it neither overshoots nor winds up
against a limit.
"""

import math

from link.compiled import kernel
from sim_autopilot.control.parameters import (
    DISTURBANCE,
    HAS_ACCELERATION,
    HAS_POSITION,
    HAS_VELOCITY,
    HAS_YAW,
    HEADING,
    MISSED,
    PLACE,
    VELOCITY,
    YAW,
    YAW_RATE,
)
from sim_autopilot.core.data import Array
from sim_autopilot.physics.airframe import GRAVITY_M_S2
from sim_autopilot.physics.parameters import Record
from sim_autopilot.physics.rotation import wrapped

DISTURBANCE_MAX_M_S2 = 8.0
"""More than the drag at 40 m/s of airspeed (6.6 m/s2)."""
CORRECTION_MAX_M_S2 = 5.0
"""Horizontal, 27 degrees of tilt: the benchmark's motors turn the airframe so far in 0.25 s."""
VERTICAL_CORRECTION_MAX_M_S2 = 3.0
"""Leaves the rotors the thrust to turn with, also while sinking; beside this a correction may undo what is fed forward,
or a drone whose setpoints stop coming would go on falling with the acceleration of the last."""
VERTICAL_BRAKING_M_S2 = 2.0
"""Less than that, so that braking can still be corrected."""
HEADING_SLOPE_PER_S = 4.0
HEADING_BRAKING_RAD_S2 = 2.5
"""How the commanded heading nears its goal; the propellers' drag gives 7 rad/s2 in hover."""
STEADYING_S = 0.4
"""Time constant with which a moving setpoint's place is followed beside its velocity."""
JITTER_S = 0.15
"""By how much a setpoint may be late, beside the others of its stream, and still belong to it."""
TINY = 1e-12
SINKING_FORCE_G = 0.1
CLIMBING_FORCE_PART = 0.85
FORCE_PART = 0.95
"""Bounds of the vertical and of the whole specific force, in g and in parts of what the rotors can: the rest turns."""


@kernel
def extrapolate(reference: Array, elapsed_s: float, out: Array) -> None:
    """Write `reference` (25,) as its own velocity, acceleration and heading rate carry it on for `elapsed_s`."""
    out[:] = reference
    for i in range(3):
        out[i] += reference[3 + i] * elapsed_s + 0.5 * reference[6 + i] * elapsed_s * elapsed_s
        out[3 + i] += reference[6 + i] * elapsed_s
    out[YAW] += reference[YAW_RATE] * elapsed_s


@kernel
def steady(memory: Array, reference: Array, control: Record) -> None:
    """Replace the position in `reference` by the one in `memory`, which moves with its velocity and is drawn to it.

    A setpoint that moves comes with the jitter of its link: half a metre at 5 m/s and 0.1 s. Followed at once with
    this loop's gains, it would swing the thrust about faster than the rotors can. What is farther off than jitter
    explains is another place, and followed at once. Nor is there any to be steadied where it is the drone's own.
    """
    if reference[HAS_POSITION] + reference[HAS_VELOCITY] < 2.0:
        return
    period = control["period_s"]
    off = 0.0
    speed = 0.0
    for i in range(3):
        memory[PLACE + i] += period * reference[3 + i]
        off += (reference[i] - memory[PLACE + i]) ** 2
        speed += reference[3 + i] ** 2
    kept = min(1.0 - period / STEADYING_S, JITTER_S * math.sqrt(speed / max(off, TINY)))
    for i in range(3):
        memory[PLACE + i] = reference[i] + kept * (memory[PLACE + i] - reference[i])
        reference[i] = memory[PLACE + i]


@kernel
def approach_speed(distance: float, slope_per_s: float, braking: float) -> float:
    """Return the speed at which a goal `distance` away is approached, along a line or about an axis (m or rad)."""
    linear = braking / (slope_per_s * slope_per_s)
    if distance <= linear:
        return slope_per_s * distance
    return math.sqrt(2.0 * braking * (distance - 0.5 * linear))


@kernel
def turn_heading(memory: Array, reference: Array, control: Record) -> float:
    """Bring the commanded heading in `memory` nearer to the reference's, and return the rate applied, rad/s."""
    rate = reference[YAW_RATE]
    if reference[HAS_YAW] > 0.0:
        error = wrapped(reference[YAW] - memory[HEADING])
        rate += math.copysign(approach_speed(abs(error), HEADING_SLOPE_PER_S, HEADING_BRAKING_RAD_S2), error)
    rate = min(control["yaw_rate_max_rad_s"], max(-control["yaw_rate_max_rad_s"], rate))
    memory[HEADING] = wrapped(memory[HEADING] + rate * control["period_s"])
    return float(rate)


@kernel
def observe(
    y: Array, rotation: Array, speed: Array, memory: Array, touching: bool, control: Record, body: Record
) -> None:
    """Bring the observed velocity and disturbance in `memory` up to date; on a surface the disturbance is held.

    Axes on which a firmware integrates are left alone.
    """
    period = control["period_s"]
    pole = control["observer_rad_s"]
    thrust = 0.0
    for i in range(4):
        thrust += body["thrust_coefficient_n_s2"] * speed[i] * speed[i]
    for i in range(3):
        if control["has_pid"] == 1 and control["integral_gain"][i] >= 0.0:
            continue
        innovation = y[7 + i] - memory[VELOCITY + i]
        if touching:
            memory[VELOCITY + i] = y[7 + i]
            continue
        modelled = rotation[3 * i + 2] * thrust / body["mass_kg"] - (GRAVITY_M_S2 if i == 2 else 0.0)
        disturbance = memory[DISTURBANCE + i]
        memory[VELOCITY + i] += period * (modelled + disturbance + 2.0 * pole * innovation)
        disturbance += period * pole * pole * innovation
        memory[DISTURBANCE + i] = min(DISTURBANCE_MAX_M_S2, max(-DISTURBANCE_MAX_M_S2, disturbance))


@kernel
def fill_velocity_command(
    y: Array, reference: Array, control: Record, braking_m_s2: float, vertical_braking_m_s2: float, out: Array
) -> None:
    """Write the velocity (3,) in W to fly: feed-forward and correction, inside the envelope.

    The place is approached no faster than can be braked with `braking_m_s2`, its height with `vertical_braking_m_s2`.
    """
    out[:] = reference[3:6]
    if reference[HAS_POSITION] > 0.0:
        slope = control["position_gain"][0] / control["velocity_gain"][0]
        ex = reference[0] - y[0]
        ey = reference[1] - y[1]
        ez = reference[2] - y[2]
        distance = math.sqrt(ex * ex + ey * ey)
        if distance > 0.0:
            speed = approach_speed(distance, slope, braking_m_s2)
            out[0] += speed * ex / distance
            out[1] += speed * ey / distance
        slope = control["position_gain"][2] / control["velocity_gain"][2]
        out[2] += math.copysign(approach_speed(abs(ez), slope, vertical_braking_m_s2), ez)
    size = math.sqrt(out[0] * out[0] + out[1] * out[1])
    if size > control["speed_max_m_s"]:
        out[0] *= control["speed_max_m_s"] / size
        out[1] *= control["speed_max_m_s"] / size
    out[2] = min(control["climb_max_m_s"], max(-control["descent_max_m_s"], out[2]))


@kernel
def fill_acceleration(y: Array, memory: Array, reference: Array, control: Record, velocity: Array, out: Array) -> None:
    """Write the acceleration (3,) in W that follows `reference`; `velocity` (3,) is scratch."""
    for i in range(3):
        out[i] = (reference[6 + i] if reference[HAS_ACCELERATION] > 0.0 else 0.0) - memory[DISTURBANCE + i]
    if reference[HAS_POSITION] + reference[HAS_VELOCITY] == 0.0:
        return
    fill_velocity_command(y, reference, control, control["braking_m_s2"], VERTICAL_BRAKING_M_S2, velocity)
    cosine = math.cos(memory[HEADING])
    sine = math.sin(memory[HEADING])
    dx = velocity[0] - y[7]
    dy = velocity[1] - y[8]
    ahead = control["velocity_gain"][0] * (cosine * dx + sine * dy)
    left = control["velocity_gain"][1] * (cosine * dy - sine * dx)
    size = math.sqrt(ahead * ahead + left * left)
    if size > CORRECTION_MAX_M_S2:
        ahead *= CORRECTION_MAX_M_S2 / size
        left *= CORRECTION_MAX_M_S2 / size
    out[0] += cosine * ahead - sine * left
    out[1] += sine * ahead + cosine * left
    rising = control["velocity_gain"][2] * (velocity[2] - y[9])
    given = reference[8] if reference[HAS_ACCELERATION] > 0.0 else 0.0
    most = VERTICAL_CORRECTION_MAX_M_S2 + max(0.0, -given)
    least = -VERTICAL_CORRECTION_MAX_M_S2 - max(0.0, given)
    out[2] += min(most, max(least, rising))


@kernel
def bound_force(acceleration: Array, touching: bool, control: Record, body: Record) -> None:
    """Turn an acceleration (3,) into a specific force that the rotors can give, height before place, in place.

    Standing on something, and not about to leave it, the drone keeps level: leaning would only tip it over.
    """
    most = 4.0 * body["thrust_max_n"] / body["mass_kg"]
    up = acceleration[2] + GRAVITY_M_S2
    up = min(CLIMBING_FORCE_PART * most, max(SINKING_FORCE_G * GRAVITY_M_S2, up))
    acceleration[2] = up
    along = math.tan(control["tilt_max_rad"]) * up
    if most < math.inf:
        along = min(along, math.sqrt((FORCE_PART * most) ** 2 - up * up))
    if touching and up < GRAVITY_M_S2:
        along = 0.0
    size = math.sqrt(acceleration[0] ** 2 + acceleration[1] ** 2)
    if size > along:
        acceleration[0] *= along / size
        acceleration[1] *= along / size


@kernel
def mark_missed(memory: Array, asked: Array, force: Array) -> None:
    """Write the level part of the acceleration (3,) that was asked for into `memory` if `force` (3,) has less of it."""
    is_bound = asked[0] ** 2 + asked[1] ** 2 > (force[0] ** 2 + force[1] ** 2) * (1.0 + 1e-9)
    memory[MISSED] = asked[0] if is_bound else 0.0
    memory[MISSED + 1] = asked[1] if is_bound else 0.0
