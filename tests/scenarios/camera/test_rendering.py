import tracemalloc

import numpy as np
import pytest
from numpy.typing import NDArray

from companion.eyes.board import load_board
from companion.eyes.camera import vector_of
from companion.eyes.picture import Box, whole
from link.records import replace
from scenarios.camera.exposure import EXPOSURE_MAX_S, GAIN_MAX, develop, exposure_for
from scenarios.camera.lens import CAMERA, SIZE_PX, defocus_std_px, smear
from scenarios.camera.lighting import Light
from scenarios.camera.planes import View
from scenarios.camera.rendering import Renderer, Vehicle
from tests.companion.eyes.frames import DAY, MOUNTING, ROOF_M

CAR = Vehicle(board=load_board(None).config, length_m=4.2, width_m=1.8, roof_height_m=ROOF_M)
UP = np.array([0.0, 0.0, 1.0])
ABOVE = np.array([0.2, -0.1, ROOF_M + 3.0])
STILL = View(
    R_VC=MOUNTING.R_BC,
    camera_m=ABOVE,
    velocity_m_s=np.zeros(3),
    turning_c_rad_s=np.zeros(3),
    drone_m=ABOVE,
)


def render(light: Light = DAY, view: View = STILL, box: Box | None = None, seed: int = 1) -> NDArray[np.uint8]:
    return Renderer(CAR, 0.0, np.random.default_rng(seed)).render(view, light, whole(SIZE_PX) if box is None else box)


def shade_at(picture: NDArray[np.uint8], forward_m: float, left_m: float, view: View = STILL) -> float:
    """The mean of 3 by 3 pixels where a place on the roof is seen."""
    place = np.array([[forward_m, left_m, ROOF_M]])
    R_CV = view.R_VC.T
    pixels, _ = CAMERA.pixels(place, vector_of(R_CV), -R_CV @ view.camera_m)
    column, row = np.round(pixels[0]).astype(int)
    return float(picture[row - 1 : row + 2, column - 1 : column + 2].mean())


@pytest.mark.slow
def test_the_same_seed_gives_the_same_picture_and_another_one_other_noise() -> None:
    assert (render() == render()).all()
    assert (render(seed=1) != render(seed=2)).any()


def test_places_of_the_board_are_seen_where_the_camera_model_has_them() -> None:
    picture = render()
    white, black = shade_at(picture, 0.68, 0.68), shade_at(picture, 0.52, 0.52)
    assert white > 2.5 * black
    assert shade_at(picture, 0.68, -0.68) > 2.5 * shade_at(picture, 0.52, -0.52)


@pytest.mark.slow
def test_a_part_is_what_the_whole_has_there() -> None:
    # without their noise: large parts are rendered by one point a pixel, small ones by four
    box = Box(500, 250, 700, 450)
    part = render(box=box).astype(float)
    there = render()[box.top : box.bottom, box.left : box.right].astype(float)
    assert abs(part.mean() - there.mean()) < 0.5
    assert np.corrcoef(part.ravel(), there.ravel())[0, 1] > 0.98


@pytest.mark.slow
def test_the_drone_shades_the_pad_under_the_sun_and_not_under_clouds() -> None:
    sun = np.array([0.0, 0.0, 1.0])
    under = (ABOVE[0], ABOVE[1])
    sunny, cloudy = (render(Light(daylight_lx=50_000.0, sun_v=one)) for one in (sun, None))
    assert shade_at(sunny, *under) < 0.5 * shade_at(cloudy, *under)
    assert shade_at(sunny, 0.68, 0.68) == pytest.approx(shade_at(cloudy, 0.68, 0.68), rel=0.1)


@pytest.mark.slow
def test_a_lamp_lights_what_is_near_and_nothing_far_off() -> None:
    lamp = Light(daylight_lx=0.1, lamp_lm=1500.0)
    far = replace(STILL, camera_m=40.0 * UP + ABOVE, drone_m=40.0 * UP + ABOVE)
    assert np.ptp(render(lamp)) > 100
    assert np.percentile(render(lamp, far), 99) < 30


@pytest.mark.slow
def test_a_camera_that_turns_smears_edges_along_its_motion_only() -> None:
    turning = replace(STILL, turning_c_rad_s=np.array([0.0, 3.0, 0.0]))  # about the picture's vertical
    dusk = Light(daylight_lx=40.0)
    still, moved = (render(dusk, view).astype(float) for view in (STILL, turning))
    along, across = (
        np.abs(np.diff(moved, axis=axis)).max() / np.abs(np.diff(still, axis=axis)).max() for axis in (1, 0)
    )
    assert along < 0.5
    assert across > 0.7


@pytest.mark.slow
def test_a_pad_far_beside_a_drone_on_the_road_takes_no_more_memory_than_one_in_view() -> None:
    # as a scenario begins: the vehicle 40 m away, in its roof's plane, and 8 ms of exposure at dusk
    beside = np.array([40.0, 2.0, ROOF_M - 1.4])
    view = replace(STILL, camera_m=beside, drone_m=beside, velocity_m_s=np.array([0.0, 0.0, 0.05]))
    tracemalloc.start()
    render(Light(daylight_lx=40.0), view, Box(0, 0, 64, 48))
    _, peak_bytes = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak_bytes < 500e6


def test_smearing_keeps_the_light_and_moves_nothing() -> None:
    point = np.zeros((41, 41), np.float32)
    point[20, 20] = 1.0
    smeared = smear(point, np.array([7.3, -4.1]))
    rows, columns = np.mgrid[:41, :41]
    assert float(smeared.sum()) == pytest.approx(1.0, abs=1e-5)
    assert float((smeared * rows).sum()) == pytest.approx(20.0, abs=0.01)
    assert float((smeared * columns).sum()) == pytest.approx(20.0, abs=0.01)


def test_blur_is_least_in_focus() -> None:
    depths_m = [0.1, 0.3, 1.2, 5.0, 20.0]
    assert min(depths_m, key=defocus_std_px) == 1.2
    assert defocus_std_px(0.1) > 2.0 * defocus_std_px(1.2)


@pytest.mark.parametrize("white_lx", [100_000.0, 900.0, 150.0])
def test_white_is_exposed_alike_while_time_and_gain_suffice(white_lx: float) -> None:
    exposure = exposure_for(white_lx)
    assert 0.8 * white_lx * exposure.shades_lx == pytest.approx(0.7 * 255.0, rel=0.01)


def test_in_the_dark_time_and_gain_are_at_their_limits() -> None:
    assert exposure_for(0.5) == (EXPOSURE_MAX_S, GAIN_MAX)


def test_noise_is_that_of_the_counted_electrons() -> None:
    exposure = exposure_for(100.0)
    noise = np.random.default_rng(5).standard_normal((300, 300)).astype(np.float32)
    picture = develop(np.full((300, 300), 120.0, np.float32), exposure, noise)
    electrons_shade = 10_000.0 / 255.0 / exposure.gain
    expected = np.sqrt(120.0 * electrons_shade + 16.0) / electrons_shade
    assert float(picture.std()) == pytest.approx(expected, rel=0.03)
