"""The two sets of noise that the linear filter can run with: the source report's, and white jerk."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from companion.config.estimation import LkfConfig, LkfReportConfig
from companion.core.data import Array, Measurement, Quantity

I3 = np.eye(3)


class LkfNoise(Protocol):
    """What the linear filter believes about its start, its model and its sensors."""

    def initial(self, fix: Measurement) -> Array:
        """Return the covariance `(9, 9)` after a first position."""

    def process(self, dt_s: float) -> Array:
        """Return Q `(9, 9)` of one prediction over `dt_s`."""

    def position_variance(self, t_s: Array) -> Array:
        """Return what Q has added to each axis's position after `t_s` (n, 1), m^2: `(n, 3)`."""

    def sensor(self, measurement: Measurement) -> Array | None:
        """Return R `(3, 3)`, or None when this filter has no use for the measurement."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportNoise:
    """The report's: the same variance for every state at every step, positions only."""

    config: LkfReportConfig

    def initial(self, fix: Measurement) -> Array:  # noqa: ARG002 (the report starts the same whatever the fix)
        """Return P0."""
        return self.config.initial_variance * np.eye(9)

    def process(self, dt_s: float) -> Array:
        """Return the variance of as many steps as `dt_s` holds."""
        return self._rate() * dt_s * np.eye(9)

    def position_variance(self, t_s: Array) -> Array:
        """Return the sum over all steps in the limit of short ones, the same for the three axes."""
        return np.tile(self._rate() * (t_s + t_s**3 / 3 + t_s**5 / 20), 3)

    def sensor(self, measurement: Measurement) -> Array | None:
        """Return the report's R for a position."""
        return self.config.fix_variance_m2 * I3 if measurement.quantity is Quantity.POSITION else None

    def _rate(self) -> float:
        return self.config.step_variance / self.config.step_s


@dataclass(frozen=True, slots=True, kw_only=True)
class WhiteJerkNoise:
    """Continuous white jerk, and the sensors' own covariances for positions and velocities."""

    config: LkfConfig

    def initial(self, fix: Measurement) -> Array:
        """Return the fix's covariance beside the priors of velocity and acceleration."""
        covariance = np.zeros((9, 9))
        covariance[:3, :3] = fix.covariance
        covariance[3:6, 3:6] = self.config.initial_speed_std_m_s**2 * I3
        covariance[6:, 6:] = self.config.initial_acceleration_std_m_s2**2 * I3
        return covariance

    def process(self, dt_s: float) -> Array:
        """Return white jerk integrated over `dt_s` (Bar-Shalom, Li and Kirubarajan 2001, eq. 6.2.3-9)."""
        d = dt_s
        axis = np.array([[d**5 / 20, d**4 / 8, d**3 / 6], [d**4 / 8, d**3 / 3, d**2 / 2], [d**3 / 6, d**2 / 2, d]])
        return np.kron(axis, np.diag(self._psd()))

    def position_variance(self, t_s: Array) -> Array:
        """Return the first entry of `process`, for each axis."""
        return np.asarray(t_s**5 / 20 * self._psd())

    def sensor(self, measurement: Measurement) -> Array | None:
        """Return the measurement's own covariance."""
        return measurement.covariance if measurement.quantity in (Quantity.POSITION, Quantity.VELOCITY) else None

    def _psd(self) -> Array:
        horizontal = self.config.jerk_psd_m2_s5
        return np.array([horizontal, horizontal, self.config.vertical_jerk_psd_m2_s5])
