"""One period of the flight controller: from the drone's state and a reference to what the motors are told.

An attitude or turn rates with a given thrust, of setpoints and sticks that bypass the outer loop, are followed by
`torque = I (-kR eR - kw (w - w_d)) + w x I w` with the tracking error on SO(3) and the gains of `control.geometric`;
of turn rates alone kR is zero.
"""

from link.compiled import kernel
from sim_autopilot.control.geometric import fill_geometric_wrench
from sim_autopilot.control.lqr import GOAL, fill_feedforward_wrench, fill_report_wrench
from sim_autopilot.control.outer_loop import bound_force, fill_acceleration, mark_missed, observe, steady, turn_heading
from sim_autopilot.control.parameters import ATTITUDE, HAS_ATTITUDE, HAS_RATES, HEADING, RATE, RUNNING, THRUST, VELOCITY
from sim_autopilot.control.velocity_pid import fill_pid_acceleration, integrate
from sim_autopilot.core.data import Array
from sim_autopilot.physics.parameters import Record
from sim_autopilot.physics.rotation import euler_angles, fill_matrix
from sim_autopilot.physics.rotors import fill_commands, fill_thrusts


@kernel
def fill_attitude_wrench(
    y: Array, rotation: Array, reference: Array, control: Record, body: Record, wanted: Array, out: Array
) -> None:
    """Write [T, L, M, N] that turns as `reference` (25,) says; `wanted` (9,) is scratch."""
    inertia = body["inertia_kg_m2"]
    fill_matrix(reference[ATTITUDE : ATTITUDE + 4], wanted)
    out[0] = body["mass_kg"] * reference[THRUST]
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        error = 0.0
        if reference[HAS_ATTITUDE] > 0.0:
            for row in (0, 3, 6):
                error += 0.5 * (wanted[row + k] * rotation[row + j] - rotation[row + k] * wanted[row + j])
        rate = y[10 + i] - reference[RATE + i]
        gyro = y[10 + j] * y[10 + k] * (inertia[k] - inertia[j])
        out[1 + i] = inertia[i] * (-control["attitude_gain"][i] * error - control["rate_gain"][i] * rate) + gyro


LQR = 0
LQR_FEEDFORWARD = 1


@kernel
def start(y: Array, rotation: Array, control: Record, memory: Array) -> None:
    """Start the controller from where the drone is, without a bump."""
    memory[:] = 0.0
    memory[RUNNING] = 1.0
    memory[HEADING] = euler_angles(rotation)[2]
    offset = 7
    if control["kind"] == LQR:
        memory[GOAL] = memory[HEADING]
        offset = 0
    for i in range(3):
        is_error = control["derives_error"] == 1 and control["integral_gain"][i] >= 0.0
        memory[VELOCITY + i] = 0.0 if is_error else y[offset + i]


@kernel
def fill_control(
    y: Array, rotation: Array, speed: Array, memory: Array, reference: Array, touching: bool, control: Record,
    body: Record, scratch: Array, out: Array,
) -> None:  # fmt: skip
    """Write the wanted [T, L, M, N] (4,) and bring `memory` (17,) on by one period.

    Args:
        y: (13,) state.
        rotation: (9,) R_WB.
        speed: (4,) rotor speeds, rad/s.
        memory: (17,) of the controller, changed.
        reference: (25,).
        touching: whether the drone touches anything.
        control: the controller's record.
        body: the airframe's record.
        scratch: (18,) overwritten.
        out: (4,) N and N m.
    """
    if reference[HAS_RATES] > 0.0:
        memory[RUNNING] = 0.0
        fill_attitude_wrench(y, rotation, reference, control, body, scratch[3:12], out)
        return
    if memory[RUNNING] == 0.0:
        start(y, rotation, control, memory)
    if control["kind"] == LQR:
        fill_report_wrench(y, rotation, memory, reference, control, body, scratch[0:12], out)
        return
    force, wanted = scratch[0:3], scratch[3:12]
    heading_rate, has_pid = turn_heading(memory, reference, control), control["has_pid"] == 1
    if not has_pid:
        steady(memory, reference, control)
    observe(y, rotation, speed, memory, touching, control, body)
    if has_pid:
        fill_pid_acceleration(y, memory, reference, control, wanted[0:3], force)
    else:
        fill_acceleration(y, memory, reference, control, wanted[0:3], force)
    wanted[3:6] = force
    bound_force(force, touching, control, body)
    mark_missed(memory, wanted[3:6], force)
    if has_pid:
        integrate(memory, reference, control, wanted, force, touching)
    if control["kind"] == LQR_FEEDFORWARD:
        fill_feedforward_wrench(y, rotation, force, memory, heading_rate, control, body, out)
    else:
        fill_geometric_wrench(y, rotation, force, memory, heading_rate, control, body, wanted, out)


@kernel
def fill_motor_command(wrench: Array, speed: Array, control: Record, body: Record, thrust: Array, out: Array) -> None:
    """Write what the motors are told (4,): rotor speeds, or `wrench` itself where it acts at once (`speed` follows)."""
    fill_thrusts(wrench, body, thrust)
    if body["direct"] == 1:
        fill_commands(thrust, speed, 0.0, body, speed)
        out[:] = wrench
    else:
        fill_commands(thrust, speed, control["motor_lead"], body, out)
