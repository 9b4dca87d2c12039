"""A vehicle that turns on the spot, as its gyro tells.

The model turns by curvature and speed, as a car does: one that stands cannot turn. Tracked and differentially driven
vehicles do. While a vehicle is slow, a yaw rate that its curve and its sensor's noise do not explain is no curvature,
which would become absurd, and moves the heading by itself once it has lasted: one reading may be an outlier. Left out,
the turn that a told heading shows would be taken for an error of the unit. A turn that the told heading denies is
believed no longer, and teaches nothing about the unit: the vehicle has no heading to land by until the two agree.
"""

import math

import numpy as np

from companion.config.estimation import ImmConfig
from companion.core.data import Measurement, Quantity
from companion.vehicle import imm_mixing as mixing
from companion.vehicle.filter_step import wrapped
from companion.vehicle.imm_kernels import HEADING
from companion.vehicle.imm_numbers import Numbers
from companion.vehicle.imm_sensors import YAW_RATE, observe
from companion.vehicle.imm_state import ImmState, is_heading_known, open_states
from companion.vehicle.imm_swing import SIZE, UNIT_HEADING
from companion.vehicle.lever import turned
from companion.vehicle.small_matrices import carried_through
from link.records import replace

_STDS = 5.0  # beyond what is expected: noise alone does it once in a million readings
_SURE_S = 0.1  # for which it is told before it is believed: a knock is over, and the slowest gyro has told it twice
_SWINGS_S = 0.3  # until velocities are believed to be the antenna's: a heading that denies the turn has come by then
_DENIED_SHARE = 0.5  # of the turn, by which the told heading has turned less
_DENIED_RAD = 0.15  # at least: five times what a heading of two antennas errs by
_HOLDS_S = 0.5  # without another reading: several periods of the slowest gyro
_EXPLAINED_MAX = 0.5  # of what is told: a curve that was more than that has ended, and is to be learnt anew
_ERRS_SHARE = 0.2  # of the rate, as the heading's standard deviation after a second; a choice, 10 readings a second
_SPINS_RAD_S = 0.2  # a pad 2.5 m beside the centre is then beyond the S2 speed; cars that depart turn more slowly
_NO_LEVER = np.zeros(4)


def without_spin(
    state: ImmState, measurement: Measurement, config: ImmConfig, numbers: Numbers
) -> tuple[ImmState, Measurement | None]:
    """Return the state with how fast the vehicle turns on the spot, and what the measurement tells beside that.

    That is a velocity of an antenna that does not swing round, and nothing where a yaw rate told the turn.

    Args:
        state: predicted to the measurement.
        measurement: of any quantity.
        config: of the filter.
        numbers: the same as the kernels take them.
    """
    if measurement.quantity is Quantity.YAW_RATE:
        spin_rad_s = _spin_told(state, measurement, config.heading.course_speed_min_m_s)
        if spin_rad_s == 0.0 == state.spin_rad_s:
            return state, measurement
        if spin_rad_s * state.spin_rad_s <= 0.0:
            state = replace(state, spin_told_s=0.0, spin_turned_rad=0.0, spin_denied_rad=0.0)
        state = replace(state, spin_rad_s=spin_rad_s, spin_left_s=_HOLDS_S, turn_age_s=0.0)
        return state, None if spin_rad_s else measurement
    spin_rad_s = believed_spin_rad_s(state)
    if measurement.quantity is Quantity.HEADING and spin_rad_s:
        return _compared(state, float(measurement.value[0])), measurement
    if measurement.quantity is not Quantity.VELOCITY or spin_rad_s == 0.0 or state.spin_told_s < _SWINGS_S:
        return state, measurement
    means, _, weights = state.modes
    forward_m, left_m = _lever_m(state, config, numbers)
    east_m, north_m = turned(forward_m, left_m, float(weights @ means[:, HEADING]))
    value = measurement.value + spin_rad_s * np.array([-north_m, east_m, 0.0])
    return state, replace(measurement, value=value)


def spun(state: ImmState, dt_s: float, config: ImmConfig, numbers: Numbers) -> ImmState:
    """Return the state whose heading has turned on the spot for `dt_s`, about the pad's centre as in every turn.

    Once the turn is believed, it has turned from the first reading on.

    Args:
        state: before.
        dt_s: time that passes.
        config: of the filter.
        numbers: the same as the kernels take them.
    """
    means, covariances, weights = state.modes
    forward_m, left_m = _lever_m(state, config, numbers)
    passed_s, moved, opened = min(dt_s, state.spin_left_s), means.copy(), np.empty_like(covariances)
    told_s = state.spin_told_s + passed_s
    since_s = passed_s if state.spin_told_s >= _SURE_S else told_s
    turns_s = since_s if told_s >= _SURE_S and not _is_denied(state) else 0.0
    moved[:, HEADING] += state.spin_rad_s * turns_s
    for mode, (before, after) in enumerate(zip(means, moved, strict=True)):
        (x_m, y_m), (to_x_m, to_y_m) = (turned(forward_m, left_m, one[HEADING]) for one in (before, after))
        after[:2] += x_m - to_x_m, y_m - to_y_m
        F = np.eye(SIZE)
        F[:2, HEADING] = to_y_m - y_m, x_m - to_x_m
        opened[mode] = F @ covariances[mode] @ F.T
    opened[:, HEADING, HEADING] += (_ERRS_SHARE * state.spin_rad_s) ** 2 * turns_s
    opened[:, UNIT_HEADING, UNIT_HEADING] = np.maximum(
        opened[:, UNIT_HEADING, UNIT_HEADING], state.heading_bias_variance_rad2
    )
    left_s = state.spin_left_s - passed_s
    spin_rad_s = state.spin_rad_s if left_s > 0.0 else 0.0
    return replace(
        state,
        modes=(moved, opened, weights),
        spin_rad_s=spin_rad_s,
        spin_told_s=told_s,
        spin_left_s=left_s,
        spin_turned_rad=state.spin_turned_rad + state.spin_rad_s * turns_s,
    )


def believed_spin_rad_s(state: ImmState) -> float:
    """Return how fast the vehicle turns on the spot; 0 until that has lasted, and once it is denied."""
    return state.spin_rad_s if state.spin_told_s >= _SURE_S and not _is_denied(state) else 0.0


def spins(state: ImmState) -> bool:
    """Return whether the vehicle turns too fast on the spot for a forecast, which has it stand, or is said to."""
    return abs(state.spin_rad_s) > _SPINS_RAD_S and state.spin_told_s >= _SURE_S


def _is_denied(state: ImmState) -> bool:
    turned_rad = abs(state.spin_turned_rad)
    less_rad = -math.copysign(state.spin_denied_rad, state.spin_denied_rad * state.spin_turned_rad)
    return turned_rad > _DENIED_RAD and less_rad > _DENIED_SHARE * turned_rad


def _compared(state: ImmState, told_rad: float) -> ImmState:
    """Return the state before a heading is fused that shows how much the vehicle has turned, and not the unit's error.

    `spun` doubts the unit again. A turn that is denied from here on was none, and the heading is what is told.
    """
    means, certain, weights = state.modes[0], state.modes[1].copy(), state.modes[2]
    off_rad = wrapped(told_rad - float(weights @ (means[:, HEADING] + means[:, UNIT_HEADING])))
    certain[:, UNIT_HEADING, :] = certain[:, :, UNIT_HEADING] = 0.0
    compared = replace(state, modes=(means, certain, weights), spin_denied_rad=state.spin_denied_rad + off_rad)
    if not _is_denied(compared):
        return compared
    opened = open_states(compared.modes, np.array([HEADING]), np.array([state.spin_turned_rad**2]))
    return replace(compared, modes=opened)


def _spin_told(state: ImmState, yaw_rate: Measurement, slow_m_s: float) -> float:
    means, covariances, weights = state.modes
    east_m_s, north_m_s = (weights @ means[:, 2:4]).tolist()
    if math.hypot(east_m_s, north_m_s) > slow_m_s:
        return 0.0
    x, P = mixing.combine(means, covariances, weights)
    expected, H = observe(YAW_RATE, x, _NO_LEVER, True)
    told_rad_s = float(yaw_rate.value[0])
    off_rad_s = told_rad_s - float(expected[0])
    variance = float(carried_through(H, P)[0, 0] + yaw_rate.covariance[0, 0])
    is_curve = abs(float(expected[0])) > _EXPLAINED_MAX * abs(told_rad_s)
    return 0.0 if is_curve or off_rad_s**2 <= _STDS**2 * max(variance, 0.0) else off_rad_s


def _lever_m(state: ImmState, config: ImmConfig, numbers: Numbers) -> tuple[float, float]:
    """Return the lever from the antenna to the pad, forward and left; 0 while the heading that turns it is unknown."""
    return (numbers.lever_m[0], numbers.lever_m[1]) if is_heading_known(state, config) else (0.0, 0.0)
