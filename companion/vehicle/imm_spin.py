"""A vehicle that turns on the spot, as its gyro tells.

The model turns by curvature and speed, as a car does: one that stands cannot turn. Tracked and differentially driven
vehicles do. While a vehicle is slow, a yaw rate that its curve and its sensor's noise do not explain is no curvature,
which would become absurd, and moves the heading by itself once `spin` believes it.
Left out, the turn that a told heading shows would be taken for an error of the unit.
"""

import math

import numpy as np

from companion.config.estimation import ImmConfig
from companion.core.data import Measurement, Quantity
from companion.vehicle import imm_mixing as mixing
from companion.vehicle.imm_kernels import CURVATURE, HEADING
from companion.vehicle.imm_numbers import CAR_CURVATURE_MAX_RAD_M, Numbers
from companion.vehicle.imm_sensors import YAW_RATE, observe
from companion.vehicle.imm_state import ImmState, is_heading_known, open_states
from companion.vehicle.imm_swing import SIZE
from companion.vehicle.lever import turned
from companion.vehicle.small_matrices import carried_through
from companion.vehicle.spin import compared, passed, told
from link.records import replace

_STDS = 5.0  # beyond what is expected: noise alone does it once in a million readings
_EXPLAINED_MAX = 0.5  # of what is told: a curve that was more than that has ended, and is to be learnt anew
_ERRS_SHARE = 0.2  # of the rate, as the heading's standard deviation after a second; a choice, 10 readings a second
_SPINS_RAD_S = 0.2  # a pad 2.5 m beside the centre is then beyond the S2 speed; cars that depart turn more slowly
_NO_LEVER = np.zeros(4)


def without_spin(
    state: ImmState, measurement: Measurement, config: ImmConfig, numbers: Numbers
) -> tuple[ImmState, Measurement | None]:
    """Return the state with how fast the vehicle turns on the spot, and what the measurement tells beside that.

    That is a velocity of an antenna that does not swing round, and nothing where a yaw rate told the turn, or a heading
    is to tell whether there is one.

    Args:
        state: predicted to the measurement.
        measurement: of any quantity.
        config: of the filter.
        numbers: the same as the kernels take them.
    """
    if measurement.quantity is Quantity.YAW_RATE:
        spin_rad_s = _spin_told(state, measurement, config.heading.course_speed_min_m_s)
        if spin_rad_s == 0.0:
            state = _with_tight_curve_open(state)
        if spin_rad_s == 0.0 == state.spin.told_rad_s:
            return state, measurement
        spin = told(state.spin, spin_rad_s)
        if spin.rad_s and not state.spin.is_believed:  # it has turned since the first reading
            state = _turned_for(state, spin.rad_s, spin.told_s, config, numbers)
        return replace(state, spin=spin, turn_age_s=0.0), None if spin_rad_s else measurement
    if measurement.quantity is Quantity.HEADING and state.spin.told_rad_s:
        spin = compared(state.spin, float(measurement.value[0]), float(measurement.covariance[0, 0]))
        return replace(state, spin=spin), None if spin.is_open else measurement
    if measurement.quantity is not Quantity.VELOCITY or state.spin.rad_s == 0.0:
        return state, measurement
    means, _, weights = state.modes
    forward_m, left_m = _lever_m(state, config, numbers)
    east_m, north_m = turned(forward_m, left_m, float(weights @ means[:, HEADING]))
    value = measurement.value + state.spin.rad_s * np.array([-north_m, east_m, 0.0])
    return state, replace(measurement, value=value)


def spun(state: ImmState, dt_s: float, config: ImmConfig, numbers: Numbers) -> ImmState:
    """Return the state whose heading has turned on the spot for `dt_s`, about the pad's centre as in every turn.

    Args:
        state: before.
        dt_s: time that passes.
        config: of the filter.
        numbers: the same as the kernels take them.
    """
    spin = state.spin
    if spin.rad_s:
        state = _turned_for(state, spin.rad_s, min(dt_s, spin.left_s), config, numbers)
    return replace(state, spin=passed(spin, dt_s))


def spins(state: ImmState) -> bool:
    """Return whether the vehicle turns too fast on the spot for a forecast, which has it stand."""
    return abs(state.spin.rad_s) > _SPINS_RAD_S


def _turned_for(state: ImmState, rate_rad_s: float, lasts_s: float, config: ImmConfig, numbers: Numbers) -> ImmState:
    means, covariances, weights = state.modes
    forward_m, left_m = _lever_m(state, config, numbers)
    moved, opened = means.copy(), np.empty_like(covariances)
    moved[:, HEADING] += rate_rad_s * lasts_s
    for mode, (before, after) in enumerate(zip(means, moved, strict=True)):
        (x_m, y_m), (to_x_m, to_y_m) = (turned(forward_m, left_m, one[HEADING]) for one in (before, after))
        after[:2] += x_m - to_x_m, y_m - to_y_m
        F = np.eye(SIZE)
        F[:2, HEADING] = to_y_m - y_m, x_m - to_x_m
        opened[mode] = F @ covariances[mode] @ F.T
    opened[:, HEADING, HEADING] += (_ERRS_SHARE * rate_rad_s) ** 2 * lasts_s
    return replace(state, modes=(moved, opened, weights))


def _with_tight_curve_open(state: ImmState) -> ImmState:
    """Return the state for a yaw rate: what turns tighter than a car may end its turn at once.

    Else the speed would be told by the turn, and one that has turned on the spot would stand as it drives off.
    """
    means, _, weights = state.modes
    curvature_per_m = float(weights @ means[:, CURVATURE])
    if abs(curvature_per_m) < CAR_CURVATURE_MAX_RAD_M:
        return state
    return replace(state, modes=open_states(state.modes, np.array([CURVATURE]), np.array([curvature_per_m**2])))


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
