"""Data that contradict each other are counted over the last seconds, and told; outages and new beginnings are not.

A heading that the course contradicts places no pad; noise, slip and honest reversing contradict nothing.
"""

import math

import numpy as np
import pytest

from companion.core.data import VehicleEstimate
from companion.core.reasons import Reason, sentence
from companion.integrity.vehicle_data import (
    Contradictions,
    CourseWatch,
    update_contradictions,
    update_course,
    without_contradicted_heading,
)
from companion.landing.decisions.feasibility import obstacle
from companion.situation.phases import Phase
from companion.vehicle.estimator import BufferHealth
from companion.vehicle.pad import PadMounting, PadPath
from link.messages import PadGeometry
from link.records import replace
from tests.companion.facts import CONFIG, NOW_NS, changed, pad_at, situation
from tests.companion.world import PAD_HEIGHT_M, Flight, KnownVehicle

HALF_NS = 500_000_000


def health(fused: int, gated: int) -> BufferHealth:
    return BufferHealth(
        fused=fused, gated=gated, late=0, recoveries=0, nis_per_dof=None, nis_dof=0, recent_nis_per_dof=None
    )


def after(per_half_second: list[tuple[int, int]]) -> Contradictions:
    """Count measurements that came accepted and rejected, half a second after half a second."""
    counts, fused, gated = update_contradictions(Contradictions(), health(0, 0), NOW_NS), 0, 0
    for k, (accepted, rejected) in enumerate(per_half_second):
        fused, gated = fused + accepted, gated + rejected
        assert counts.is_due(NOW_NS + (k + 1) * HALF_NS)
        counts = update_contradictions(counts, health(fused, gated), NOW_NS + (k + 1) * HALF_NS)
    return counts


def test_share_is_of_the_last_ten_seconds() -> None:
    assert after([(10, 0)] * 30 + [(6, 4)] * 20).rejected_share == pytest.approx(0.4)
    assert after([(6, 4)] * 30 + [(10, 0)] * 20).rejected_share == 0.0
    assert after([(10, 0)] * 5 + [(6, 4)] * 5).rejected_share == pytest.approx(0.2)


def test_of_a_handful_nothing_is_said() -> None:
    assert after([(1, 1)] * 5).rejected_share == 0.0


def test_estimate_that_begins_anew_is_counted_anew() -> None:
    before = after([(6, 4)] * 10)
    assert update_contradictions(before, health(3, 0), NOW_NS + 10**10).rejected_share == 0.0


def test_it_is_not_due_with_every_step() -> None:
    counts = after([(10, 0)])
    assert not counts.is_due(NOW_NS + HALF_NS + HALF_NS // 2)


def test_it_keeps_a_landing_from_being_begun_and_is_told_with_the_share() -> None:
    facts = changed(situation(), rejected_share=0.41)
    known = obstacle({Reason.MEASUREMENTS_REJECTED: NOW_NS}, facts, CONFIG)
    assert known is not None
    assert sentence(known).startswith(
        "vehicle data contradict themselves: 41 % of the last 10 s' measurements were rejected"
    )


STEP_S = 1.0 / CONFIG.setpoints.rate_hz
STD_M_S = 0.05
COURSE_RAD = 2.7
BESIDE = PadGeometry(size_m=(1.5, 1.5), height_m=PAD_HEIGHT_M, antenna_to_pad_m=(1.2, -0.5, 0.0))


def driving(off_rad: float, speed_m_s: float = 5.0, lateral_m_s2: float = 0.0) -> PadPath:
    """A pad on a vehicle whose heading is `off_rad` left of its course."""
    along = np.array([math.cos(COURSE_RAD), math.sin(COURSE_RAD), 0.0])
    pad = pad_at(tuple((speed_m_s * along).tolist()))
    across = np.tile(lateral_m_s2 * np.array([-along[1], along[0], 0.0]), (len(pad.offset_s), 1))
    return replace(
        pad, yaw_rad=COURSE_RAD + off_rad, acceleration_enu_m_s2=across, mounting=PadMounting(needs_heading=True)
    )


def course_after(watch: CourseWatch, pad: PadPath, duration_s: float = 6.0, *, std_m_s: float = STD_M_S) -> CourseWatch:
    for _ in range(round(duration_s / STEP_S)):
        watch = update_course(watch, pad, std_m_s, CONFIG)
    return watch


@pytest.mark.parametrize("degrees", [20.0, -90.0, 180.0])
def test_pad_beside_the_antenna_is_not_placed_by_a_heading_that_is_off(degrees: float) -> None:
    pad = driving(math.radians(degrees))
    watch = course_after(CourseWatch(), pad)
    placed = without_contradicted_heading(pad, watch)
    assert placed.unplaced is not None
    assert sentence(placed.unplaced) == f"vehicle heading is {abs(degrees):.0f} degrees off its course"


@pytest.mark.parametrize("degrees", [0.0, 5.0, -10.0])
def test_slip_and_mounting_contradict_nothing(degrees: float) -> None:
    watch = course_after(CourseWatch(), driving(math.radians(degrees)))
    assert watch.off_rad is None
    assert watch.has_agreed


def test_white_noise_of_a_cheap_heading_contradicts_nothing() -> None:
    rng = np.random.default_rng(5)
    watch = CourseWatch()
    for _ in range(round(60.0 / STEP_S)):
        watch = update_course(watch, driving(float(rng.normal(0.0, math.radians(10.0)))), STD_M_S, CONFIG)
        assert watch.off_rad is None


def test_tight_curve_explains_more() -> None:
    lateral_m_s2 = 4.0  # at 5 m/s a radius of 6 m
    off_rad = math.radians(25.0)
    assert course_after(CourseWatch(), driving(off_rad, lateral_m_s2=lateral_m_s2)).off_rad is None
    assert course_after(CourseWatch(), driving(off_rad)).off_rad is not None


def test_course_that_is_known_poorly_contradicts_less() -> None:
    pad = driving(math.radians(20.0))
    assert course_after(CourseWatch(), pad, std_m_s=0.4).off_rad is None
    assert course_after(CourseWatch(), pad, std_m_s=0.1).off_rad is not None


@pytest.mark.parametrize(
    ("pad", "std_m_s"),
    [
        (driving(math.pi, speed_m_s=1.0), STD_M_S),
        (driving(math.pi), 1.0),
        (driving(math.pi), math.inf),
        (replace(driving(math.pi), yaw_rad=None), STD_M_S),
    ],
)
def test_nothing_is_judged_by_a_course_that_is_not_known(pad: PadPath, std_m_s: float) -> None:
    assert course_after(CourseWatch(), pad, std_m_s=std_m_s).off_rad is None


def test_vehicle_that_has_driven_forwards_may_reverse() -> None:
    watch = course_after(CourseWatch(), driving(0.05))
    watch = course_after(watch, driving(0.05, speed_m_s=0.0), 1.0)
    assert course_after(watch, driving(math.pi - 0.05)).off_rad is None


def test_contradiction_outlasts_a_stop_and_ends_with_agreement() -> None:
    watch = course_after(CourseWatch(), driving(0.5))
    assert course_after(watch, driving(0.5, speed_m_s=0.0)).off_rad == watch.off_rad
    assert course_after(watch, driving(0.0)).off_rad is None


def test_pad_at_the_antenna_needs_no_heading() -> None:
    pad = replace(driving(math.pi), mounting=PadMounting())
    assert without_contradicted_heading(pad, course_after(CourseWatch(), pad)).unplaced is None


class DrivingVehicle(KnownVehicle):
    """One whose speed is known as well."""

    def estimate(self, _memory: int | None, t_ns: int) -> VehicleEstimate | None:
        return VehicleEstimate(
            t_ns=t_ns,
            position_enu_m=self.at(t_ns),
            velocity_enu_m_s=np.array(self.velocity_enu_m_s),
            acceleration_enu_m_s2=np.zeros(3),
            covariance=np.eye(9) * STD_M_S**2,
            yaw_rad=self.yaw_rad,
            yaw_rate_rad_s=None,
        )


@pytest.mark.slow
def test_vehicle_with_a_wrong_heading_is_followed_not_landed_on_and_the_status_says_why() -> None:
    vehicle = DrivingVehicle((-20.0, 0.4, PAD_HEIGHT_M), (4.0, 0.0, 0.0), yaw_rad=math.pi)
    flight = Flight(vehicle=vehicle, pad=BESIDE)
    flight.start_and_reach(Phase.ALIGN)
    outputs = flight.run(CONFIG.descent.alignment.time_limit_s - 1.0)
    assert flight.phase is Phase.ALIGN
    assert outputs[-1].status.reason == "vehicle heading is 180 degrees off its course"
    flight.run_until(Phase.HOLD)
    assert flight.sentence == "vehicle heading is 180 degrees off its course"
