"""How much the points of edges err, from what is left of their distances once a pose has been fitted to them; pure.

Model: a point's error is noise of its own (sensor, sampling) and what all points of its edge share (blur, light, the
print's edge, a bend of the plate). Blur, contrast and size are all in what is left, so none of them is modelled. A pose
moves an edge by a shift and a slope: what is left of these two, edge by edge, says how well the edges agree with one
another, and so how far the pose may be off. What is left beside them is the points' own noise; the edges do not agree
better than that allows but by chance, of which there is much where one tag of four edges is all that is seen.
Source: analysis of variance with random effects (Searle, Casella and McCulloch 1992, chapter 3), one per edge.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_POSE = 6  # what is fitted: rotation and translation


def variance_px2(left_px: Array, weights: Array, edges: NDArray[np.int64]) -> float:
    """Return the variance by which the inverse of the curvature becomes the covariance of the pose.

    Args:
        left_px: (N,) of the distances.
        weights: (N,) of the points, as they were fitted.
        edges: (N,) of which edge each point is, those of one together and in their order along it.
    """
    scaled = np.sqrt(weights) * left_px
    _, first, index, count = np.unique(edges, return_index=True, return_inverse=True, return_counts=True)
    along = np.arange(len(edges)) - first[index] - 0.5 * (count[index] - 1.0)
    lengths = np.bincount(index, along**2)
    has_slope = lengths > 0.0
    shifts = np.bincount(index, scaled) ** 2 / count
    slopes = np.bincount(index, along * scaled)[has_slope] ** 2 / lengths[has_slope]
    between = float(shifts.sum() + slopes.sum())
    own = max(float(scaled @ scaled) - between, 0.0)
    told = len(count) + int(has_slope.sum())
    return max(between / max(told - _POSE, 1), own / max(len(edges) - told, 1))
