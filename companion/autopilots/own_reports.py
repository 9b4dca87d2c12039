"""The drone's own reports: how they change over a second, when their frame steps, and how accurate they are; pure.

An estimator's velocity can be wrong for seconds (PX4's, simulated, by 0.3 m/s on average and 0.9 at worst) while its
receiver keeps the position right. The autopilot flies so that *its* velocity is the one asked for: the drone leaves
its place until the position loop makes up for it, 0.3 m for 0.3 m/s at 1 rad/s. So the bias is added to what is asked.

Model: the bias is v - dp/dt through a low-pass of first order, in W, horizontally. Summed over the reports, so that the
rounding of their stamps cancels.
"""

from collections.abc import Sequence
from math import hypot

from companion.autopilots.frame_moves import CORRECTED_M, VELOCITY_BIAS_MAX_M_S, FrameMoves, after_report
from companion.core.data import OwnState, Setpoint
from link.frames.rotations import multiply, normalized
from link.messages import Vector3
from link.records import replace

HISTORY_NS = 1_000_000_000  # sightings of the pad arrive less late than this
_POSITION_MAX_M = 1e6  # farther from the origin no local frame is meant
_SPEED_MAX_M_S = 100.0  # no multirotor that lands on vehicles is faster
_ACCELERATION_OVER_NS = (40_000_000, 120_000_000)  # between two reports that an acceleration is taken from
_JOLT_OVER_NS = 45_000_000  # a stop within one report is seen in two more at 50 Hz
# With 0.5 to 1 s about half of PX4's error is left (0.15 of 0.33 m/s); shorter, the steps of its fixes come through.
_BIAS_TIME_CONSTANT_S = 0.7
_BIAS_GAP_MAX_S = 0.2  # over a longer one nothing is learnt
_NO_BIAS: Vector3 = (0.0, 0.0, 0.0)


def carry(own: OwnState, t_ns: int) -> OwnState:
    """Return the drone at `t_ns`, carried from a report at its velocity and angular velocity.

    The orientation is carried from when it was so, which is before the report: at 2 rad/s half a period of 50 Hz turns
    by 0.02 rad, and what is seen 8 m away is 0.16 m off.
    """
    dt_s = (t_ns - own.t_ns) * 1e-9
    turned_s = dt_s + own.attitude_age_s
    p, q, r = own.angular_velocity_flu_rad_s
    (x, y, z), (vx, vy, vz) = own.position_enu_m, own.velocity_enu_m_s
    turn = normalized((1.0, 0.5 * p * turned_s, 0.5 * q * turned_s, 0.5 * r * turned_s))
    return replace(
        own,
        t_ns=t_ns,
        position_enu_m=(x + vx * dt_s, y + vy * dt_s, z + vz * dt_s),
        orientation_wxyz=multiply(own.orientation_wxyz, turn),
    )


def with_report(
    history: tuple[OwnState, ...], own: OwnState, moves: FrameMoves
) -> tuple[tuple[OwnState, ...], FrameMoves]:
    """Add the newest report to the last second's, oldest first.

    Returns:
        them, and how the local frame has moved by now: where flying cannot explain the report, it has stepped under
        the drone, and a new history begins.
    """
    kept = history
    while kept and own.t_ns - kept[0].t_ns > HISTORY_NS:
        kept = kept[1:]
    moved = after_report(moves, kept[-1], own) if kept else moves
    if moved is not moves:
        return (own,), moved
    up_m_s2, jolt_m_s2 = _acceleration_up_m_s2(kept, own), _jolt_m_s2(kept, own)
    return (*kept, replace(own, acceleration_up_m_s2=up_m_s2, jolt_m_s2=jolt_m_s2)), moves


def is_plausible(position_m: Sequence[float], velocity_m_s: Sequence[float]) -> bool:
    """Whether all are numbers that a flight can have; NaN is none."""
    return all(abs(p) < _POSITION_MAX_M for p in position_m) and all(abs(v) < _SPEED_MAX_M_S for v in velocity_m_s)


def _acceleration_up_m_s2(earlier: Sequence[OwnState], own: OwnState) -> float | None:
    """Return the vertical acceleration between the newest report and one shortly before it."""
    shortest_ns, longest_ns = _ACCELERATION_OVER_NS
    before = None
    for old in reversed(earlier):
        if own.t_ns - old.t_ns > longest_ns:
            break
        before = old
    if before is None or own.t_ns - before.t_ns < shortest_ns:
        return None
    return (own.velocity_enu_m_s[2] - before.velocity_enu_m_s[2]) / ((own.t_ns - before.t_ns) * 1e-9)


def _jolt_m_s2(earlier: Sequence[OwnState], own: OwnState) -> float | None:
    """Return the horizontal acceleration between the newest report and the last one clearly before it."""
    for old in reversed(earlier):
        if own.t_ns - old.t_ns >= _JOLT_OVER_NS:
            (vx, vy, _), (before_x, before_y, _) = own.velocity_enu_m_s, old.velocity_enu_m_s
            return hypot(vx - before_x, vy - before_y) / ((own.t_ns - old.t_ns) * 1e-9)
    return None


def velocity_bias(before: OwnState | None, t_ns: int, position_enu_m: Vector3, reported_enu_m_s: Vector3) -> Vector3:
    """Return the bias at a report in W, m/s.

    Args:
        before: the report before, its velocity without its bias; None when there is none to compare with.
        t_ns: of the report.
        position_enu_m: in W.
        reported_enu_m_s: the velocity as it was reported, in W.
    """
    if before is None:
        return _NO_BIAS
    dt_s = (t_ns - before.t_ns) * 1e-9
    if not 0.0 < dt_s <= _BIAS_GAP_MAX_S:
        return before.velocity_bias_enu_m_s
    x_m, y_m = (
        0.5 * (reported + corrected + bias) * dt_s - (now - then)
        for reported, corrected, bias, now, then in zip(
            reported_enu_m_s[:2],
            before.velocity_enu_m_s,
            before.velocity_bias_enu_m_s,
            position_enu_m,
            before.position_enu_m,
            strict=False,
        )
    )
    bias_x, bias_y, _ = before.velocity_bias_enu_m_s
    if hypot(x_m, y_m) > CORRECTED_M:  # no motion
        return before.velocity_bias_enu_m_s
    bias_x += (x_m - bias_x * dt_s) / _BIAS_TIME_CONSTANT_S
    bias_y += (y_m - bias_y * dt_s) / _BIAS_TIME_CONSTANT_S
    share = min(1.0, VELOCITY_BIAS_MAX_M_S / max(hypot(bias_x, bias_y), VELOCITY_BIAS_MAX_M_S))
    return (bias_x * share, bias_y * share, 0.0)


def as_seen_with(setpoint: Setpoint, bias_enu_m_s: Vector3) -> Setpoint:
    """Return the setpoint with the velocity that the autopilot will report when it flies as asked."""
    if setpoint.velocity_enu_m_s is None:
        return setpoint
    (vx, vy, vz), (bias_x, bias_y, bias_z) = setpoint.velocity_enu_m_s, bias_enu_m_s
    return replace(setpoint, velocity_enu_m_s=(vx + bias_x, vy + bias_y, vz + bias_z))


def without_bias(velocity_enu_m_s: Vector3, bias_enu_m_s: Vector3) -> Vector3:
    """Return a reported velocity without its bias."""
    (vx, vy, vz), (bias_x, bias_y, bias_z) = velocity_enu_m_s, bias_enu_m_s
    return (vx - bias_x, vy - bias_y, vz - bias_z)
