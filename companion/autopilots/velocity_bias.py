"""By how much the velocity that an autopilot reports is off what its own positions show, horizontally; pure.

An estimator's velocity can be wrong for seconds (PX4's, simulated, by 0.3 m/s on average and 0.9 at worst) while its
receiver keeps the position right. The autopilot flies so that *its* velocity is the one asked for: the drone leaves
its place until the position loop makes up for it, 0.3 m for 0.3 m/s at 1 rad/s. So the bias is added to what is asked.

Model: the bias is v - dp/dt through a low-pass of first order, in W. Summed over the reports, so that the rounding of
their stamps cancels.
"""

from math import hypot

from companion.core.data import OwnState, Setpoint
from link.messages import Vector3
from link.records import replace

# With 0.5 to 1 s about half of PX4's error is left (0.15 of 0.33 m/s); shorter, the steps of its fixes come through.
_TIME_CONSTANT_S = 0.7
_GAP_MAX_S = 0.2  # over a longer one nothing is learnt
_STEP_MAX_M = 0.1  # a larger one between two reports is a correction of the place, not a motion
_BIAS_MAX_M_S = 1.0
_NONE: Vector3 = (0.0, 0.0, 0.0)


def velocity_bias(before: OwnState | None, t_ns: int, position_enu_m: Vector3, reported_enu_m_s: Vector3) -> Vector3:
    """Return the bias at a report in W, m/s.

    Args:
        before: the report before, its velocity without its bias; None when there is none to compare with.
        t_ns: of the report.
        position_enu_m: in W.
        reported_enu_m_s: the velocity as it was reported, in W.
    """
    if before is None:
        return _NONE
    dt_s = (t_ns - before.t_ns) * 1e-9
    if not 0.0 < dt_s <= _GAP_MAX_S:
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
    if hypot(x_m, y_m) > _STEP_MAX_M:
        return before.velocity_bias_enu_m_s
    bias_x += (x_m - bias_x * dt_s) / _TIME_CONSTANT_S
    bias_y += (y_m - bias_y * dt_s) / _TIME_CONSTANT_S
    share = min(1.0, _BIAS_MAX_M_S / max(hypot(bias_x, bias_y), _BIAS_MAX_M_S))
    return (bias_x * share, bias_y * share, 0.0)


def as_seen_with(setpoint: Setpoint, bias_enu_m_s: Vector3) -> Setpoint:
    """Return the setpoint with the velocity that the autopilot will report when it flies as asked."""
    if setpoint.velocity_enu_m_s is None:
        return setpoint
    (vx, vy, vz), (bias_x, bias_y, bias_z) = setpoint.velocity_enu_m_s, bias_enu_m_s
    return replace(setpoint, velocity_enu_m_s=(vx + bias_x, vy + bias_y, vz + bias_z))


def without(velocity_enu_m_s: Vector3, bias_enu_m_s: Vector3) -> Vector3:
    """Return a reported velocity without its bias."""
    (vx, vy, vz), (bias_x, bias_y, bias_z) = velocity_enu_m_s, bias_enu_m_s
    return (vx - bias_x, vy - bias_y, vz - bias_z)
