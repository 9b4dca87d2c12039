"""A picture of the pad rendered from truth: surfaces on planes of V, light on them, lens, motion and sensor.

Each surface is warped by the homography of its plane, from the pyramid's level whose texels are as fine as the
picture's points; far ones are rendered twice as finely and averaged. The board is on the roof, the road is V's plane
z = 0.
Frames: V the vehicle's body (FLU, origin on the road), C the camera.
"""

import math
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from companion.eyes.board import BoardConfig
from companion.eyes.picture import Box, box_around
from scenarios.camera.exposure import develop, exposure_for
from scenarios.camera.lens import CAMERA, FOCAL_PX, MARGIN_PX, Lens, defocus_std_px, smear
from scenarios.camera.lighting import Light, glare, lamp_lit, lamp_lx
from scenarios.camera.optics import Optics, draw_drops, rolled, seen_through
from scenarios.camera.planes import View, fills, on_plane, paint, to_plane, where_on_plane
from scenarios.camera.surfaces import board_surface, road_surface, roof_surface

Array = NDArray[np.float64]
Floats = NDArray[np.float32]

_SKY_SHARE = 0.25  # of daylight that comes from all sides, also into a shadow
_BOARD_MARGIN_PX = 4.0
_FINE_AREA_PX = 90_000  # smaller parts are rendered twice as finely
_SHADOW_BODY_M, _SHADOW_ROTOR_M, _ROTOR_ARM_M, _ROTOR_SHARE = 0.13, 0.127, 0.215, 0.4
_SUN_RADIUS_RAD = 0.0047
_MOTION_MAX_PX = 400.0  # while it is exposed: more leaves no edge of a tag, and a pad far beside is said to move so
_NOISE_SIZE = 2048  # of the field from which each picture's is cut


@dataclass(frozen=True, slots=True, kw_only=True)
class Vehicle:
    """What there is to be seen; without a board its roof is bare."""

    board: BoardConfig | None
    length_m: float
    width_m: float
    roof_height_m: float
    paint: float = 0.25


class Renderer:
    """Renders parts of pictures of one vehicle.

    Args:
        vehicle: that is seen.
        dirt_share: of the board that is covered.
        rng: of the dirt, of the drops and of the noise.
        optics: shutter and drops.
    """

    def __init__(
        self, vehicle: Vehicle, dirt_share: float, rng: np.random.Generator, optics: Optics | None = None
    ) -> None:
        self._roof_height_m = vehicle.roof_height_m
        self._road = road_surface()
        self._roof = roof_surface(vehicle.length_m, vehicle.width_m, vehicle.paint)
        self._board = None if vehicle.board is None else board_surface(vehicle.board, dirt_share, rng)
        self._lens = Lens(CAMERA)
        self._noise = rng.standard_normal((_NOISE_SIZE, _NOISE_SIZE)).astype(np.float32)
        self._rng = rng
        self._readout_s = 0.0 if optics is None else optics.readout_s
        self._drops = None if optics is None or optics.wet_share == 0.0 else draw_drops(optics.wet_share, rng)

    def render(self, view: View, light: Light, box: Box) -> NDArray[np.uint8]:
        """Return the shades of a part of the picture; the noise is another one each time.

        A board that fills little of it is rendered more finely than what is around it.
        """
        shades = self._render(view, light, box, is_fine=box.area < _FINE_AREA_PX)
        fine = self._board_box(view, box)
        if box.area >= _FINE_AREA_PX and 0 < fine.area < _FINE_AREA_PX:
            rows, columns = (
                slice(fine.top - box.top, fine.bottom - box.top),
                slice(fine.left - box.left, fine.right - box.left),
            )
            shades[rows, columns] = self._render(view, light, fine, is_fine=True)
        return shades

    def _board_box(self, view: View, box: Box) -> Box:
        """Return as much of a box as the board is seen in; all of it where that cannot be told."""
        if self._board is None:
            return Box(0, 0, 0, 0)
        forward_m, left_m = self._board.corner_m
        corners = np.array([[a * forward_m, b * left_m, self._roof_height_m] for a in (-1, 1) for b in (-1, 1)])
        in_c = (corners - view.camera_m) @ view.R_VC
        if (in_c[:, 2] <= 0.05).any() or (np.abs(in_c[:, :2]) > CAMERA.radius_max * in_c[:, 2:]).any():
            return box
        pixels, _ = CAMERA.pixels(in_c, np.zeros(3), np.zeros(3))
        around = box_around(pixels, _BOARD_MARGIN_PX, CAMERA.size_px)
        return Box(
            max(around.left, box.left),
            max(around.top, box.top),
            min(around.right, box.right),
            min(around.bottom, box.bottom),
        )

    def _render(self, view: View, light: Light, box: Box, *, is_fine: bool) -> NDArray[np.uint8]:
        depth_m = self._depth_m(view)
        blur_px = math.sqrt(max(defocus_std_px(depth_m) ** 2 - 1.0 / 12.0, 0.1))
        exposure = exposure_for(light.daylight_lx + lamp_lx(light, depth_m))
        motion_px = _at_most(self._motion_px(view) * exposure.duration_s, _MOTION_MAX_PX)
        margin = math.ceil(3.0 * blur_px + 0.5 * float(np.hypot(*motion_px)) + 1.0)
        inner = self._lens.within(Box(box.left - margin, box.top - margin, box.right + margin, box.bottom + margin))
        lit = self._lit(view, light, self._rays(view, inner, is_fine=is_fine))
        if is_fine:
            lit = np.asarray(cv2.resize(lit, (lit.shape[1] // 2, lit.shape[0] // 2), interpolation=cv2.INTER_AREA))
        lit = smear(np.asarray(cv2.GaussianBlur(lit * self._lens.vignetting(inner), (0, 0), blur_px)), motion_px)
        if self._drops is not None:
            rows, columns = (slice(a + MARGIN_PX, b + MARGIN_PX) for a, b in (inner[1::2], inner[::2]))
            lit = seen_through(lit, self._drops[rows, columns])
        left, top = box.left - inner.left, box.top - inner.top
        part = lit[top : top + box.bottom - box.top, left : left + box.right - box.left]
        return develop(part * np.float32(exposure.shades_lx), exposure, self._draw_noise(part.shape))

    def _rays(self, view: View, box: Box, *, is_fine: bool) -> Floats:
        """Return where the pixels in a box look, each when its row is read."""
        rays = self._lens.rays(box, is_fine=is_fine)
        if self._readout_s == 0.0:
            return rays
        return rolled(rays, box, view, self._roof_height_m, self._readout_s)

    def _depth_m(self, view: View) -> float:
        """Return how far what is looked at is along the camera's axis: what is exposed for, and how blurred it is."""
        return max(float(self._looked_at_c(view)[2]), 0.03)

    def _looked_at_c(self, view: View) -> Array:
        """Return the place (3,) in C on the pad nearest to the axis; from near by its middle may be out of sight."""
        axis, above_m = view.R_VC[:, 2], float(view.camera_m[2]) - self._roof_height_m
        met = view.camera_m[:2] + axis[:2] * max(above_m, 0.0) / max(-float(axis[2]), 0.1)
        half = np.array([0.0, 0.0] if self._board is None else self._board.corner_m)
        at = np.array([*np.clip(met, -half, half), self._roof_height_m])
        return np.asarray(view.R_VC.T @ (at - view.camera_m))

    def _motion_px(self, view: View) -> Array:
        """Return how fast the pad moves in the picture, pixels a second."""
        pad_c = self._looked_at_c(view)
        rate = -view.R_VC.T @ view.velocity_m_s - np.cross(view.turning_c_rad_s, pad_c)
        z = max(float(pad_c[2]), 0.03)
        return np.asarray(FOCAL_PX * (rate[:2] - pad_c[:2] / z * rate[2]) / z)

    def _lit(self, view: View, light: Light, rays: Floats) -> Floats:
        """Return the light from each point (rows, columns), in lux times albedo."""
        planes = [(self._road, 0.0), (self._roof, self._roof_height_m)]
        if self._board is not None:
            planes.append((self._board, self._roof_height_m))
        lit = np.full(rays.shape[:2], 0.1, np.float32)
        hidden = [index for index, (surface, height_m) in enumerate(planes) if fills(surface, view, height_m, rays)]
        for surface, height_m in planes[max(hidden, default=0) :]:
            paint(lit, surface, to_plane(view, height_m), rays)
        _hide_horizon(lit, view, rays)
        if light.lamp_lm > 0.0:
            lit *= light.daylight_lx + lamp_lit(light, rays, self._depth_m(view))
        else:
            lit *= np.float32(light.daylight_lx)
        if light.sun_v is not None:
            self._cast_shadow(lit, view, light.sun_v, rays)
            if light.is_glossy:
                lit += glare(light.sun_v, light.daylight_lx, view, rays)
        return lit

    def _cast_shadow(self, lit: Floats, view: View, sun_v: Array, rays: Floats) -> None:
        """Darken the roof in the drone's shadow, whose edges are as soft as the sun is wide."""
        height_m = float(view.drone_m[2]) - self._roof_height_m
        if sun_v[2] < 0.1 or height_m <= 0.0:
            return
        center = view.drone_m[:2] - sun_v[:2] / sun_v[2] * height_m
        soft_m = 0.01 + 2.0 * _SUN_RADIUS_RAD * height_m
        onto_roof = to_plane(view, self._roof_height_m)
        rows, columns = where_on_plane(onto_roof, rays, center, _ROTOR_ARM_M + _SHADOW_ROTOR_M + soft_m)
        if rows.start == rows.stop or columns.start == columns.stop:
            return
        at = on_plane(onto_roof, np.ascontiguousarray(rays[rows, columns]))
        discs = [(center, _SHADOW_BODY_M, 1.0)]
        arms = ((1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0))
        discs += [
            (center + _ROTOR_ARM_M * math.sqrt(0.5) * np.array(arm), _SHADOW_ROTOR_M, _ROTOR_SHARE) for arm in arms
        ]
        for middle, radius_m, depth in discs:
            away = np.hypot(at[..., 0] - np.float32(middle[0]), at[..., 1] - np.float32(middle[1]))
            inside = np.clip((np.float32(radius_m) - away) / np.float32(soft_m) + np.float32(0.5), 0.0, 1.0)
            lit[rows, columns] *= 1.0 - np.float32(depth * (1.0 - _SKY_SHARE)) * inside

    def _draw_noise(self, shape: tuple[int, ...]) -> Floats:
        """Return standard normal noise: a field that is laid at another place each time, and repeats where it ends."""
        row, column = (int(self._rng.integers(0, _NOISE_SIZE - size + 1)) for size in shape)
        return self._noise[row : row + shape[0], column : column + shape[1]]


def _hide_horizon(lit: Floats, view: View, rays: Floats) -> None:
    """Lay haze over what is at the horizon and above it, where the planes' homographies mean nothing."""
    slope, level = view.R_VC[2, :2].astype(np.float32), np.float32(view.R_VC[2, 2])
    edges = np.concatenate([rays[[0, -1]].reshape(-1, 2), rays[:, [0, -1]].reshape(-1, 2)])
    if float(np.max(edges @ slope + level)) > -0.02:
        lit[rays @ slope + level > -0.02] = 0.3


def _at_most(vector: Array, length_max: float) -> Array:
    """Return a vector, shortened to a length."""
    return vector * (length_max / max(float(np.hypot(*vector)), length_max))
