"""Where the pad was seen, how it moved against the drone, and where it should be seen next; pure.

Frames: W with z up, C the camera, P the pad. Motion is kept in W's axes: it is even there while the drone turns.
"""

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from companion.eyes.camera import matrix_of, vector_of
from companion.eyes.finding.pose import Pose
from link.messages import Matrix3

Array = NDArray[np.float64]

_TRACK_MAX_S = 0.3  # since the pad was seen: a drone's speed against it changes by 1 m/s within that
_VELOCITY_GAIN = 0.5
_VELOCITY_SPAN_MAX_S = 0.2


class Track(Struct, frozen=True, kw_only=True):
    """Where the pad was: its middle from the camera in W's axes (m), its velocity there (m/s), and R_WP."""

    t_ns: int
    away_m: tuple[float, float, float]
    velocity_m_s: tuple[float, float, float]
    R_WP: Matrix3
    has_velocity: bool


def expected_pose(track: Track | None, t_ns: int, R_WC: Array) -> Pose | None:
    """Return where a pad that was seen not long ago should be in the camera now."""
    if track is None:
        return None
    elapsed_s = (t_ns - track.t_ns) * 1e-9
    if not 0.0 <= elapsed_s <= _TRACK_MAX_S:
        return None
    R_CW = R_WC.T
    away = np.array(track.away_m) + elapsed_s * np.array(track.velocity_m_s)
    return vector_of(R_CW @ np.array(track.R_WP).reshape(3, 3)), R_CW @ away


def update_track(before: Track | None, t_ns: int, pose: Pose, R_WC: Array) -> Track:
    """Return the track with a pose of the pad in the camera that was seen at `t_ns`."""
    away = R_WC @ pose[1]
    velocity, has_velocity = np.zeros(3), False
    elapsed_s = np.inf if before is None else (t_ns - before.t_ns) * 1e-9
    if before is not None and 0.0 < elapsed_s <= _VELOCITY_SPAN_MAX_S:
        measured = (away - np.array(before.away_m)) / elapsed_s
        gain = _VELOCITY_GAIN if before.has_velocity else 1.0
        velocity = np.array(before.velocity_m_s) + gain * (measured - np.array(before.velocity_m_s))
        has_velocity = True
    a, b, c, d, e, f, g, h, i = (R_WC @ matrix_of(pose[0])).ravel().tolist()
    x, y, z = away.tolist()
    u, v, w = velocity.tolist()
    return Track(
        t_ns=t_ns,
        away_m=(x, y, z),
        velocity_m_s=(u, v, w),
        R_WP=(a, b, c, d, e, f, g, h, i),
        has_velocity=has_velocity,
    )
