"""Four rotors: thrust `kt w^2`, drag torque `kd w^2`, a first-order lag, and eq. 5 of the report both ways.

Rotor 1 is behind, 2 in front, 3 right, 4 left (the signs of eq. 5); thrusts in N, torques in N m about FLU axes:
`T = T1+T2+T3+T4`, `L = d (T4-T3)`, `M = d (T1-T2)`, `N = kd/kt (T1+T2-T3-T4)`.
"""

import math

from link.compiled import kernel
from sim_autopilot.core.data import Array
from sim_autopilot.physics.parameters import Record

ROTOR_X = (-1.0, 1.0, 0.0, 0.0)
ROTOR_Y = (0.0, 0.0, -1.0, 1.0)
"""Where the rotors are, in arm lengths along x and y of B."""


@kernel
def fill_wrench(thrust: Array, arm_m: float, torque_per_thrust_m: float, out: Array) -> None:
    """Write [T, L, M, N] of four rotor thrusts (4,) N into `out` (4,)."""
    out[0] = thrust[0] + thrust[1] + thrust[2] + thrust[3]
    out[1] = arm_m * (thrust[3] - thrust[2])
    out[2] = arm_m * (thrust[0] - thrust[1])
    out[3] = torque_per_thrust_m * (thrust[0] + thrust[1] - thrust[2] - thrust[3])


@kernel
def fill_thrusts(wrench: Array, body: Record, out: Array) -> None:
    """Write into `out` (4,) the rotor thrusts, each in [0, maximum], that come closest to `wrench` [T, L, M, N].

    Roll and pitch torques are kept before thrust, thrust before yaw torque: a drone that leans the wrong way is lost,
    one that turns its nose is not.
    """
    top = body["thrust_max_n"]
    roll = min(top, max(-top, wrench[1] / body["arm_m"]))
    pitch = min(top, max(-top, wrench[2] / body["arm_m"]))
    lean = abs(roll) + abs(pitch)
    total = max(lean, min(wrench[0], 4.0 * top - lean))
    half = 0.5 * total
    turn_min = 2.0 * max(abs(pitch) - half, half - (2.0 * top - abs(roll)))
    turn_max = 2.0 * min(half - abs(roll), 2.0 * top - abs(pitch) - half)
    turn = min(turn_max, max(turn_min, wrench[3] / body["torque_per_thrust_m"]))
    along_x = half + 0.5 * turn
    along_y = half - 0.5 * turn
    # max: the bounds hold exactly in real numbers, in floating point only to the last digit.
    out[0] = max(0.0, 0.5 * (along_x + pitch))
    out[1] = max(0.0, 0.5 * (along_x - pitch))
    out[2] = max(0.0, 0.5 * (along_y - roll))
    out[3] = max(0.0, 0.5 * (along_y + roll))


@kernel
def fill_commands(thrust: Array, speed: Array, lead: float, body: Record, out: Array) -> None:
    """Write the speeds (4,) rad/s to command for wanted thrusts (4,), plus `lead` times the speed still missing."""
    kt = body["thrust_coefficient_n_s2"]
    speed_max = math.sqrt(body["thrust_max_n"] / kt)
    for i in range(4):
        wanted = math.sqrt(max(0.0, thrust[i]) / kt)
        out[i] = min(speed_max, max(0.0, wanted + lead * (wanted - speed[i])))


@kernel
def fill_lagged(speed: Array, command: Array, elapsed_s: float, time_constant_s: float, out: Array) -> None:
    """Write the rotor speeds (4,) `elapsed_s` after `speed`, towards `command`: the exact first-order lag."""
    remaining = math.exp(-elapsed_s / time_constant_s) if time_constant_s > 0.0 else 0.0
    for i in range(4):
        out[i] = command[i] + (speed[i] - command[i]) * remaining
