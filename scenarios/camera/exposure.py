"""Light and sensor: how long and how sensitively a picture is exposed, and how noisy it is then.

Model: the sensor counts electrons in proportion to illuminance, albedo and exposure; 10,000 fill a pixel (3 um, as in
small global-shutter sensors). The camera exposes so that white print is at 70 % of that: longer first, as far as
allowed, then with gain. Noise: sqrt of the electrons (shot) and 4 of reading (data sheets state 3 to 5).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

_FULL_ELECTRONS = 10_000.0
_READ_ELECTRONS = 4.0
_PEDESTAL = 4.0  # shades of black
_SHADES = 255.0
_GOAL = 0.7
_WHITE_ALBEDO = 0.8
_ELECTRONS_LX_S = 720.0
"""Through a lens of F 2.4: a lux on albedo 1 makes 1 / (4 * 2.4^2) lx on the sensor; 4,090 photons/(lx um^2 s) at
555 nm, 9 um^2, and 0.45 of them counted."""
EXPOSURE_MIN_S, EXPOSURE_MAX_S = 0.0001, 0.008
GAIN_MAX = 16.0


class Exposure(NamedTuple):
    """How a picture is exposed."""

    duration_s: float
    gain: float

    @property
    def shades_lx(self) -> float:
        """Shades for a lux on a surface of albedo 1."""
        return _ELECTRONS_LX_S * self.duration_s * self.gain * _SHADES / _FULL_ELECTRONS


def exposure_for(white_lx: float) -> Exposure:
    """Return how a camera exposes a white print under `white_lx`."""
    wanted = _GOAL * _FULL_ELECTRONS / (_ELECTRONS_LX_S * _WHITE_ALBEDO * max(white_lx, 1e-6))
    duration_s = min(max(wanted, EXPOSURE_MIN_S), EXPOSURE_MAX_S)
    return Exposure(duration_s, min(max(wanted / duration_s, 1.0), GAIN_MAX))


def develop(shades: NDArray[np.float32], exposure: Exposure, noise: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Return the picture that the sensor gives.

    Args:
        shades: (rows, columns) without noise and limits.
        exposure: how it was exposed.
        noise: standard normal, of the same shape.
    """
    electrons_shade = _FULL_ELECTRONS / (_SHADES * exposure.gain)
    variance = np.maximum(shades, 0.0) * np.float32(1.0 / electrons_shade)
    variance += np.float32((_READ_ELECTRONS / electrons_shade) ** 2)
    noisy = shades + np.float32(_PEDESTAL) + np.sqrt(variance) * noise
    return np.clip(noisy + np.float32(0.5), 0.0, _SHADES).astype(np.uint8)
