"""Rotation matrices, by scipy."""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from link.messages import Quaternion


def matrix_of(q_AB: Quaternion) -> NDArray[np.float64]:
    """Return R_AB (3, 3), for which `R_AB @ r_B` is `r_A`, of a Hamilton quaternion, wxyz."""
    return np.asarray(Rotation.from_quat(q_AB, scalar_first=True).as_matrix())
