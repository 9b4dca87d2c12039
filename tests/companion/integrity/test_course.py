"""A heading that the course contradicts places no pad; noise, slip and honest reversing contradict nothing."""

import math

import numpy as np
import pytest

from companion.core.data import VehicleEstimate
from companion.core.reasons import sentence
from companion.integrity.vehicle_data import CourseWatch, update_course, without_contradicted_heading
from companion.situation.phases import Phase
from companion.vehicle.pad import NOT_DESCRIBED, PadMounting, PadPath
from link.messages import PadGeometry
from link.records import replace
from tests.companion.facts import CONFIG, pad_at
from tests.companion.world import PAD_HEIGHT_M, Flight, KnownVehicle

STEP_S = 1.0 / CONFIG.setpoints.rate_hz
STD_M_S = 0.05
COURSE_RAD = 2.7
BESIDE = PadGeometry(size_m=(1.5, 1.5), height_m=PAD_HEIGHT_M, antenna_to_pad_m=(1.2, -0.5, 0.0))


def driving(off_rad: float, speed_m_s: float = 5.0, lateral_m_s2: float = 0.0) -> PadPath:
    """A pad on a vehicle whose heading is `off_rad` left of its course."""
    along = np.array([math.cos(COURSE_RAD), math.sin(COURSE_RAD), 0.0])
    pad = pad_at(tuple((speed_m_s * along).tolist()))
    across = np.tile(lateral_m_s2 * np.array([-along[1], along[0], 0.0]), (len(pad.offset_s), 1))
    return replace(pad, yaw_rad=COURSE_RAD + off_rad, acceleration_enu_m_s2=across, mounting=PadMounting(arm_m=1.3))


def course_after(
    watch: CourseWatch, pad: PadPath, duration_s: float = 6.0, *, std_m_s: float = STD_M_S, step_s: float = STEP_S
) -> CourseWatch:
    begins_ns = 0 if watch.compared_ns is None else watch.compared_ns
    for step in range(1, round(duration_s / step_s) + 1):
        watch = update_course(watch, begins_ns + round(step * step_s * 1e9), pad, std_m_s, CONFIG)
    return watch


@pytest.mark.parametrize("step_s", [0.01, 0.02, 0.04, 0.08])
def test_heading_is_judged_after_the_same_time_however_often_steps_are_made(step_s: float) -> None:
    pad = driving(math.radians(40.0))
    assert course_after(CourseWatch(), pad, 1.9, step_s=step_s).off_rad is None
    assert course_after(CourseWatch(), pad, 2.2, step_s=step_s).off_rad is not None


def test_pause_counts_for_a_step() -> None:
    pad = driving(math.radians(40.0))
    watch = update_course(course_after(CourseWatch(), pad, 1.0), 10**12, pad, STD_M_S, CONFIG)
    assert watch.compared_s < 1.2


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
    for step in range(round(60.0 / STEP_S)):
        now_ns = round(step * STEP_S * 1e9)
        watch = update_course(watch, now_ns, driving(float(rng.normal(0.0, math.radians(10.0)))), STD_M_S, CONFIG)
        assert watch.off_rad is None


def test_tight_curve_explains_more() -> None:
    lateral_m_s2 = 4.0  # at 5 m/s a radius of 6 m
    off_rad = math.radians(25.0)
    agreed = course_after(CourseWatch(), driving(0.0))
    assert course_after(agreed, driving(off_rad, lateral_m_s2=lateral_m_s2)).off_rad is None
    assert course_after(agreed, driving(off_rad)).off_rad is not None
    assert course_after(CourseWatch(), driving(off_rad, lateral_m_s2=lateral_m_s2)).off_rad is not None


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


LIMIT_RAD = CONFIG.integrity.heading_off_max_rad + 3.0 * STD_M_S / 5.0  # at 5 m/s, by three deviations of the course


def is_off(pad: PadPath, *, std_m_s: float = STD_M_S, duration_s: float = 6.0) -> bool:
    return course_after(CourseWatch(), pad, duration_s, std_m_s=std_m_s).off_rad is not None


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_heading_is_off_beyond_what_is_set_and_three_deviations_of_the_course(sign: float) -> None:
    assert not is_off(driving(sign * (LIMIT_RAD - 0.01)))
    assert is_off(driving(sign * (LIMIT_RAD + 0.01)))


@pytest.mark.parametrize("lateral_m_s2", [-2.0, 2.0])
def test_curve_explains_the_slip_of_a_point_three_metres_off_the_axle(lateral_m_s2: float) -> None:
    slip_rad = 3.0 * 2.0 / 5.0**2  # times the curvature
    for more_rad, is_off_now in ((-0.01, False), (0.01, True)):
        agreed = course_after(CourseWatch(), driving(0.0))
        bends = driving(LIMIT_RAD + slip_rad + more_rad, lateral_m_s2=lateral_m_s2)
        assert (course_after(agreed, bends, 20.0).off_rad is not None) is is_off_now


def test_course_is_that_of_now_and_not_of_what_is_ahead() -> None:
    turns = driving(0.0)
    ahead = np.outer(np.arange(5.0), [1.0, -3.0, 0.0])
    turns = replace(
        turns,
        velocity_enu_m_s=turns.velocity_enu_m_s + ahead,
        acceleration_enu_m_s2=turns.acceleration_enu_m_s2 + ahead,
    )
    assert not is_off(turns)
    assert is_off(replace(turns, yaw_rad=COURSE_RAD + LIMIT_RAD + 0.01))


@pytest.mark.parametrize(("duration_s", "expected"), [(1.9, False), (2.1, True)])
def test_two_seconds_are_compared_anew_after_each_stop(duration_s: float, *, expected: bool) -> None:
    pad = driving(0.5)
    assert is_off(pad, duration_s=duration_s) is expected
    stopped = course_after(course_after(CourseWatch(), pad, 1.9), driving(0.5, speed_m_s=1.9), 0.1)
    assert (course_after(stopped, pad, duration_s).off_rad is not None) is expected


@pytest.mark.parametrize(("share", "expected"), [(0.099, True), (0.101, False)])
def test_course_that_is_uncertain_by_more_than_a_tenth_of_the_speed_judges_nothing(
    share: float, *, expected: bool
) -> None:
    assert is_off(driving(math.pi), std_m_s=share * 5.0) is expected


@pytest.mark.parametrize(("speed_m_s", "expected"), [(1.99, False), (2.01, True)])
def test_vehicle_that_hardly_moves_has_no_course(speed_m_s: float, *, expected: bool) -> None:
    assert is_off(driving(math.pi, speed_m_s=speed_m_s)) is expected


@pytest.mark.parametrize(("turned_rad", "side"), [(0.0, 1.0), (math.pi, -1.0)], ids=["forwards", "backwards"])
def test_heading_that_was_off_is_believed_again_well_within_the_limit(turned_rad: float, side: float) -> None:
    agreed = course_after(CourseWatch(), driving(0.0))
    off = course_after(course_after(agreed, driving(1.2)), driving(1.2, speed_m_s=0.5), 1.0)
    assert off.off_rad is not None
    for share, is_still_off in ((0.72, True), (0.68, False)):
        watch = course_after(off, driving(turned_rad + side * share * CONFIG.integrity.heading_off_max_rad), 20.0)
        assert (watch.off_rad is not None) is is_still_off


def test_bend_shows_no_heading_to_be_right_that_a_straight_has_contradicted() -> None:
    off = course_after(CourseWatch(), driving(LIMIT_RAD + 0.05))
    assert course_after(off, driving(LIMIT_RAD + 0.05, lateral_m_s2=4.0), 20.0).off_rad is not None
    assert course_after(off, driving(0.0, lateral_m_s2=4.0), 20.0).off_rad is not None  # a slip may hide it
    assert course_after(off, driving(0.0, lateral_m_s2=1.0), 20.0).off_rad is None


def test_vehicle_that_drives_on_does_not_begin_to_reverse_without_a_stop() -> None:
    agreed = course_after(CourseWatch(), driving(0.0))
    assert course_after(agreed, driving(math.pi)).off_rad is not None
    stood = course_after(agreed, driving(0.0, speed_m_s=0.5), 1.0)
    reverses = course_after(stood, driving(math.pi))
    assert reverses.off_rad is None
    forwards = course_after(course_after(reverses, driving(0.0, speed_m_s=0.5), 1.0), driving(0.0))
    assert course_after(forwards, driving(math.pi)).off_rad is not None


@pytest.mark.parametrize(
    ("arm_m", "is_afloat", "is_seen", "expected"),
    [(1.3, False, False, False), (6.0, False, False, True), (6.0, True, False, False), (6.0, False, True, False)],
)
def test_heading_is_judged_by_what_it_is_off_at_the_end_of_the_arm(
    arm_m: float, *, is_afloat: bool, is_seen: bool, expected: bool
) -> None:
    """Of 7 degrees: 0.73 m at the end of 6 m; a pad that has been seen is where it was seen."""
    pad = driving(math.radians(7.0))
    mounting = PadMounting(arm_m=arm_m, is_afloat=is_afloat)
    placed = replace(pad, mounting=mounting, frame_offset=replace(pad.frame_offset, is_confirmed=is_seen))
    assert (course_after(CourseWatch(), placed).off_rad is not None) is expected


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("speed_m_s", [2.2, 5.0, 10.0])
def test_vessel_may_head_as_far_off_its_course_as_a_current_turns_it(sign: float, speed_m_s: float) -> None:
    """Closed form: the heading of the motion through the water is that of the course less the current across it."""
    drift_m_s = CONFIG.integrity.vessel_drift_max_m_s
    through_water_m_s = math.sqrt(speed_m_s**2 - drift_m_s**2)
    limit_rad = (
        math.atan2(drift_m_s, through_water_m_s) + CONFIG.integrity.heading_off_max_rad + 3.0 * STD_M_S / speed_m_s
    )
    for more_rad, expected in ((-0.01, False), (0.01, True)):
        pad = driving(sign * (limit_rad + more_rad), speed_m_s)
        assert is_off(replace(pad, mounting=PadMounting(arm_m=1.3, is_afloat=True))) is expected


@pytest.mark.parametrize("degrees", [90.0, 180.0])
def test_vessel_with_exchanged_axes_is_found_from_the_speed_on_that_has_a_course(degrees: float) -> None:
    pad = driving(math.radians(degrees), CONFIG.integrity.course_speed_min_m_s)
    assert is_off(replace(pad, mounting=PadMounting(arm_m=1.3, is_afloat=True)))


def test_vessel_slower_than_its_current_is_neither_right_nor_wrong() -> None:
    slowly = CONFIG.integrity.model_copy(update={"course_speed_min_m_s": 1.0})
    config = CONFIG.model_copy(update={"integrity": slowly})
    pad = replace(driving(math.pi, 1.4), mounting=PadMounting(arm_m=1.3, is_afloat=True))
    for before in (CourseWatch(), CourseWatch(off_rad=1.0)):
        watch = before
        for step in range(1, round(6.0 / STEP_S) + 1):
            watch = update_course(watch, round(step * STEP_S * 1e9), pad, STD_M_S, config)
        assert (watch.off_rad, watch.has_agreed) == (before.off_rad, False)


def test_vehicle_that_was_never_seen_to_go_forwards_does_not_reverse_by_right() -> None:
    assert is_off(driving(math.pi))


def test_heading_is_told_as_far_off_as_when_it_was_found_to_be() -> None:
    off = course_after(CourseWatch(), driving(1.0))
    assert course_after(off, driving(2.0)).off_rad == off.off_rad == pytest.approx(1.0)


def test_pad_that_is_not_placed_for_another_reason_keeps_that_one() -> None:
    pad = replace(driving(math.pi), unplaced=NOT_DESCRIBED)
    assert without_contradicted_heading(pad, course_after(CourseWatch(), pad)).unplaced is NOT_DESCRIBED


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
