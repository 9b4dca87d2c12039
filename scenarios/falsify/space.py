"""The space that is searched: a world's quantities as independent standard normal numbers, and which are plausible.

A quantity is drawn by a uniform number u in (0, 1); here it is z = Phi^-1(u), so that every quantity, whatever its
distribution, has its median at 0 and the same scale, and the density of a world falls with its distance from the origin
alone (the transformation of Rosenblatt 1952, as structural reliability uses it). A plausible world has

- each quantity within 3 standard deviations: no value that is rarer than one in 740, counted on both sides,
- all together no farther from the medians than 99 of 100 drawn worlds are.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm

Array = NDArray[np.float64]

MEDIAN = 0.5
"""As a uniform number."""
Z_MAX = 3.0
_INSIDE_SHARE = 0.99
_SLOTS = 4  # of the road's elements and the driver's events: more does not fit into the half minute of a landing


def searched(names: Sequence[str], only: Sequence[str] = ()) -> tuple[str, ...]:
    """Return those of a world's quantities that a search chooses: of what recurs, such as bends, the first ones.

    Args:
        names: of all quantities.
        only: first parts of names, such as `driver`; empty for all.
    """
    chosen = (name for name in names if not only or name.partition(".")[0] in only)
    slots = ((name, name.rpartition(".")[2]) for name in chosen)
    return tuple(name for name, slot in slots if not slot.isdigit() or int(slot) < _SLOTS)


def radius_max(dimension: int) -> float:
    """Return how far from the medians a plausible world of so many quantities is at most."""
    return float(np.sqrt(chi2.ppf(_INSIDE_SHARE, dimension)))


def plausible(z: Array) -> Array:
    """Return the plausible world near `z` (n,): cut at the bounds of each quantity, then drawn in to the radius."""
    cut = np.clip(z, -Z_MAX, Z_MAX)
    distance = float(np.linalg.norm(cut))
    radius = radius_max(len(z))
    return cut if distance <= radius else cut * (radius / distance)


def uniforms(names: Sequence[str], z: Array) -> dict[str, float]:
    """Return the uniform number of each quantity by name."""
    return dict(zip(names, norm.cdf(z).tolist(), strict=True))


def normal(u: float) -> float:
    """Return the normal number of a uniform one."""
    return float(norm.ppf(u))
