"""The landing pad now and over the horizon, from the forecast of the vehicle's antenna.

It is the pad as it is to be followed, without what it shakes to the sides. How near is on it says `pad_reach`.
"""

import math

import numpy as np
from msgspec import Struct

from companion.core.data import Array, Forecast
from companion.core.reasons import Cause, Reason
from companion.vehicle.lever import tilted_lever, turned_lever, yaw_rate
from companion.vehicle.shake import PadSwing, swing_of
from link.messages import PadGeometry, Vector3

KNOWN_SHARE = 1.0 / 3.0  # of half of the pad's width, the standard deviation of one that has to be seen: 0.25 m
HEADING_UNKNOWN, NOT_DESCRIBED = Cause(Reason.HEADING_UNKNOWN), Cause(Reason.PAD_NOT_DESCRIBED)
TURNS_ON_SPOT = Cause(Reason.TURNS_ON_SPOT)


class FrameOffset(Struct, frozen=True, kw_only=True):
    """How far the drone's frame is from that of the vehicle's fixes, as sightings of the pad tell.

    Attributes:
        distance_m: horizontally; None where it is not estimated.
        std_m: its standard deviation.
        is_height_told: how far apart the heights are was told lately: only what they wander apart since is unknown.
        is_confirmed: as many sightings have agreed on it, for as long, as it takes to believe them.
        higher_m: by how much the pad seems to be higher than it is said to be, by the road that the drone's range
            finder has seen; 0 where its height was told lately.
    """

    distance_m: float | None = None
    std_m: float = math.inf
    is_height_told: bool = False
    is_confirmed: bool = True
    higher_m: float = 0.0


class PadMounting(Struct, frozen=True, kw_only=True):
    """How the vehicle carries its pad.

    Attributes:
        is_afloat: on the water.
        arm_m: from the antenna to its centre, horizontally; what is not 0 needs a heading.
        ahead_m: by how much the pad's centre is ahead of the antenna, along V.
    """

    is_afloat: bool = False
    arm_m: float = 0.0
    ahead_m: float = 0.0


class PadPath(Struct, frozen=True, kw_only=True, eq=False):
    """The pad's centre in W; row 0 is the present.

    Attributes:
        offset_s: (n,) seconds from now, the first is 0.
        position_enu_m: (n, 3).
        velocity_enu_m_s: (n, 3).
        acceleration_enu_m_s2: (n, 3).
        yaw_rad: heading of the vehicle now, None when unknown.
        yaw_rate_rad_s: (n,) how fast it turns, None when that is unknown.
        position_std_m: (n, 3).
        climb_std_m_s: (n,) standard deviation of its velocity upwards; None where it is not estimated.
        is_coarse: the vehicle's fixes alone are too coarse to land by, if it sends any: only what the drone sees of the
            pad places it.
        has_one_frame: the vehicle's fixes are in the drone's frame; if not, only what the drone sees tells the offset.
        half_width_m: from its centre to the nearest edge; infinite until it is described.
        height_m: of its surface above the vehicle's road, or the water.
        mounting: how the vehicle carries it.
        grade: of the road in the direction of the heading now, height per length; 0 where it is not estimated.
        swing: how its deck tilts and shakes, beside the grade; None where the vehicle does not tell.
        unplaced: why the pad's place is not known; None when it is. Until then it is not landed on.
        frame_offset: of the drone's frame from the vehicle's fixes'.
        crest_above_m: how far above its present height waves have lifted it of late.
    """

    offset_s: Array
    position_enu_m: Array
    velocity_enu_m_s: Array
    acceleration_enu_m_s2: Array
    yaw_rad: float | None
    position_std_m: Array
    climb_std_m_s: Array | None = None
    is_coarse: bool = False
    has_one_frame: bool = True
    yaw_rate_rad_s: Array | None = None
    half_width_m: float = math.inf
    height_m: float = 0.0
    mounting: PadMounting = PadMounting()
    grade: float = 0.0
    swing: PadSwing | None = None
    unplaced: Cause | None = None
    frame_offset: FrameOffset = FrameOffset()
    crest_above_m: float = 0.0

    @property
    def ground_speed_m_s(self) -> float:
        """How fast it moves horizontally now."""
        return math.hypot(*self.velocity_enu_m_s[0, :2].tolist())


def pad_path(
    forecast: Forecast,
    pad: PadGeometry | None,
    *,
    has_one_frame: bool = True,
    is_confirmed: bool = True,
    higher_m: float = 0.0,
) -> PadPath:
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
        is_confirmed: the sightings of the pad have agreed for long enough.
        higher_m: than it is said to be, by the road that was seen.
    """
    lever_m = pad.antenna_to_pad_m if pad is not None else (0.0, 0.0, 0.0)
    position, velocity = _at_end_of(lever_m, forecast)
    acceleration, deck = forecast.acceleration_enu_m_s2, swing_of(forecast, 0.0 if pad is None else pad.height_m)
    if deck is not None and deck.shake_enu.any():
        motion = (position, velocity, acceleration)
        position, velocity, acceleration = (
            _without_shake(value, shake) for value, shake in zip(motion, deck.shake_enu, strict=True)
        )
    return PadPath(
        offset_s=forecast.offset_s,
        position_enu_m=position,
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=acceleration,
        yaw_rad=None if forecast.yaw_rad is None else float(forecast.yaw_rad[0]),
        yaw_rate_rad_s=_yaw_rate_rad_s(forecast),
        position_std_m=forecast.position_std_m,
        climb_std_m_s=forecast.climb_std_m_s,
        is_coarse=forecast.is_coarse,
        has_one_frame=has_one_frame,
        half_width_m=math.inf if pad is None else 0.5 * min(pad.size_m),
        height_m=0.0 if pad is None else pad.height_m,
        mounting=PadMounting(
            is_afloat=pad is not None and pad.is_afloat,
            arm_m=math.hypot(lever_m[0], lever_m[1]),
            ahead_m=lever_m[0],
        ),
        grade=0.0 if forecast.grade is None else float(forecast.grade[0]),
        swing=deck,
        unplaced=_why_unplaced(forecast, pad),
        frame_offset=_frame_offset(forecast, is_confirmed=is_confirmed, higher_m=higher_m),
    )


def slope_at(pad: PadPath, offset_s: float) -> Array:
    """Return the slope (2,) of the deck in W, by the road's grade now and by its swing then, height per length."""
    slope = np.zeros(2)
    if pad.yaw_rad is not None:
        slope += pad.grade * np.array([math.cos(pad.yaw_rad), math.sin(pad.yaw_rad)])
    if pad.swing is not None:
        slope += [np.interp(offset_s, pad.offset_s, column) for column in pad.swing.slope.T]
    return slope


def _frame_offset(forecast: Forecast, *, is_confirmed: bool, higher_m: float) -> FrameOffset:
    offset = forecast.frame_offset_enu_m
    distance_m = None if offset is None else math.hypot(*offset.tolist())
    return FrameOffset(
        distance_m=distance_m,
        std_m=forecast.frame_offset_std_m,
        is_height_told=forecast.is_height_told,
        is_confirmed=is_confirmed,
        higher_m=0.0 if forecast.is_height_told else higher_m,
    )


def _at_end_of(lever_m: Vector3, forecast: Forecast) -> tuple[Array, Array]:
    """Return where the end of a lever arm from the antenna in V is in W and how fast, as far as it has a direction."""
    lever_x_m, lever_y_m, lever_z_m = lever_m
    position = forecast.position_enu_m + np.array([0.0, 0.0, lever_z_m])
    velocity = forecast.velocity_enu_m_s
    if forecast.yaw_rad is None:
        return position, velocity
    if lever_x_m or lever_y_m:
        grade = np.zeros_like(forecast.yaw_rad) if forecast.grade is None else forecast.grade
        arm, swing = turned_lever(forecast.yaw_rad, grade, forecast.offset_s, lever_x_m, lever_y_m)
        position += arm
        velocity = velocity + swing
    if forecast.tilt_rad is not None:
        moved, swing = tilted_lever(forecast.yaw_rad, forecast.tilt_rad, lever_x_m, lever_y_m, lever_z_m)
        position, velocity = position + moved, velocity + swing
    return position, velocity


def _without_shake(motion: Array, shake_enu: Array) -> Array:
    """Return `motion` (n, 3) without the horizontal `shake_enu` (n, 2)."""
    still = motion.copy()
    still[:, :2] -= shake_enu
    return still


def _yaw_rate_rad_s(forecast: Forecast) -> Array | None:
    if forecast.yaw_rad is None or len(forecast.offset_s) < 2:
        return None
    return yaw_rate(forecast.yaw_rad, forecast.offset_s)


def _why_unplaced(forecast: Forecast, pad: PadGeometry | None) -> Cause | None:
    """Return why nobody knows where the pad is, None where it is known."""
    if pad is None:
        return NOT_DESCRIBED
    if not _is_about(forecast, pad):
        return None
    return TURNS_ON_SPOT if forecast.turns_on_spot else HEADING_UNKNOWN


def _is_about(forecast: Forecast, pad: PadGeometry) -> bool:
    """Return whether the pad may be anywhere about the antenna, as far as is known of the vehicle's heading."""
    lever_m = math.hypot(*pad.antenna_to_pad_m[:2])
    if forecast.yaw_rad is None:
        return lever_m > 0.0
    known_m = 0.5 * KNOWN_SHARE * min(pad.size_m)
    east_std_m, north_std_m, _ = forecast.position_std_m[0].tolist()
    return lever_m * forecast.yaw_std_rad > known_m and not max(east_std_m, north_std_m) < known_m
