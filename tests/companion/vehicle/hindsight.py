"""Drives as an estimator looks back at them, for the tests of what has been noticed of a vehicle."""

from typing import Any

import numpy as np

from companion.config.estimation import EstimatorKind
from companion.core.data import VehicleEstimate
from companion.vehicle.hindsight import Hindsight, update_hindsight
from link.records import replace
from tests.companion.vehicle.drives import (
    DEGRADED,
    Drive,
    Sensors,
    sense,
)
from tests.companion.vehicle.rides import estimator, now_ns

LATE = replace(DEGRADED, delay_s=0.5)
TICK_S = 0.02


def after(truth: Drive, sensors: Sensors, seed: int, until_s: float) -> Hindsight:
    """What has been noticed of a drive, asked at 50 Hz, when each measurement has come when it comes."""
    chosen, waiting = estimator(EstimatorKind.IMM), sense(truth, sensors, seed)[::-1]
    memory: Any = None
    hindsight = Hindsight()
    for i in range(round(until_s / TICK_S)):
        batch = []
        while waiting and waiting[-1][0] <= now_ns(i * TICK_S):
            batch.append(waiting.pop()[1])
        memory = chosen.fuse(memory, batch)
        t_ns = now_ns(i * TICK_S)
        hindsight = update_hindsight(hindsight, chosen, memory, t_ns, monotonic_ns=t_ns)
    return hindsight


class Told:
    """An estimator that tells one speed, and how well it knows it."""

    def __init__(self, speed_m_s: float, variance_m2_s2: float) -> None:
        self.speed_m_s, self.variance_m2_s2 = speed_m_s, variance_m2_s2

    def newest_fix_ns(self, memory: int) -> int:
        return memory

    def estimate(self, _memory: int, t_ns: int) -> VehicleEstimate:
        covariance = np.diag([0.0] * 3 + [self.variance_m2_s2, 0.0] + [0.0] * 4)
        velocity = np.array([0.6 * self.speed_m_s, -0.8 * self.speed_m_s, 0.0])
        return VehicleEstimate(
            t_ns=t_ns,
            position_enu_m=np.zeros(3),
            velocity_enu_m_s=velocity,
            acceleration_enu_m_s2=np.zeros(3),
            covariance=covariance,
            yaw_rad=None,
            yaw_rate_rad_s=None,
        )
