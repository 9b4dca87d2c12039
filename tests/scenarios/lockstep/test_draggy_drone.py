"""A drone whose drag takes most of its lean lands where turn and drag together are within its tilt limit."""

import math

import pytest

from scenarios.catalogue.catalogue import load_changed_scenario
from scenarios.lockstep.lockstep import Lockstep
from scenarios.recordings.result import score_run
from scenarios.scoring.score import Tier

CIRCLE = ("track.speed_m_s=7.5", "system.drone.airframe=arducopter")


@pytest.mark.slow
def test_it_follows_a_turn_across_its_drag_that_takes_nearly_all_of_its_tilt() -> None:
    """3.5 m/s^2 of drag along the way and 2.8 across it, 4.5 in all, of the 4.8 that are planned with.

    On the roof the air is faster by an eighth: there drag, which grows with its square, takes 4.4 m/s^2.
    """
    scenario = load_changed_scenario("circle_8+firmware=ardupilot", CIRCLE)
    run = Lockstep(scenario, seed=1)
    run.run()
    scored = score_run(scenario, 1, run.recording)
    assert scored.tier is Tier.S3
    assert scored.touchdown is not None
    assert scored.touchdown.trim_rad == pytest.approx(math.atan(4.4 / 9.81), abs=0.02)
