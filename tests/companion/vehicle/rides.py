"""Runs an estimator through a drive and collects what a test wants to see."""

from dataclasses import dataclass

import numpy as np

from companion.config.estimation import EstimatorConfig, EstimatorKind
from companion.core.data import Array, Measurement, VehicleEstimate
from companion.vehicle.estimator import Estimator, EstimatorMemory
from companion.vehicle.factory import make_estimator
from companion.vehicle.imm_numbers import Deck
from tests.companion.vehicle.drives import ANTENNA_TO_PAD_M, EPOCH_NS, Drive, Sensors, sense

KINDS = tuple(EstimatorKind)


def estimator(kind: EstimatorKind, config: EstimatorConfig | None = None) -> Estimator:
    return make_estimator(
        EstimatorConfig() if config is None else config, Deck(antenna_to_pad_m=ANTENNA_TO_PAD_M), kind
    )


def now_ns(t_s: float) -> int:
    return EPOCH_NS + round(t_s * 1e9)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Ride:
    """What an estimator said at each time, and the memory at the end."""

    t_s: Array
    estimates: list[VehicleEstimate]
    ahead: Array
    ahead_std: Array
    memory: EstimatorMemory | None

    def errors(self, truth: Drive) -> Array:
        return np.array([e.position_enu_m - truth.at(t)[0] for t, e in zip(self.t_s, self.estimates, strict=True)])

    def ahead_errors(self, truth: Drive, ahead_s: float) -> Array:
        there = np.array([truth.at(t + ahead_s)[0] for t in self.t_s])
        return np.asarray(self.ahead - there)


def arrivals(truth: Drive, sensors: Sensors, seed: int) -> list[Measurement]:
    return [measurement for _, measurement in sense(truth, sensors, seed)]


def ride(
    chosen: Estimator,
    truth: Drive,
    sensors: Sensors,
    seed: int,
    *,
    from_s: float = 3.0,
    until_s: float | None = None,
    ahead_s: float = 1.0,
    rate_hz: float = 10.0,
) -> Ride:
    """Deliver the measurements when they arrive and ask at `rate_hz` from `from_s` on."""
    waiting = sense(truth, sensors, seed)[::-1]
    end_s = truth.length_s - ahead_s if until_s is None else until_s
    memory: EstimatorMemory | None = None
    times, estimates, ahead, stds = [], [], [], []
    for i in range(round(end_s * rate_hz)):
        t_s = i / rate_hz
        batch = []
        while waiting and waiting[-1][0] <= now_ns(t_s):
            batch.append(waiting.pop()[1])
        memory = chosen.fuse(memory, batch)
        if t_s < from_s:
            continue
        estimate = chosen.estimate(memory, now_ns(t_s))
        forecast = chosen.forecast(memory, now_ns(t_s), np.array([0.0, ahead_s]))
        assert estimate is not None
        assert forecast is not None
        times.append(t_s)
        estimates.append(estimate)
        ahead.append(forecast.position_enu_m[1])
        stds.append(forecast.position_std_m[1])
    return Ride(
        t_s=np.array(times), estimates=estimates, ahead=np.array(ahead), ahead_std=np.array(stds), memory=memory
    )


def rms(errors: Array) -> float:
    return float(np.sqrt((errors**2).sum(axis=1).mean()))
