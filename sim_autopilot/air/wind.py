"""Wind in W, m/s: a mean, Dryden turbulence of MIL-F-8785C at low altitude, and a gust.

With T = L / V, V the airspeed: `sigma_u sqrt(2 T) / (1 + T s)` along the mean wind, across it and vertically
`sigma sqrt(T) (1 + sqrt(3) T s) / (1 + T s)^2`, driven by white noise of unit intensity. They have the spectra of the
standard, `sigma^2 2L/pi / (1 + (L W)^2)` and `sigma^2 L/pi (1 + 3 (L W)^2) / (1 + (L W)^2)^2` over W = w / V. In time
counted in T no parameter is left: they advance exactly whatever the airspeed does, and start in their steady state.
Below 1000 ft: `sigma_w = 0.1 W20`, `sigma_u = sigma_v = sigma_w / (0.177 + 0.000823 h)^0.4`, `L_w = h`,
`L_u = L_v = h / (0.177 + 0.000823 h)^1.2`, h in feet; W20 15, 30, 45 knots (sections 3.7.2.1 and 3.7.3.4).
The standard's discrete gust rises as `V_m / 2 (1 - cos(pi x / d_m))` over the way d_m through the air and may be used
"in multiples" (section 3.7.2.3, and MIL-HDBK-1797 likewise): here it is one up and one down, with x = V t.
"""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np

from sim_autopilot.core.data import Array
from sim_autopilot.core.noise import NoiseSeed

FOOT_M = 0.3048
KNOT_M_S = 1852.0 / 3600.0
HEIGHT_M = 5.0
"""For which the benchmark states its turbulence."""
AIRSPEED_MIN_M_S = 1.0
"""Turbulence is frozen and flown through; a drone that drifts with the air would never leave its eddy."""


class Turbulence(Enum):
    """Severity, by the wind at 20 ft in knots."""

    NONE = 0
    LIGHT = 15
    MODERATE = 30
    SEVERE = 45


@dataclass(frozen=True, slots=True, kw_only=True)
class Dryden:
    """Standard deviations and lengths of the turbulence, along and across the mean wind and vertically."""

    sigma_u_m_s: float
    sigma_v_m_s: float
    sigma_w_m_s: float
    length_u_m: float
    length_v_m: float
    length_w_m: float


def dryden(turbulence: Turbulence | float, height_m: float = HEIGHT_M) -> Dryden:
    """Return the standard's parameters at `height_m`, which is below 1000 ft.

    Args:
        turbulence: severity, or the vertical standard deviation in m/s.
        height_m: above the ground.

    Raises:
        ValueError: if it is not, or not above the ground.
    """
    feet = height_m / FOOT_M
    if not 0.0 < feet <= 1000.0:
        msg = f"height_m is {height_m} m, the low-altitude model holds from 0 to {1000.0 * FOOT_M} m"
        raise ValueError(msg)
    sigma = 0.1 * turbulence.value * KNOT_M_S if isinstance(turbulence, Turbulence) else turbulence
    shape = 0.177 + 0.000823 * feet
    length = height_m / shape**1.2
    return Dryden(
        sigma_u_m_s=sigma / shape**0.4,
        sigma_v_m_s=sigma / shape**0.4,
        sigma_w_m_s=sigma,
        length_u_m=length,
        length_v_m=length,
        length_w_m=height_m,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Gust:
    """A gust that comes and goes as 1 - cos, blowing horizontally: two of the standard's, d_m = V duration / 2.

    Attributes:
        peak_m_s: at the middle.
        direction_rad: it blows towards, from east to north.
        start_s: on the wind model's clock.
        duration_s: from calm to calm.
    """

    peak_m_s: float
    direction_rad: float
    start_s: float
    duration_s: float

    def speed(self, t_s: float) -> float:
        """Return its speed, m/s, at `t_s`."""
        part = (t_s - self.start_s) / self.duration_s
        return 0.5 * self.peak_m_s * (1.0 - math.cos(2.0 * math.pi * part)) if 0.0 < part < 1.0 else 0.0


def first_order_step(state: float, elapsed: float, noise: float) -> float:
    """Return the unit first-order process `elapsed` of its time constants later."""
    remaining = math.exp(-elapsed)
    return remaining * state + math.sqrt(-math.expm1(-2.0 * elapsed)) * noise


def second_order_step(state: tuple[float, float], elapsed: float, noise: tuple[float, float]) -> tuple[float, float]:
    """Return the states of `1 / (s + 1)` and `1 / (s + 1)^2` under one white noise, `elapsed` time constants later."""
    first, second = state
    remaining = math.exp(-elapsed)
    along, across, rest = second_order_noise(elapsed)
    return (
        remaining * first + along * noise[0],
        remaining * (second + elapsed * first) + across * noise[0] + rest * noise[1],
    )


def second_order_noise(elapsed: float) -> tuple[float, float, float]:
    """Return the Cholesky factor, row by row, of both states' joint noise `int e^-2s [1 s; s s^2] ds` over a step."""
    square = math.exp(-2.0 * elapsed)
    q11 = 0.5 * (1.0 - square)
    q12 = 0.25 - square * (0.5 * elapsed + 0.25)
    q22 = 0.25 - square * (0.5 * elapsed * elapsed + 0.5 * elapsed + 0.25)
    along = math.sqrt(q11)
    across = q12 / along
    # max: for a tiny step the difference drowns in rounding
    return along, across, math.sqrt(max(0.0, q22 - across * across))


def second_order_output(state: tuple[float, float]) -> float:
    """Return `(1 + sqrt(3) s) / (1 + s)^2` of its states; its variance is 1."""
    return math.sqrt(3.0) * state[0] + (1.0 - math.sqrt(3.0)) * state[1]


class WindModel:
    """The wind at one place that moves through the air; the same seed and steps give the same wind."""

    def __init__(
        self,
        seed: NoiseSeed,
        mean_m_s: float,
        direction_rad: float,
        turbulence: Turbulence | float,
        *,
        gust: Gust | None = None,
    ) -> None:
        """Start in the steady state.

        Args:
            seed: of the turbulence, or the generator that draws it.
            mean_m_s: speed.
            direction_rad: the mean wind blows towards, from east to north.
            turbulence: severity, or the vertical standard deviation in m/s.
            gust: one, or none.
        """
        self._generator = np.random.default_rng(seed)
        self._mean_m_s = mean_m_s
        self._along = (math.cos(direction_rad), math.sin(direction_rad))
        self._dryden = dryden(turbulence)
        self._gust = gust
        self._t_s = 0.0
        n = self._generator.standard_normal(5).tolist()
        self._u = n[0]
        # the steady covariance of both states is [1/2 1/4; 1/4 1/4]
        self._v, self._w = ((math.sqrt(0.5) * a, math.sqrt(0.125) * (a + b)) for a, b in ((n[1], n[2]), (n[3], n[4])))

    def advance(self, dt_s: float, airspeed_m_s: float) -> Array:
        """Return the wind (3,), m/s in W, `dt_s` later for a drone that flew through it at `airspeed_m_s`."""
        self._t_s += dt_s
        wind_u, wind_v, wind_w = self._mean_m_s, 0.0, 0.0
        parameters = self._dryden
        if parameters.sigma_w_m_s > 0.0:
            path = max(airspeed_m_s, AIRSPEED_MIN_M_S) * dt_s
            n = self._generator.standard_normal(5).tolist()
            self._u = first_order_step(self._u, path / parameters.length_u_m, n[0])
            self._v = second_order_step(self._v, path / parameters.length_v_m, (n[1], n[2]))
            self._w = second_order_step(self._w, path / parameters.length_w_m, (n[3], n[4]))
            wind_u += parameters.sigma_u_m_s * self._u
            wind_v = parameters.sigma_v_m_s * second_order_output(self._v)
            wind_w = parameters.sigma_w_m_s * second_order_output(self._w)
        cosine, sine = self._along
        wind = np.array([cosine * wind_u - sine * wind_v, sine * wind_u + cosine * wind_v, wind_w])
        if self._gust is not None:
            speed = self._gust.speed(self._t_s)
            wind[0] += speed * math.cos(self._gust.direction_rad)
            wind[1] += speed * math.sin(self._gust.direction_rad)
        return wind
