"""The forecast's kernel compiled before a flight: no step may wait for it."""

import numpy as np

from companion.forecast.draws import STEPS_MAX
from companion.forecast.rollout import roll_out
from companion.forecast.samples import STEADY, Course, Descent, Follower, Rules, Samples


def compile_rollout() -> None:
    """Roll out one sample of one step, which compiles what there is to compile."""
    course = Course(
        direction=np.array([[1.0, 0.0]]),
        speed_m_s=np.zeros(1),
        along_m_s2=np.zeros(1),
        left_m_s2=np.zeros(1),
        way_down=np.zeros((3, 1)),
        slope=np.zeros((1, 2)),
        shake_enu=np.zeros((2, 1, 2)),
        air_enu_m_s2=np.zeros(2),
        model=np.zeros((3, 2)),
    )
    samples = Samples(
        vehicle=np.zeros((1, 3, 2)),
        kind=np.array([STEADY]),
        event=np.ones((1, 4)),
        delay_s=np.zeros(1),
        ahead_s=np.zeros(1),
        deviation=np.zeros((1, 4, 2)),
        vertical=np.zeros((1, 2)),
        deck=np.zeros((1, 3, 2)),
        pushes=np.zeros((1, STEPS_MAX, 2)),
    )
    drone, rules = Follower(*(1.0,) * len(Follower._fields)), Rules(*(1.0,) * len(Rules._fields))
    roll_out(samples, Descent(course=course, drone=drone, rules=rules), 0.0)
