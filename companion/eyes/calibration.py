"""Calibrations of cameras from files: ROS camera_info, as camera_calibration writes it, and kalibr's camchain."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

import msgspec
import numpy as np
from msgspec import Struct
from numpy.typing import NDArray
from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from companion.eyes.camera import Camera, Model
from link.errors import UserError
from link.program.text import read_text

_ROS_MODELS: dict[str, Model] = {
    "plumb_bob": "pinhole",
    "rational_polynomial": "pinhole",
    "equidistant": "fisheye",
    "fisheye": "fisheye",
}
_KALIBR_MODELS: dict[str, Model] = {"radtan": "pinhole", "none": "pinhole", "equidistant": "fisheye", "equi": "fisheye"}
_ROS_MODEL_OF_COUNT = {
    0: "plumb_bob",
    4: "plumb_bob",
    5: "plumb_bob",
    8: "rational_polynomial",
    12: "rational_polynomial",
    14: "rational_polynomial",
}
_MATRIX = 9  # numbers, row by row
# Of the larger side. Lens holders are true to some tenths of a millimetre: 0.5 mm are 0.14 of a sensor of 1/4 inch.
_DECENTRED_SHARE_MAX = 0.2
_SKEWED_MAX_PX = 0.5  # root mean square of a good calibration
_HALF_VIEW_MAX: dict[Model, float] = {"pinhole": math.tan(math.radians(85.0)), "fisheye": math.radians(140.0)}
"""Half of what the picture's longer side shows, in focal lengths: more than any lens of the model does."""
_RADII = 1000
_COEFFICIENTS: dict[Model, tuple[int, ...]] = {"pinhole": (0, 4, 5, 8, 12, 14), "fisheye": (4,)}


def load_calibration(path: Path) -> Camera:
    """Return the camera that a file describes.

    Raises:
        UserError: the file cannot be read, or is neither of the two formats.
    """
    try:
        table = YAML(typ="safe", pure=True).load(read_text(path))
    except (YAMLError, ValueError) as error:
        raise UserError(f"{path}: no YAML ({' '.join(str(error).split())[:120]})") from None
    except RecursionError:
        raise UserError(f"{path}: no YAML (nested too deep)") from None
    if isinstance(table, dict) and "camera_matrix" in table:
        return _read(path, table, _RosFile, _from_ros)
    if isinstance(table, dict) and isinstance(table.get("cam0"), dict):
        return _read(path, table["cam0"], _KalibrCamera, _from_kalibr)
    raise UserError(f"{path}: no calibration: it needs camera_matrix, as ROS has it, or cam0, as kalibr has it")


def check_size(camera: Camera, size_px: tuple[int, int]) -> None:
    """Check that a picture is of the size for which the camera was calibrated.

    Raises:
        UserError: it is another one.
    """
    if size_px != camera.size_px:
        raise UserError(
            "the camera gives {} x {} pixels and the calibration is for {} x {}: set --size, or calibrate again".format(
                *size_px, *camera.size_px
            )
        )


class _Matrix(Struct):
    data: list[float]


class _RosFile(Struct):
    """What is read of ROS's camera_info file."""

    image_width: int
    image_height: int
    camera_matrix: _Matrix
    distortion_model: str
    distortion_coefficients: _Matrix


class _KalibrCamera(Struct):
    """What is read of a camera of kalibr's camchain."""

    camera_model: str
    intrinsics: tuple[float, float, float, float]
    resolution: tuple[int, int]
    distortion_model: str
    distortion_coeffs: list[float]


_File = TypeVar("_File", _RosFile, _KalibrCamera)


def _read(path: Path, table: object, kind: type[_File], camera_of: Callable[[_File], Camera]) -> Camera:
    try:
        return camera_of(msgspec.convert(table, kind, strict=False))
    except ValueError as error:  # what msgspec finds is one, too
        raise UserError(f"{path}: {' '.join(str(error).split())}") from None


def _from_ros(file: _RosFile) -> Camera:
    if len(file.camera_matrix.data) != _MATRIX:
        raise ValueError(f"camera_matrix has {len(file.camera_matrix.data)} numbers, not {_MATRIX}")
    matrix = np.array(file.camera_matrix.data).reshape(3, 3)
    model = _known(_ROS_MODELS, file.distortion_model)
    return _camera(model, matrix, file.distortion_coefficients.data, (file.image_width, file.image_height))


def _from_kalibr(camera: _KalibrCamera) -> Camera:
    if camera.camera_model != "pinhole":
        raise ValueError(f"camera_model {camera.camera_model!r} is not known; pinhole is")
    fx, fy, cx, cy = camera.intrinsics
    matrix = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    return _camera(_known(_KALIBR_MODELS, camera.distortion_model), matrix, camera.distortion_coeffs, camera.resolution)


def _known(models: dict[str, Model], name: str) -> Model:
    if name not in models:
        raise ValueError(f"distortion_model {name!r} is not known; {', '.join(models)} are")
    return models[name]


def _camera(
    model: Model, matrix: NDArray[np.float64], coefficients: Sequence[float], size_px: tuple[int, int]
) -> Camera:
    distortion = np.array(coefficients, np.float64)
    if len(distortion) not in _COEFFICIENTS[model]:
        raise ValueError(f"{len(distortion)} distortion coefficients do not fit the model {model}")
    numbers = [*matrix.ravel().tolist(), *distortion.tolist()]
    if (
        not all(math.isfinite(number) for number in numbers)
        or min(matrix[0, 0], matrix[1, 1]) <= 0.0
        or min(size_px) <= 0
    ):
        raise ValueError("focal lengths and size must be above 0, and all numbers finite")
    _check_matrix(matrix, size_px)
    _check_focal(model, matrix, size_px)
    if model == "pinhole":
        _check_folds(matrix, distortion, size_px)
    return Camera(model=model, matrix=matrix, distortion=distortion, size_px=size_px)


def _check_matrix(matrix: NDArray[np.float64], size_px: tuple[int, int]) -> None:
    """Check that a matrix is one of these models', row by row, and for pictures of this size.

    The matrix of pictures of twice or half the size has the lens's axis elsewhere. OpenCV's models have no skew. Those
    of fisheyes that state one are read if it moves no pixel by more than what is left of a good calibration.
    """
    (fx, skew, cx), (_, fy, cy) = matrix[:2].tolist()
    if not np.array_equal(matrix, np.array([[fx, skew, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])):
        raise ValueError(
            f"the camera matrix must be fx 0 cx, 0 fy cy, 0 0 1, row by row, not {matrix.ravel().tolist()}"
        )
    width, height = size_px
    if max(abs(cx - 0.5 * width), abs(cy - 0.5 * height)) > _DECENTRED_SHARE_MAX * max(size_px):
        raise ValueError(
            f"the axis at {cx:g}, {cy:g} is not near the middle of {width} x {height}: "
            "give the matrix of pictures of that size"
        )
    if abs(skew) * max(cy, height - cy) / fy > _SKEWED_MAX_PX:
        raise ValueError(f"a skew of {skew:g} px is not modelled: calibrate with it fixed at 0")


def _check_focal(model: Model, matrix: NDArray[np.float64], size_px: tuple[int, int]) -> None:
    """Check that the focal lengths are ones in pixels; those of a data sheet are in millimetres."""
    focal_px, half_px = (matrix[0, 0], matrix[1, 1]), (0.5 * size_px[0], 0.5 * size_px[1])
    if any(half > _HALF_VIEW_MAX[model] * focal for focal, half in zip(focal_px, half_px, strict=True)):
        raise ValueError(
            "no {} lens shows {} x {} pixels by focal lengths of {:g} and {:g} px: are they in millimetres?".format(
                model, *size_px, *focal_px
            )
        )


def _check_folds(matrix: NDArray[np.float64], distortion: NDArray[np.float64], size_px: tuple[int, int]) -> None:
    """Check that the radial coefficients lead outwards as far as the middles of the picture's sides.

    Many good calibrations fold beyond these, in the corners. Within them what is seen has no direction: such
    coefficients are of another model or in another order.
    """
    k1, k2, _, _, k3, k4, k5, k6 = np.pad(distortion, (0, max(8 - len(distortion), 0)))[:8].tolist()
    r = np.linspace(0.0, _HALF_VIEW_MAX["pinhole"], _RADII)
    told = r * (1.0 + r**2 * (k1 + r**2 * (k2 + r**2 * k3))) / (1.0 + r**2 * (k4 + r**2 * (k5 + r**2 * k6)))
    falls = np.flatnonzero(np.diff(told) <= 0.0)
    reach = float(told[falls[0]]) if len(falls) else math.inf
    side_px, focal_px = max(zip(size_px, (matrix[0, 0], matrix[1, 1]), strict=True))
    if reach < 0.5 * side_px / focal_px:
        raise ValueError(
            f"the distortion coefficients fold the picture at {reach * focal_px:.0f} pixels from its middle: "
            "are they of this model, and in its order?"
        )


def dump_calibration(camera: Camera) -> str:
    """Return the camera as ROS's camera_info file has it."""
    width, height = camera.size_px
    model = "equidistant" if camera.model == "fisheye" else _ROS_MODEL_OF_COUNT[len(camera.distortion)]
    matrix, distortion = camera.matrix.ravel().tolist(), camera.distortion.tolist()
    return (
        f"image_width: {width}\nimage_height: {height}\ncamera_name: camera\n"
        f"camera_matrix: {{rows: 3, cols: 3, data: {matrix}}}\n"
        f"distortion_model: {model}\n"
        f"distortion_coefficients: {{rows: 1, cols: {len(distortion)}, data: {distortion}}}\n"
    )
