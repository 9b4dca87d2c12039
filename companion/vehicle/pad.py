"""The landing pad now and over the horizon, from the forecast of the vehicle's antenna, and how near is on it; pure.

How near the pad's centre the drone has to be for what it touches to be the pad, the pad's own size says. The
benchmark's pad is 1.5 m wide. On a smaller one the same shares of its width hold; a larger one changes nothing, for
the configured radius is what a drone in gusts is to keep to.
"""

import math

import numpy as np
from msgspec import Struct

from companion.config.companion import CompanionConfig
from companion.core.data import Array, Forecast
from companion.core.reasons import Cause, Reason
from companion.vehicle.compiled import compiled_kernel
from link.messages import PadGeometry

HEADING_UNKNOWN, NOT_DESCRIBED = Cause(Reason.HEADING_UNKNOWN), Cause(Reason.PAD_NOT_DESCRIBED)

_CONE_SHARE = 0.4  # of half of the pad's width: 0.3 m on a pad of 1.5 m
_CONTACT_SHARE = 0.8  # 0.6 m
_KNOWN_SHARE = 1.0 / 3.0  # standard deviation of a pad that has to be seen: 0.25 m


class PadPath(Struct, frozen=True, kw_only=True, eq=False):
    """The pad's centre in W; row 0 is the present.

    Attributes:
        offset_s: (n,) seconds from now, the first is 0.
        position_enu_m: (n, 3).
        velocity_enu_m_s: (n, 3).
        acceleration_enu_m_s2: (n, 3).
        yaw_rad: heading of the vehicle now, None when unknown.
        position_std_m: (n, 3).
        is_coarse: the vehicle's fixes alone are too coarse to land by, if it sends any: only what the drone sees of the
            pad places it.
        has_one_frame: the vehicle's fixes are in the drone's frame; if not, only what the drone sees tells the offset.
        half_width_m: from its centre to the nearest edge; infinite until it is described.
        height_m: of its surface above the vehicle's road, or the water.
        is_afloat: it is on the water.
        tilt_rad: (n, 2) roll and pitch of the vehicle against the road; None where it is not told.
        needs_heading: it is beside the antenna.
        unplaced: why the pad's place is not known; None when it is. Until then it is not landed on.
        frame_offset_m: horizontally, of the drone's frame from the vehicle's fixes', as sightings tell; None without.
        frame_offset_std_m: its standard deviation.
    """

    offset_s: Array
    position_enu_m: Array
    velocity_enu_m_s: Array
    acceleration_enu_m_s2: Array
    yaw_rad: float | None
    position_std_m: Array
    is_coarse: bool = False
    has_one_frame: bool = True
    half_width_m: float = math.inf
    height_m: float = 0.0
    is_afloat: bool = False
    tilt_rad: Array | None = None
    needs_heading: bool = False
    unplaced: Cause | None = None
    frame_offset_m: float | None = None
    frame_offset_std_m: float = math.inf


def pad_path(forecast: Forecast, pad: PadGeometry | None, *, has_one_frame: bool = True) -> PadPath:
    """Return where the pad will be.

    The lever arm from the antenna turns with the vehicle's heading and pitches with the grade: on a climb of 8 % a pad
    1.2 m in front of the antenna is 0.1 m higher. With an unknown heading its horizontal part is left out and the pad
    is not placed: it can be followed, but not landed on. Nor is one on a lever arm so long that the heading is too
    vague for it, unless the pad itself has been seen, nor one that the vehicle has not described; the antenna is
    followed then.

    Args:
        forecast: of the antenna, its first offset 0.
        pad: the vehicle's own description, None until it has answered.
        has_one_frame: both receivers' positions are in one frame.
    """
    lever_x_m, lever_y_m, lever_z_m = pad.antenna_to_pad_m if pad is not None else (0.0, 0.0, 0.0)
    position = forecast.position_enu_m + np.array([0.0, 0.0, lever_z_m])
    velocity = forecast.velocity_enu_m_s
    is_beside, frame_offset = bool(lever_x_m or lever_y_m), forecast.frame_offset_enu_m
    if forecast.yaw_rad is not None and is_beside:
        grade = np.zeros_like(forecast.yaw_rad) if forecast.grade is None else forecast.grade
        arm, swing = turned_lever(forecast.yaw_rad, grade, forecast.offset_s, lever_x_m, lever_y_m)
        position += arm
        velocity = velocity + swing
    if forecast.yaw_rad is not None and forecast.tilt_rad is not None:
        tilted = np.column_stack([forecast.yaw_rad, forecast.tilt_rad])
        lever_m = np.array([lever_x_m, lever_y_m, lever_z_m])
        position = position + tilted_lever(tilted[:, [0, 1, 3]], lever_m)
        velocity = velocity + tilted_lever(tilted[:, [0, 2, 4]], lever_m)
    return PadPath(
        offset_s=forecast.offset_s,
        position_enu_m=position,
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=forecast.acceleration_enu_m_s2,
        yaw_rad=None if forecast.yaw_rad is None else float(forecast.yaw_rad[0]),
        position_std_m=forecast.position_std_m,
        is_coarse=forecast.is_coarse,
        has_one_frame=has_one_frame,
        half_width_m=math.inf if pad is None else 0.5 * min(pad.size_m),
        height_m=0.0 if pad is None else pad.height_m,
        is_afloat=pad is not None and pad.is_afloat,
        tilt_rad=None if forecast.tilt_rad is None else forecast.tilt_rad[:, ::2],
        needs_heading=is_beside,
        unplaced=NOT_DESCRIBED if pad is None else HEADING_UNKNOWN if _is_about(forecast, pad) else None,
        frame_offset_m=None if frame_offset is None else math.hypot(*frame_offset.tolist()),
        frame_offset_std_m=forecast.frame_offset_std_m,
    )


def _is_about(forecast: Forecast, pad: PadGeometry) -> bool:
    """Return whether the pad may be anywhere about the antenna, as far as is known of the vehicle's heading."""
    lever_m = math.hypot(*pad.antenna_to_pad_m[:2])
    if forecast.yaw_rad is None:
        return lever_m > 0.0
    known_m = 0.5 * _KNOWN_SHARE * min(pad.size_m)
    east_std_m, north_std_m, _ = forecast.position_std_m[0].tolist()
    return lever_m * forecast.yaw_std_rad > known_m and not max(east_std_m, north_std_m) < known_m


@compiled_kernel
def turned_lever(
    yaw_rad: Array, grade: Array, offset_s: Array, lever_x_m: float, lever_y_m: float
) -> tuple[Array, Array]:
    """Return a horizontal lever arm of V in W over a horizon, and its rate of change, each (n, 3).

    Args:
        yaw_rad: (n,) of V, wrapped or not; n > 1.
        grade: (n,) by which V pitches, m of height per m.
        offset_s: (n,) rising.
        lever_x_m: forward in V.
        lever_y_m: left in V.
    """
    n = len(yaw_rad)
    turn_rad, step_s = np.empty(n - 1), np.diff(offset_s)
    for i in range(n - 1):
        turn_rad[i] = (yaw_rad[i + 1] - yaw_rad[i] + math.pi) % (2.0 * math.pi) - math.pi
    arm, swing = np.zeros((n, 3)), np.zeros((n, 3))
    for i in range(n):
        c, s = math.cos(yaw_rad[i]), math.sin(yaw_rad[i])
        arm[i, 0], arm[i, 1] = c * lever_x_m - s * lever_y_m, s * lever_x_m + c * lever_y_m
        before, after = max(i - 1, 0), min(i, n - 2)
        # of second order within, where the slopes to both sides are weighed by each other's step
        share = step_s[before] / (step_s[before] + step_s[after])
        rate = (1.0 - share) * turn_rad[before] / step_s[before] + share * turn_rad[after] / step_s[after]
        swing[i, 0], swing[i, 1] = -rate * arm[i, 1], rate * arm[i, 0]
        arm[i, 2], swing[i, 2] = lever_x_m * grade[i], lever_x_m * slope_at(i, grade, step_s)
    return arm, swing


def tilted_lever(tilt: Array, lever_m: Array) -> Array:
    """Return by how much (n, 3) a tilt moves the end of a lever arm in W, to the first order; for its rate, how fast.

    Args:
        tilt: (n, 3) heading of V, rad, roll and pitch, rad, or their rates, rad/s.
        lever_m: (3,) in V.
    """
    x_m, y_m, z_m = lever_m
    cosine, sine, (_, roll, pitch) = np.cos(tilt[:, 0]), np.sin(tilt[:, 0]), tilt.T
    forward, left = pitch * z_m, -roll * z_m
    up = roll * y_m - pitch * x_m
    return np.column_stack([cosine * forward - sine * left, sine * forward + cosine * left, up])


@compiled_kernel
def slope_at(i: int, values: Array, step_s: Array) -> float:
    """Return the derivative of `values` (n,) at the `i`-th of them, of second order within (numpy's `gradient`).

    Args:
        i: from 0.
        values: at n instants.
        step_s: (n - 1,) between these.
    """
    if i in (0, len(step_s)):
        last = max(i - 1, 0)
        return float((values[last + 1] - values[last]) / step_s[last])
    before, after = step_s[i - 1], step_s[i]
    back, ahead = -after / (before * (before + after)), before / (after * (before + after))
    return float(back * values[i - 1] + (after - before) / (before * after) * values[i] + ahead * values[i + 1])


def cone_radius_at_pad_m(half_width_m: float, config: CompanionConfig) -> float:
    """Return the radius of the descent's cone at the height of a pad that is twice `half_width_m` wide."""
    return min(config.descent.cone.radius_at_pad_m, _CONE_SHARE * half_width_m)


def cone_radius_m(height_m: float, half_width_m: float, config: CompanionConfig) -> float:
    """Return how far beside the centre of a pad the drone may be at `height_m` above it while it descends."""
    return cone_radius_at_pad_m(half_width_m, config) + config.descent.cone.slope * max(height_m, 0.0)


def over_pad_radius_m(half_width_m: float, config: CompanionConfig) -> float:
    """Return how far from the pad's centre what is touched is still the pad."""
    return min(2.0 * config.descent.cone.radius_at_pad_m, _CONTACT_SHARE * half_width_m)


def unseen_std_max_m(half_width_m: float, config: CompanionConfig) -> float:
    """Return up to which standard deviation a pad is landed on that only what is seen of it can place."""
    return min(config.descent.unseen.std_max_m, _KNOWN_SHARE * half_width_m)


def is_too_small(pad: PadPath, config: CompanionConfig) -> bool:
    """Return whether the pad is narrower than what a drone can be brought onto."""
    return 2.0 * pad.half_width_m < config.descent.pad_width_min_m


def is_vague(pad: PadPath, config: CompanionConfig) -> bool:
    """Return whether the pad is not known well enough to come near it."""
    return float(max(pad.position_std_m[0, :2].tolist())) > config.abort.position_std_max_m


def is_unseen(pad: PadPath, config: CompanionConfig) -> bool:
    """Return whether the pad has to be seen (again) before it is landed on.

    Fixes of some decimetres or better place it by themselves where both receivers have one frame. Where they may not,
    a first sighting tells the offset; between coarser fixes and the drone's own place lie metres, and what a sighting
    said of them holds for seconds only.
    """
    return (pad.is_coarse or not pad.has_one_frame) and float(np.max(pad.position_std_m[0, :2])) > unseen_std_max_m(
        pad.half_width_m, config
    )
