"""How the autopilot's local frame W moves under what is known in it; pure.

An autopilot that corrects its estimate, or loses and finds its receiver, steps in W: from one report to the next its
place differs by what it did not fly. What is seen from the drone steps along; what stands on the ground does not. One
that moves its origin steps as well, and the new origin is known some tenths of a second later: then what stands on the
ground has moved in W by as much.
"""

from math import hypot

from msgspec import Struct

from companion.core.data import OwnState
from link.frames.geodesy import LocalFrame, local_from_geodetic
from link.messages import Vector3
from link.records import replace

_NOWHERE: Vector3 = (0.0, 0.0, 0.0)
# What two reports in a row of a drone that flies can differ by, beside its velocity. Measured with PX4 and ArduCopter
# over 27,000 reports at up to 15 m/s: 0.12 m at most, where PX4 takes a fix.
CORRECTED_M = 0.1
VELOCITY_BIAS_MAX_M_S = 1.0  # of an estimator, PX4's has 0.9
_STAMP_S = 0.005  # whole milliseconds, of when the estimate was made or sent: it runs at 250 to 400 Hz
_MANOEUVRE_M_S2 = 10.0
_GAP_MAX_S = 0.5  # a drone that was silent for longer may have braked or turned meanwhile
_ONE_STEP_M = 0.5  # what a step is known to over four lost reports of a drone that brakes


class FrameMoves(Struct, frozen=True, kw_only=True):
    """How W has moved since it was first set: what is known in it holds until this changes.

    Attributes:
        origin_count: how often the origin was set, or moved by other than the drone's own place had stepped before.
        shift_enu_m: sum of the steps of the drone's own place that it did not fly.
        shift_variance_m2: of `shift_enu_m`, on each axis.
        stepped_ns: time of the first report after the newest step; 0 before the first.
        since_origin_enu_m: sum of the steps since the origin was set or moved last.
        origin_shift_enu_m: by how much what stands on the ground has moved in W with such steps.
    """

    origin_count: int = 0
    shift_enu_m: Vector3 = _NOWHERE
    shift_variance_m2: float = 0.0
    stepped_ns: int = 0
    since_origin_enu_m: Vector3 = _NOWHERE
    origin_shift_enu_m: Vector3 = _NOWHERE


NO_MOVES = FrameMoves()


def after_report(moves: FrameMoves, before: OwnState, own: OwnState) -> FrameMoves:
    """Return the moves after a report of the drone; the same object where flying explains it.

    A single velocity that is wrong explains nothing, before the step or after it; then the other report's does.

    Args:
        moves: until then.
        before: the report before.
        own: the new one.
    """
    duration_s = (own.t_ns - before.t_ns) * 1e-9
    if duration_s > _GAP_MAX_S:
        return moves
    step, flown_max_m = _unexplained(before, own, before.velocity_enu_m_s, duration_s)
    if hypot(*step) <= flown_max_m:
        return moves
    by_newer, by_newer_max_m = _unexplained(before, own, own.velocity_enu_m_s, duration_s)
    if hypot(*by_newer) <= by_newer_max_m:
        return moves
    return replace(
        moves,
        shift_enu_m=_sum(moves.shift_enu_m, step),
        shift_variance_m2=moves.shift_variance_m2 + (flown_max_m / 2.0) ** 2,
        stepped_ns=own.t_ns,
        since_origin_enu_m=_sum(moves.since_origin_enu_m, step),
    )


def after_origin(moves: FrameMoves, known: LocalFrame | None, frame: LocalFrame) -> FrameMoves:
    """Return the moves after another origin was told; `known` is the frame until then, None before the first."""
    counted = replace(moves, origin_count=moves.origin_count + 1, since_origin_enu_m=_NOWHERE)
    if known is None or known.projection is not frame.projection:
        return counted
    moved = _moved_by(known, frame)
    if _apart_m(moved, moves.since_origin_enu_m) > _ONE_STEP_M:
        return counted
    return replace(moves, since_origin_enu_m=_NOWHERE, origin_shift_enu_m=_sum(moves.origin_shift_enu_m, moved))


def has_stepped_with(moves: FrameMoves, known: LocalFrame, frame: LocalFrame) -> bool:
    """Return whether the drone has stepped by what another origin moves it, and farther than a step is unsure."""
    stepped = moves.since_origin_enu_m
    return hypot(*stepped) > _ONE_STEP_M and _apart_m(_moved_by(known, frame), stepped) <= _ONE_STEP_M


def stepped_in_frame_m(moves: FrameMoves) -> tuple[float, float]:
    """Return by how much the drone's place has stepped horizontally in a frame that stands on the ground, in W."""
    (east_m, north_m, _), (origin_east_m, origin_north_m, _) = moves.shift_enu_m, moves.origin_shift_enu_m
    return east_m - origin_east_m, north_m - origin_north_m


def _moved_by(known: LocalFrame, frame: LocalFrame) -> Vector3:
    origin = known.origin
    return local_from_geodetic(frame, origin.latitude_rad, origin.longitude_rad, origin.altitude_m)


def _apart_m(a: Vector3, b: Vector3) -> float:
    return hypot(*(one - other for one, other in zip(a, b, strict=True)))


def _unexplained(before: OwnState, own: OwnState, velocity: Vector3, duration_s: float) -> tuple[Vector3, float]:
    """Return what a velocity leaves of the way between two reports, and how much of it the drone may have flown."""
    (x, y, z), (start_x, start_y, start_z), (vx, vy, vz) = own.position_enu_m, before.position_enu_m, velocity
    left = (x - start_x - vx * duration_s, y - start_y - vy * duration_s, z - start_z - vz * duration_s)
    return left, _flown_max_m(hypot(*velocity), duration_s)


def _flown_max_m(speed_m_s: float, duration_s: float) -> float:
    """Return how far a drone that flies can be from where its last report takes it."""
    by_velocity_m = _STAMP_S * speed_m_s + VELOCITY_BIAS_MAX_M_S * duration_s
    return CORRECTED_M + by_velocity_m + 0.5 * _MANOEUVRE_M_S2 * duration_s**2


def _sum(a: Vector3, b: Vector3) -> Vector3:
    (ax, ay, az), (bx, by, bz) = a, b
    return (ax + bx, ay + by, az + bz)
