"""A descent over a vehicle that drives evenly, for rollouts: everything is known and nothing pushes, unless told."""

import numpy as np

from companion.core.data import Array
from companion.forecast.draws import STEPS_MAX
from companion.forecast.samples import DT_S, STEADY, Course, Descent, Follower, Rules, Samples

SPEED_M_S, SINK_M_S, HEIGHT_M = 8.0, 0.45, 0.34
NEVER_S = 1e6
DRONE = Follower(
    stiffness_per_s2=1.71,
    damping_per_s=1.8,
    path_share=1.0,
    led_share=0.0,
    turns_hz=10.0,
    forgets_hz=0.22,
    drag_per_s=0.25,
    push_std_m_s2=0.0,
    way_s=1.4,
    believes_s=0.3,
    trails_s=0.0,
    relearns_hz=0.0,
    error_std_m_s=0.0,
    acceleration_max_m_s2=5.0,
    jerk_max_m_s3=20.0,
    level_m_s2=0.6,
    level_below_m=0.08,
)
RULES = Rules(
    waits_max_s=0.5,
    waits_below_m=0.85,
    commits_below_m=0.35,
    cone_at_pad_m=0.3,
    cone_slope=0.35,
    near_speed_m_s=0.8,
    over_pad_m=0.6,
    stops_sinking_s=0.2,
    climbs_m_s2=3.0,
    foot_radius_m=0.2,
)


def descent(height_m: float = HEIGHT_M, **drone: float) -> Descent:
    """Down at an even rate over a vehicle that drives north-east."""
    steps = int(((height_m + 0.4) / SINK_M_S + RULES.waits_max_s) / DT_S)
    way_down = np.zeros((3, steps))
    way_down[0] = height_m - SINK_M_S * DT_S * np.arange(steps)
    way_down[1] = -SINK_M_S
    course = Course(
        direction=np.tile([0.6, 0.8], (steps, 1)),
        speed_m_s=np.full(steps, SPEED_M_S),
        along_m_s2=np.zeros(steps),
        left_m_s2=np.zeros(steps),
        way_down=way_down,
        slope=np.zeros((steps, 2)),
        shake_enu=np.zeros((2, steps, 2)),
        air_enu_m_s2=np.array([0.3, 0.4]),
        model=np.zeros((3, 2)),
    )
    return Descent(course=course, drone=DRONE._replace(**drone), rules=RULES)


def samples(count: int = 1, *, delay_s: float = 0.2, kind: int = STEADY, event: Array | None = None) -> Samples:
    """Samples that are all alike."""
    return Samples(
        vehicle=np.zeros((count, 3, 2)),
        kind=np.full(count, kind),
        event=np.tile([NEVER_S, 0.0, 0.1, NEVER_S] if event is None else event, (count, 1)),
        delay_s=np.full(count, delay_s),
        ahead_s=np.zeros(count),
        deviation=np.zeros((count, 4, 2)),
        vertical=np.zeros((count, 2)),
        deck=np.zeros((count, 3, 2)),
        pushes=np.zeros((count, STEPS_MAX, 2)),
    )
