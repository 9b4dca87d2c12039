"""The interacting models' kernels beside the Python that they are made of, down to the last call, on random modes."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from companion.core.data import Array
from companion.vehicle import imm_forecast, imm_judgement, imm_kernels, imm_mixing, imm_noise, imm_sensors, imm_swing
from companion.vehicle import small_matrices as matrices
from tests.companion.vehicle.test_imm_kernels import LEVER, MOTION, NOISE, a_covariance, a_state

MODULES = (imm_forecast, imm_judgement, imm_kernels, imm_mixing, imm_noise, imm_sensors, imm_swing, matrices)
BEGINS_AFTER_S = np.array([0.4, 10.0, 40.0, 25.0])
NOISES = np.stack([NOISE, 3.0 * NOISE, 30.0 * NOISE, 0.2 * NOISE])
OFFSET_S = np.array([0.0, 0.2, 0.4, 0.6, 0.7, 1.1])
KNOWN, UNKNOWN = 1e3, 1e-3  # variances of the heading, above and below all of `modes_of`
COURSE = np.array([1.5, 0.05, KNOWN, 1.0])
COMPONENTS = {
    imm_sensors.POSITION: 3,
    imm_sensors.VELOCITY: 3,
    imm_sensors.HEADING: 1,
    imm_sensors.YAW_RATE: 1,
    imm_sensors.PAD: 3,
    imm_sensors.ACCELERATION: 1,
    imm_sensors.TILT: 4,
    imm_sensors.SURFACE: 1,
}

Call = tuple[str, str, tuple[object, ...]]


def modes_of(seed: int, n: int = len(BEGINS_AFTER_S)) -> imm_mixing.Modes:
    weights = np.random.default_rng(seed).dirichlet(np.full(n, 0.6))
    means = np.stack([a_state(10 * seed + i) for i in range(n)])
    return means, np.stack([0.02 * a_covariance(10 * seed + i) for i in range(n)]), weights


def calls(seed: int) -> list[Call]:
    """Each kernel by module and name, with its arguments."""
    modes = modes_of(seed)
    found: list[Call] = [
        ("imm_mixing", "switching", (BEGINS_AFTER_S, 0.13)),
        ("imm_mixing", "combine", modes),
        ("imm_mixing", "mix", (modes, 0.83, np.array([0.1, 0.04, 0.01, 0.02]))),
        ("imm_mixing", "steps_of", (0.33, MOTION)),
        ("imm_judgement", "expect_manoeuvres", (modes, 0.37, BEGINS_AFTER_S, NOISES)),
        ("imm_judgement", "align_modes", (*modes[:2], COURSE)),
        ("imm_judgement", "align_modes", (*modes[:2], COURSE * np.array([1.0, 1.0, 1.0, 0.0]))),
    ]
    for known in (KNOWN, UNKNOWN):
        found += [
            ("imm_mixing", "predict_modes", (modes, 0.23, NOISES, BEGINS_AFTER_S, MOTION, known)),
            ("imm_forecast", "describe_modes", (modes, MOTION, known)),
            ("imm_forecast", "describe_pad", (modes, MOTION, known)),
            ("imm_forecast", "forecast_modes", (modes, OFFSET_S, NOISES, MOTION, known)),
        ]
    for kind, m in COMPONENTS.items():
        seen, _ = imm_sensors.observe(kind, modes[0][0], LEVER, True)
        reading = (kind, seen + 0.1, 0.01 * a_covariance(seed, m))
        found.append(("imm_judgement", "update_modes", (modes, reading, LEVER, True)))
        found.append(("imm_judgement", "take_reading", (modes, reading, LEVER, COURSE)))
    return found


def results(call: Call) -> list[Array]:
    """All numbers that a kernel returns, whatever they are in."""
    module, name, arguments = call
    kernel: Callable[..., Any] = getattr(next(m for m in MODULES if m.__name__.endswith(module)), name)
    return list(flat(kernel(*arguments)))


def flat(returned: object) -> list[Array]:
    if isinstance(returned, tuple):
        return [array for part in returned for array in flat(part)]
    return [np.asarray(returned, dtype=np.float64)]


@pytest.mark.parametrize("seed", range(3))
def test_compiled_kernels_equal_their_python(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    every = calls(seed)
    compiled = [results(call) for call in every]
    for module in MODULES:
        for name, value in list(vars(module).items()):
            if hasattr(value, "py_func"):
                monkeypatch.setattr(module, name, value.py_func)
    for call, mine in zip(every, compiled, strict=True):
        for part, python in zip(mine, results(call), strict=True):
            np.testing.assert_allclose(part, python, rtol=1e-10, atol=1e-10, err_msg=call[1])


@pytest.mark.parametrize("seed", range(3))
def test_mixture_is_that_of_all_modes_weighed_by_where_they_come_from(seed: int) -> None:
    means, covariances, weights = modes_of(seed)
    unchanged, begun = imm_mixing.switching(BEGINS_AFTER_S, 0.7)
    changes = unchanged * np.eye(len(weights)) + begun
    mixed = imm_mixing.mix((means, covariances, weights), unchanged, begun)
    np.testing.assert_allclose(mixed[2], weights @ changes, rtol=1e-12)
    for j, after in enumerate(mixed[2]):
        share = weights * changes[:, j] / after
        off = means - share @ means
        spread = np.einsum("i,ia,ib->ab", share, off, off)
        np.testing.assert_allclose(mixed[0][j], share @ means, rtol=1e-12, atol=1e-12)
        np.testing.assert_allclose(mixed[1][j], np.tensordot(share, covariances, 1) + spread, rtol=1e-10, atol=1e-12)


def test_mixture_of_what_all_modes_hold_for_certain_is_certain() -> None:
    means, covariances, weights = modes_of(5)
    means[:, 3], covariances[:, 3], covariances[:, :, 3] = 7.3e4, 0.0, 0.0
    assert imm_mixing.combine(means, covariances, weights)[1][3, 3] == pytest.approx(0.0, abs=1e-20)


@pytest.mark.parametrize("seed", range(3))
def test_covariances_stay_symmetric(seed: int) -> None:
    modes = modes_of(seed)
    predicted = imm_mixing.predict_modes(modes, 0.23, NOISES, BEGINS_AFTER_S, MOTION, KNOWN)
    seen, _ = imm_sensors.observe(imm_sensors.VELOCITY, modes[0][0], LEVER, True)
    reading = (imm_sensors.VELOCITY, seen, 0.01 * np.eye(3))
    fused, _, _ = imm_judgement.take_reading(predicted, reading, LEVER, COURSE)
    for covariances in (predicted[1], fused[1]):
        assert np.array_equal(covariances, covariances.transpose(0, 2, 1))
