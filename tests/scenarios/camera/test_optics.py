"""A rolling shutter against pictures that are taken when each row is read, and drops that blur where they are."""

import numpy as np
import pytest
from numpy.typing import NDArray

from companion.eyes.picture import Box, whole
from link.records import replace
from scenarios.camera.lens import CAMERA, MARGIN_PX, SIZE_PX, Lens
from scenarios.camera.optics import Optics, draw_drops, rolled
from scenarios.camera.planes import View
from scenarios.camera.rendering import Renderer
from tests.companion.eyes.frames import DAY, MOUNTING, ROOF_M
from tests.scenarios.camera.test_rendering import CAR

Array = NDArray[np.float64]

READOUT_S = 0.02
ABOVE = np.array([0.2, -0.1, ROOF_M + 2.0])
MOVING = View(
    R_VC=MOUNTING.R_BC,
    camera_m=ABOVE,
    velocity_m_s=np.array([3.0, -1.5, 0.7]),
    turning_c_rad_s=np.array([0.6, -0.4, 1.1]),
    drone_m=ABOVE,
)


def turned(rate_rad_s: Array, elapsed_s: float) -> Array:
    x, y, z = rate_rad_s * elapsed_s
    return np.asarray(np.eye(3) + np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]), np.float64)


@pytest.mark.parametrize("row", [40, 360, 655])
def test_a_row_sees_what_the_camera_sees_when_it_is_read(row: int) -> None:
    box = Box(0, row, SIZE_PX[0], row + 1)
    rays = Lens(CAMERA).rays(box, is_fine=False)
    late_s = (row / (SIZE_PX[1] - 1.0) - 0.5) * READOUT_S

    def on_deck(seen: NDArray[np.float32], R_VC: Array, camera_m: Array) -> Array:
        along = np.dstack([seen, np.ones(seen.shape[:2])]) @ R_VC.T
        return np.asarray(camera_m + along * ((ROOF_M - camera_m[2]) / along[..., 2:]))

    then = on_deck(rays, MOVING.R_VC @ turned(MOVING.turning_c_rad_s, late_s), ABOVE + late_s * MOVING.velocity_m_s)
    said = on_deck(rolled(rays, box, MOVING, ROOF_M, READOUT_S), MOVING.R_VC, ABOVE)
    moved_m = np.linalg.norm(then - on_deck(rays, MOVING.R_VC, ABOVE), axis=2).max()
    assert np.linalg.norm(then - said, axis=2).max() < 0.03 * moved_m + 1e-4


@pytest.mark.slow
def test_a_window_that_is_a_tenth_wet_is_blurred_there_and_nowhere_else() -> None:
    def picture(optics: Optics) -> Array:
        view = replace(MOVING, velocity_m_s=np.zeros(3), turning_c_rad_s=np.zeros(3))
        return Renderer(CAR, 0.0, np.random.default_rng(4), optics).render(view, DAY, whole(SIZE_PX)).astype(float)

    dry, wet = picture(Optics()), picture(Optics(wet_share=0.1))
    rng = np.random.default_rng(4)
    Renderer(CAR, 0.0, rng)
    drops = draw_drops(0.1, rng)[MARGIN_PX:-MARGIN_PX, MARGIN_PX:-MARGIN_PX]
    assert drops.mean() == pytest.approx(0.1, abs=0.04)
    off = np.abs(wet - dry)
    assert off[drops > 0.9].mean() > 1.5 * off[drops < 0.01].mean()  # elsewhere noise only
