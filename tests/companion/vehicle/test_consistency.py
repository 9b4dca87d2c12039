"""Where the truth obeys a filter's own model, NIS and NEES must lie in their 95 % bands; a wrong algebra fails here."""

import numpy as np
import pytest
from scipy import stats

from companion.config.estimation import (
    BrakingConfig,
    BufferConfig,
    EasingConfig,
    EstimatorConfig,
    HeadingConfig,
    ImmConfig,
    LkfConfig,
    RampConfig,
    ReceiversConfig,
    SteadyConfig,
    SwayConfig,
    TurningConfig,
)
from companion.core.data import Array, Measurement, Quantity
from companion.vehicle import imm_kernels as kernels
from companion.vehicle import imm_noise as noises
from companion.vehicle.estimator import DelayBuffer, fuse
from companion.vehicle.filter_step import Gaussian
from companion.vehicle.imm import ImmModel
from companion.vehicle.imm_mixing import combine
from companion.vehicle.imm_numbers import noises_with
from companion.vehicle.imm_state import ImmState
from companion.vehicle.imm_swing import SIZE, smooth_step
from companion.vehicle.lkf import LkfModel, WhiteJerkNoise, transition
from tests.companion.vehicle.rides import now_ns

DT_S, STEPS, RUNS, SETTLED = 0.1, 150, 36, 60
STATES = np.array([0, 1, 2, 3, 4, 5, 6, 8, 9, kernels.BEND])
FIX_STD_M, VELOCITY_STD_M_S = 0.02, 0.05
MODE = SteadyConfig(jerk_psd_m2_s5=0.5, lateral_acceleration_psd_m2_s5=0.5, begins_after_s=1.0)
IMM = ImmModel(
    config=ImmConfig(
        steady=MODE,
        easing=EasingConfig(jerk_psd_m2_s5=MODE.jerk_psd_m2_s5, begins_after_s=1.0),
        braking=BrakingConfig(jerk_psd_m2_s5=MODE.jerk_psd_m2_s5, begins_after_s=1.0),
        turning=TurningConfig(lateral_acceleration_psd_m2_s5=MODE.lateral_acceleration_psd_m2_s5, begins_after_s=1.0),
        ramp=RampConfig(
            bend_std_per_m=MODE.bend_std_per_m,
            bend_acceleration_std_m_s2=MODE.bend_acceleration_std_m_s2,
            begins_after_s=1.0,
        ),
        receivers=ReceiversConfig(frame_offset_std_m=0.0, frame_offset_walk_m2_s=0.0, clock_std_s=0.0),
        heading=HeadingConfig(course_std_rad=1e3),
        sway=SwayConfig(prior_s=1e4),  # known, and so not learnt
    )
)
NOISE = noises_with(
    IMM.numbers,
    (0.0, 0.0, 0.0),
    (MODE.jerk_psd_m2_s5, MODE.lateral_acceleration_psd_m2_s5),
    0.0,
    turn_is_measured=False,
)[0]
"""Of the steady model, by the filter's own table: a kernel that is given too short a one reads what lies behind it."""
LKF = LkfModel(noise=WhiteJerkNoise(config=LkfConfig()))


def noisy(t_s: float, quantity: Quantity, value: Array, std: float, rng: np.random.Generator) -> Measurement:
    n = len(value)
    return Measurement(
        t_ns=now_ns(t_s),
        quantity=quantity,
        value=value + std * rng.standard_normal(n),
        covariance=std**2 * np.eye(n),
    )


def measured(i: int, position: Array, velocity: Array, rng: np.random.Generator) -> list[Measurement]:
    t_s = i * DT_S
    return [
        noisy(t_s, Quantity.POSITION, position, FIX_STD_M, rng),
        noisy(t_s, Quantity.VELOCITY, velocity, VELOCITY_STD_M_S, rng),
    ]


def assert_in_band(total: float, dof: int) -> None:
    """A sum of squared normal numbers with `dof` degrees of freedom."""
    assert stats.chi2.ppf(0.025, dof) < total < stats.chi2.ppf(0.975, dof)


def assert_consistent(runs: list[tuple[float, float, int]], states: int) -> None:
    """Runs of NEES over `states`, summed NIS and its degrees of freedom."""
    assert_in_band(sum(nees for nees, _, _ in runs), states * len(runs))
    assert_in_band(sum(nis for _, nis, _ in runs), sum(dof for _, _, dof in runs))


def drawn(covariance: Array, rng: np.random.Generator) -> Array:
    """Through the symmetric square root, which is unique: eigenvectors' signs differ between processors."""
    values, vectors = np.linalg.eigh(covariance)
    root = (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T
    return np.asarray(root @ rng.standard_normal(len(covariance)))


def wander(x: Array, rng: np.random.Generator) -> Array:
    """The turning model's own motion with its own noise, one step."""
    sways, calm = IMM.config.sway, np.zeros((2, 2, 2))
    frequency_rad_s = 2.0 * np.pi * sways.frequency_hz
    heave, heave_noise = smooth_step(DT_S, frequency_rad_s, sways.damping, sways.heave_std_m * frequency_rad_s)
    Q = noises.process_noise(x, DT_S, NOISE, heave_noise, calm)
    after, _ = kernels.advance(x, DT_S, IMM.config.acceleration_decay_s, heave, calm)
    after[6] *= noises.curvature_left(float(np.hypot(x[2], x[3])), DT_S, NOISE)
    after[kernels.BEND] *= noises.bend_step(x, DT_S, NOISE)[0]
    return np.asarray(after + drawn(Q, rng))


def imm_run(curvature: float, seed: int) -> tuple[float, float, int]:
    rng = np.random.default_rng(seed)
    x = np.zeros(SIZE)
    x[2], x[6] = 8.0, curvature
    buffer: DelayBuffer[ImmState] | None = None
    at_settled = (0.0, 0)
    for i in range(STEPS):
        position, velocity = (
            x[[0, 1, 8]],
            np.array([x[2], x[3], noises.forward_speed(x) * x[9] + x[10]]),
        )
        sensors = [
            *measured(i, position, velocity, rng),
            noisy(i * DT_S, Quantity.YAW_RATE, np.array([x[6] * np.hypot(x[2], x[3])]), 0.01, rng),
        ]
        buffer = fuse(IMM, BufferConfig(), buffer, sensors)
        assert buffer is not None
        if i == SETTLED:
            at_settled = (buffer.newest.tally.nis_sum, buffer.newest.tally.nis_dof)
        truth, x = x, wander(x, rng)
    assert buffer is not None
    assert buffer.newest.state is not None
    tally = buffer.newest.tally
    mean, covariance = combine(*buffer.newest.state.modes)
    error = (truth - mean)[STATES]
    nees = float(error @ np.linalg.solve(covariance[np.ix_(STATES, STATES)], error))
    return nees, tally.nis_sum - at_settled[0], tally.nis_dof - at_settled[1]


@pytest.mark.slow
@pytest.mark.parametrize("curvature", [0.0, 0.05], ids=["straight", "circle"])
def test_turning_filter_is_consistent_on_its_own_model(curvature: float) -> None:
    runs = [imm_run(curvature, seed) for seed in range(4 * RUNS)]
    assert_consistent(runs, states=len(STATES))


def lkf_run(seed: int) -> tuple[float, float, int]:
    rng = np.random.default_rng(seed)
    F, Q = transition(DT_S), LKF.noise.process(DT_S)
    x = np.concatenate([[3.0, -4.0, 1.0], [6.0, 2.0, 0.0], np.zeros(3)])
    buffer: DelayBuffer[Gaussian] | None = None
    at_settled = (0.0, 0)
    for i in range(STEPS):
        buffer = fuse(LKF, BufferConfig(), buffer, measured(i, x[:3], x[3:6], rng))
        assert buffer is not None
        if i == SETTLED:
            at_settled = (buffer.newest.tally.nis_sum, buffer.newest.tally.nis_dof)
        truth, x = x, F @ x + drawn(Q, rng)
    assert buffer is not None
    assert buffer.newest.state is not None
    tally, state = buffer.newest.tally, buffer.newest.state
    error = truth - state.mean
    nees = float(error @ np.linalg.solve(state.covariance, error))
    return nees, tally.nis_sum - at_settled[0], tally.nis_dof - at_settled[1]


@pytest.mark.slow
def test_linear_filter_is_consistent_on_its_own_model() -> None:
    runs = [lkf_run(seed) for seed in range(RUNS)]
    assert_consistent(runs, states=9)


def test_default_configuration_keeps_the_modes_apart() -> None:
    config = EstimatorConfig().imm
    assert config.easing.jerk_psd_m2_s5 > 10.0 * config.steady.jerk_psd_m2_s5
    assert config.braking.jerk_psd_m2_s5 > 10.0 * config.easing.jerk_psd_m2_s5
    assert config.ramp.bend_std_per_m > 5.0 * config.steady.bend_std_per_m
    assert config.turning.lateral_acceleration_psd_m2_s5 > 10.0 * config.steady.lateral_acceleration_psd_m2_s5
