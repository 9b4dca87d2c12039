from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from companion.eyes.calibration import check_size, dump_calibration, load_calibration
from companion.eyes.camera import Camera, Model, matrix_of
from companion.eyes.mounting import load_mounting
from link.errors import UserError

MATRIX = np.array([[612.0, 0.0, 631.5], [0.0, 615.0, 348.0], [0.0, 0.0, 1.0]])
CAMERAS = [
    Camera(
        model="pinhole", matrix=MATRIX, distortion=np.array([-0.11, 0.03, 0.0006, -0.0004, -0.002]), size_px=(1280, 720)
    ),
    Camera(model="fisheye", matrix=MATRIX, distortion=np.array([0.03, -0.012, 0.004, -0.001]), size_px=(1280, 720)),
]
ROTATION, TRANSLATION = np.array([2.9, 0.2, -0.3]), np.array([0.1, -0.07, 1.3])
ROS = """
image_width: 1280
image_height: 720
camera_name: pad
camera_matrix: {rows: 3, cols: 3, data: [612.0, 0.0, 631.5, 0.0, 615.0, 348.0, 0.0, 0.0, 1.0]}
distortion_model: %s
distortion_coefficients: {rows: 1, cols: 4, data: %s}
"""
ROS_MATRIX = "[612.0, 0.0, 631.5, 0.0, 615.0, 348.0, 0.0, 0.0, 1.0]"


def of_matrix(data: str) -> str:
    """ROS's file with another matrix: transposed as MATLAB has it, cut short, of larger pictures, or skewed."""
    return ROS.replace(ROS_MATRIX, data) % ("plumb_bob", "[0, 0, 0, 0]")


KALIBR = """
cam0:
  camera_model: pinhole
  intrinsics: [612.0, 615.0, 631.5, 348.0]
  distortion_model: %s
  distortion_coeffs: %s
  resolution: [1280, 720]
  rostopic: /camera
"""


def places() -> NDArray[np.float64]:
    return np.column_stack([np.random.default_rng(4).uniform(-0.6, 0.6, (20, 2)), np.zeros(20)])


@pytest.mark.parametrize("camera", CAMERAS, ids=["pinhole", "fisheye"])
def test_a_pixel_looks_where_what_it_shows_is(camera: Camera) -> None:
    pixels, _ = camera.pixels(places(), ROTATION, TRANSLATION)
    in_c = places() @ matrix_of(ROTATION).T + TRANSLATION
    assert camera.rays(pixels) == pytest.approx(in_c[:, :2] / in_c[:, 2:], abs=1e-7)


@pytest.mark.parametrize("camera", CAMERAS, ids=["pinhole", "fisheye"])
def test_the_slopes_of_pixels_are_their_differences(camera: Camera) -> None:
    step = 1e-6
    pose = np.concatenate([ROTATION, TRANSLATION])
    _, slopes = camera.pixels(places(), ROTATION, TRANSLATION)
    for index in range(6):
        shift = step * np.eye(6)[index]
        after, _ = camera.pixels(places(), *np.split(pose + shift, 2))
        before, _ = camera.pixels(places(), *np.split(pose - shift, 2))
        assert slopes[:, :, index] == pytest.approx((after - before) / (2.0 * step), abs=1e-4)


def test_what_is_behind_the_camera_or_beside_the_picture_is_not_in_view() -> None:
    ahead, behind, beside = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [5.0, 0.0, 1.0]])
    seen = CAMERAS[0].in_view(np.array([ahead, behind, beside]), np.zeros(3), np.zeros(3))
    assert seen.tolist() == [True, False, False]


@pytest.mark.parametrize(
    ("text", "model", "distortion"),
    [
        (ROS % ("plumb_bob", "[-0.11, 0.03, 0.0006, -0.0004, 0.0]"), "pinhole", [-0.11, 0.03, 0.0006, -0.0004, 0.0]),
        (ROS % ("equidistant", "[0.03, -0.01, 0.0, 0.0]"), "fisheye", [0.03, -0.01, 0.0, 0.0]),
        (KALIBR % ("radtan", "[-0.11, 0.03, 0.0006, -0.0004]"), "pinhole", [-0.11, 0.03, 0.0006, -0.0004]),
        (KALIBR % ("equidistant", "[0.03, -0.01, 0.0, 0.0]"), "fisheye", [0.03, -0.01, 0.0, 0.0]),
    ],
)
def test_calibrations_of_ros_and_kalibr_are_read(
    tmp_path: Path, text: str, model: Model, distortion: list[float]
) -> None:
    (tmp_path / "camera.yaml").write_text(text, encoding="utf-8")
    camera = load_calibration(tmp_path / "camera.yaml")
    assert (camera.model, camera.size_px, camera.distortion.tolist()) == (model, (1280, 720), distortion)
    assert camera.matrix == pytest.approx(MATRIX)


@pytest.mark.parametrize("camera", CAMERAS, ids=["pinhole", "fisheye"])
def test_a_written_calibration_is_read_back(tmp_path: Path, camera: Camera) -> None:
    (tmp_path / "camera.yaml").write_text(dump_calibration(camera), encoding="utf-8")
    back = load_calibration(tmp_path / "camera.yaml")
    assert (back.model, back.size_px) == (camera.model, camera.size_px)
    assert (back.matrix == camera.matrix).all()
    assert (back.distortion == camera.distortion).all()


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("a: [1", "no YAML"),
        ("a: 1", "needs camera_matrix"),
        (ROS % ("plumb_bob", "[1, 2, 3]"), "3 distortion coefficients do not fit"),
        (ROS % ("spherical", "[0, 0, 0, 0]"), "'spherical' is not known"),
        (ROS % ("plumb_bob", "[.nan, 0, 0, 0]"), "all numbers finite"),
        (of_matrix("[612, 0, 0, 0, 615, 0, 631.5, 348, 1]"), "fx 0 cx, 0 fy cy, 0 0 1, row by row"),
        (of_matrix("[612, 0, 631.5, 0, 615, 348]"), "camera_matrix has 6 numbers, not 9"),
        (of_matrix("[1224, 0, 1263, 0, 1230, 696, 0, 0, 1]"), "1263, 696 is not near the middle of 1280 x 720"),
        (of_matrix("[306, 0, 315.7, 0, 307, 174, 0, 0, 1]"), r"315\.7, 174 is not near the middle of 1280 x 720"),
        (of_matrix("[612, 1.2, 631.5, 0, 615, 348, 0, 0, 1]"), "a skew of 1.2 px is not modelled"),
        (
            of_matrix("[3.6, 0, 631.5, 0, 3.6, 348, 0, 0, 1]"),
            "3.6 and 3.6 px: are they in millimetres",
        ),
        ("cam0: {camera_model: pinhole}", "missing required field `intrinsics`"),
    ],
)
def test_a_wrong_calibration_is_refused_with_its_file(tmp_path: Path, text: str, why: str) -> None:
    (tmp_path / "camera.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(UserError, match=why) as refused:
        load_calibration(tmp_path / "camera.yaml")
    assert "camera.yaml" in str(refused.value)


def test_skew_that_moves_no_pixel_by_half_of_one_is_left_out(tmp_path: Path) -> None:
    text = of_matrix("[612.0, 0.7, 631.5, 0.0, 615.0, 348.0, 0.0, 0.0, 1.0]")
    (tmp_path / "camera.yaml").write_text(text, encoding="utf-8")
    assert load_calibration(tmp_path / "camera.yaml").size_px == (1280, 720)


def test_a_picture_of_another_size_is_refused_with_both_sizes() -> None:
    with pytest.raises(UserError, match="640 x 480 pixels and the calibration is for 1280 x 720"):
        check_size(CAMERAS[0], (640, 480))


def test_a_camera_that_is_not_turned_looks_down_with_its_upper_edge_forwards() -> None:
    mounting = load_mounting(None)
    down, forward = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])
    assert (mounting.R_BC.T @ down).tolist() == [0.0, 0.0, 1.0]
    assert (mounting.R_BC.T @ forward).tolist() == [0.0, -1.0, 0.0]  # up in the picture


def test_a_camera_pitched_up_sees_ahead_and_one_yawed_left_has_that_above(tmp_path: Path) -> None:
    (tmp_path / "m.toml").write_text("pitch_rad = -0.5\n", encoding="utf-8")
    axis = load_mounting(tmp_path / "m.toml").R_BC[:, 2]
    assert axis == pytest.approx([np.sin(0.5), 0.0, -np.cos(0.5)])
    (tmp_path / "m.toml").write_text(f"yaw_rad = {0.5 * np.pi}\n", encoding="utf-8")
    upwards = load_mounting(tmp_path / "m.toml").R_BC @ [0.0, -1.0, 0.0]
    assert upwards == pytest.approx([0.0, 1.0, 0.0])
