"""Makes the estimator that a configuration names."""

from functools import lru_cache
from typing import assert_never, cast

import numpy as np

from companion.config.estimation import EstimatorConfig, EstimatorKind
from companion.core.data import Measurement, Quantity
from companion.vehicle.estimator import BufferedEstimator, Estimator, EstimatorMemory
from companion.vehicle.imm import ImmModel
from companion.vehicle.imm_numbers import Deck


def make_estimator(
    config: EstimatorConfig,
    deck: Deck | None = None,
    kind: EstimatorKind | None = None,
    *,
    is_silent: bool = False,
) -> Estimator:
    """Return an estimator; each has its own memory, which only it reads.

    The deck is not part of the memory: when the vehicle tells it later, make the estimator again and go on with
    the same memory. The first call for a kind compiles its kernels, once per machine (some 20 s), so that no later
    step waits for it.

    Args:
        config: all numbers.
        deck: where the pad is on the vehicle, None until it tells.
        kind: which one, instead of the one that the configuration names.
        is_silent: the vehicle tells nothing, and sightings of its pad place it; of the interacting models only.
    """
    kind = config.kind if kind is None else kind
    _warm_up(kind)
    return _make(config, Deck() if deck is None else deck, kind, is_silent=is_silent)


@lru_cache
def _warm_up(kind: EstimatorKind) -> None:
    """Do once all that an estimator can be asked."""
    estimator = _make(EstimatorConfig(), Deck(antenna_to_pad_m=(1.0, 0.0, 0.0), half_width_m=10.0), kind)
    sizes = {Quantity.HEADING: 1, Quantity.YAW_RATE: 1, Quantity.ACCELERATION: 1, Quantity.TILT: 4, Quantity.SURFACE: 4}
    sizes[Quantity.FRAME_STEP] = 6
    memory: EstimatorMemory | None = None
    turns = (*10 * [Quantity.YAW_RATE], Quantity.VELOCITY)  # on the spot, as the first tell for long enough
    for i, quantity in enumerate((*Quantity, *Quantity, *turns)):
        value = np.full(sizes.get(quantity, 3), 0.1 if i < 2 * len(Quantity) else 3.0)
        covariance = 1e-2 * np.eye(len(value))  # so sure that it settles, and takes a tilt, too
        memory = estimator.fuse(
            memory, [Measurement(t_ns=i * 10**7, quantity=quantity, value=value, covariance=covariance)]
        )
    now_ns = 10**9
    estimator.estimate(memory, now_ns)
    estimator.forecast(memory, now_ns, np.array([0.0, 1.0]))


def _make(config: EstimatorConfig, deck: Deck, kind: EstimatorKind, *, is_silent: bool = False) -> Estimator:
    match kind:
        case EstimatorKind.LKF_REPORT | EstimatorKind.LKF:
            return _linear(config, kind)
        case EstimatorKind.UKF:
            from companion.vehicle.ukf import UkfModel  # noqa: PLC0415 (as in `_linear`)

            return _opaque(
                BufferedEstimator(model=UkfModel(config=config.ukf, point_config=config.lkf), config=config.buffer)
            )
        case EstimatorKind.IMM:
            placed_by = Quantity.PAD if is_silent else Quantity.POSITION
            imm = ImmModel(config=config.imm, deck=deck, placed_by=placed_by)
            return _opaque(BufferedEstimator(model=imm, config=config.buffer))
        case _:
            assert_never(kind)


def _linear(config: EstimatorConfig, kind: EstimatorKind) -> Estimator:
    from companion.vehicle.lkf import (  # noqa: PLC0415 (filterpy costs 0.4 s and 60 MB to load)
        LkfModel,
        ReportNoise,
        WhiteJerkNoise,
    )

    if kind is EstimatorKind.LKF_REPORT:
        ungated = config.buffer.model_copy(update={"gate_probability": None})
        return _opaque(BufferedEstimator(model=LkfModel(noise=ReportNoise(config=config.lkf_report)), config=ungated))
    return _opaque(BufferedEstimator(model=LkfModel(noise=WhiteJerkNoise(config=config.lkf)), config=config.buffer))


def _opaque(estimator: object) -> Estimator:
    """Return the estimator to those who only hand its memory on."""
    return cast("Estimator", estimator)
