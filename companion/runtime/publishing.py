"""What the companion puts on Zenoh of a step: the status, and the plan thinned out."""

from companion.planning.guidance import PlanResult
from link.messages import LandingStatus, Plan, PlannedPose
from link.payloads import cdr, json_messages
from link.zenoh.keys import Keys, Publication

_PLAN_POINTS = 2  # every so many points of the plan are published


def status_publication(keys: Keys, status: LandingStatus) -> Publication:
    """Return the status as JSON."""
    return Publication(keys.landing_status, json_messages.encode(status), "application/json")


def plan_publication(keys: Keys, plan: PlanResult, t_ns: int, yaw_rad: float) -> Publication:
    """Return the planned motion as a path.

    Args:
        keys: of the Zenoh contract.
        plan: of a step.
        t_ns: of that step, UTC.
        yaw_rad: the heading that is flown, from East counter-clockwise.
    """
    trajectory = plan.trajectory
    offsets_s = trajectory.offset_s[::_PLAN_POINTS].tolist()
    points = zip(offsets_s, trajectory.position_enu_m[::_PLAN_POINTS].tolist(), strict=True)
    poses = tuple(
        PlannedPose(t_ns=t_ns + int(offset_s * 1e9), position_enu_m=(x, y, z), yaw_rad=yaw_rad)
        for offset_s, (x, y, z) in points
    )
    return Publication(keys.landing_plan, cdr.encode(Plan(t_ns=t_ns, poses=poses)), cdr.encoding_of(Plan))
