"""Whether the vehicle heads where it goes, and what of it nobody can know; pure.

A heading from a magnetometer beside steel, or one with its axes mixed up, turns the lever arm from the antenna to the
pad: by 20 degrees the benchmark's pad is half a metre off, by 180 degrees it is beside the vehicle. The course tells,
wherever the vehicle drives; in a curve a car heads a little away from it. A vessel heads where it goes through the
water, and wind and current carry that along: at a speed V over ground those of u turn its course from its heading by
asin(u / V) at most, and below u by any angle. One that reverses goes backwards by right:
that is believed of a vehicle whose heading has agreed with its course before, and of no other.
"""

import math
from enum import Enum

from msgspec import Struct

from companion.config.companion import CompanionConfig
from companion.config.integrity import IntegrityConfig, ReceiverFrames
from companion.core.data import STEP_MAX_S
from companion.core.reasons import Cause, Reason
from companion.situation.situation import Situation
from companion.vehicle.pad import PadPath
from companion.vehicle.pad_reach import cone_radius_at_pad_m
from link.records import replace

_COURSE_OVER_S = 2.0  # heading and course are compared over so long: a cheap heading has 5 degrees of noise
_COURSE_STD_MAX = 0.1  # standard deviation of the speed, as a share of it: 6 degrees of the course
_COURSE_STDS = 3.0  # of the course, by which more it may be off: over poor data it errs for as long as that
_CAR_M = 3.0  # times the curvature: what a point of a car slips beside its heading
_BACK_WITHIN = 0.7  # of the limit, to be believed again


class CourseWatch(Struct, frozen=True, kw_only=True):
    """How the heading has compared with the course.

    Attributes:
        off_cos: mean cosine of the heading's angle from the course.
        off_sin: mean sine of it.
        compared_s: for how long without a stop they have been compared.
        compared_ns: when they were compared last, monotonic; None before the first time.
        has_agreed: they agreed once.
        has_stopped: it was slow since then: without a stop none that drives forwards begins to go backwards.
        off_rad: by how much the heading was off when it was found to contradict the course; None while it does not.
    """

    off_cos: float = 1.0
    off_sin: float = 0.0
    compared_s: float = 0.0
    compared_ns: int | None = None
    has_agreed: bool = False
    has_stopped: bool = False
    off_rad: float | None = None


def update_course(
    watch: CourseWatch, monotonic_ns: int, pad: PadPath | None, speed_std_m_s: float, config: CompanionConfig
) -> CourseWatch:
    """Return the watch after a step.

    Args:
        watch: so far.
        monotonic_ns: of this step.
        pad: now, with the vehicle's heading and course.
        speed_std_m_s: of the vehicle's velocity; infinite while that is not known.
        config: all numbers.
    """
    if pad is None or pad.yaw_rad is None:
        return watch
    (vx, vy), (ax, ay) = pad.velocity_enu_m_s[0, :2].tolist(), pad.acceleration_enu_m_s2[0, :2].tolist()
    speed_m_s = math.hypot(vx, vy)
    if speed_m_s < config.integrity.course_speed_min_m_s:
        stopped = replace(watch, compared_s=0.0, compared_ns=None, has_stopped=True)
        return watch if watch.compared_ns is None else stopped
    if speed_std_m_s > _COURSE_STD_MAX * speed_m_s:
        return watch
    step_s = 0.0 if watch.compared_ns is None else min((monotonic_ns - watch.compared_ns) * 1e-9, STEP_MAX_S)
    compared_s = watch.compared_s + step_s
    share = step_s / min(compared_s, _COURSE_OVER_S) if compared_s > 0.0 else 1.0
    off_rad = pad.yaw_rad - math.atan2(vy, vx)
    watch = replace(
        watch,
        off_cos=watch.off_cos + share * (math.cos(off_rad) - watch.off_cos),
        off_sin=watch.off_sin + share * (math.sin(off_rad) - watch.off_sin),
        compared_s=compared_s,
        compared_ns=monotonic_ns,
    )
    slip_rad = max(_CAR_M, pad.mounting.arm_m) * abs(vx * ay - vy * ax) / speed_m_s**3
    unsure_rad = _COURSE_STDS * speed_std_m_s / speed_m_s
    off_max_rad = _off_max_rad(pad, speed_m_s, config)
    if compared_s < _COURSE_OVER_S or off_max_rad is None:
        return watch
    return _judge(watch, off_max_rad, unsure_rad, slip_rad)


def course_off_max_rad(speed_m_s: float, config: IntegrityConfig, *, is_afloat: bool) -> float | None:
    """Return by how much a heading may be off the course at a speed over ground, None where it may be by any angle."""
    if not is_afloat:
        return config.heading_off_max_rad
    if speed_m_s <= config.vessel_drift_max_m_s:
        return None
    return config.heading_off_max_rad + math.asin(config.vessel_drift_max_m_s / speed_m_s)


def _off_max_rad(pad: PadPath, speed_m_s: float, config: CompanionConfig) -> float | None:
    """Return by how much this vehicle's heading may be off, None where the course says nothing.

    At the end of a long arm a pad that has not been seen is off by S2's limit before a car's heading is.
    """
    mounting = pad.mounting
    most_rad = course_off_max_rad(speed_m_s, config.integrity, is_afloat=mounting.is_afloat)
    if most_rad is None or mounting.is_afloat or mounting.arm_m == 0.0 or pad.frame_offset.is_confirmed:
        return most_rad
    return min(most_rad, cone_radius_at_pad_m(pad.half_width_m, config) / mounting.arm_m)


def _judge(watch: CourseWatch, off_max_rad: float, unsure_rad: float, slip_rad: float) -> CourseWatch:
    """Return the watch after a comparison.

    Doubts about the course widen the limit that contradicts a heading, and a bend's slip that of one that has agreed.
    One that was contradicted is believed again well within the limit, which no doubt widens then and a slip narrows.
    """
    off_rad = abs(math.atan2(watch.off_sin, watch.off_cos))
    if watch.off_rad is None:
        within_rad = off_max_rad + unsure_rad + (slip_rad if watch.has_agreed else 0.0)
    else:
        within_rad = _BACK_WITHIN * off_max_rad - slip_rad
    if off_rad <= within_rad:
        is_known = watch.has_agreed and not watch.has_stopped and watch.off_rad is None
        return watch if is_known else replace(watch, has_agreed=True, has_stopped=False, off_rad=None)
    if watch.has_agreed and watch.has_stopped and math.pi - off_rad <= within_rad:
        return watch if watch.off_rad is None else replace(watch, off_rad=None)
    return watch if watch.off_rad is not None else replace(watch, off_rad=off_rad)


def without_contradicted_heading(pad: PadPath, watch: CourseWatch) -> PadPath:
    """Return the pad, not placed where that takes a heading that the course contradicts."""
    if watch.off_rad is None or pad.mounting.arm_m == 0.0 or pad.unplaced is not None:
        return pad
    return replace(pad, unplaced=Cause(Reason.HEADING_OFF_COURSE, (math.degrees(watch.off_rad),)))


def contradicted_heading(pad: PadPath | None) -> Cause | None:
    """Return what is told of a heading that the course contradicts: it turns the arm with which sightings are compared.

    None where nothing contradicts it.
    """
    why = None if pad is None else pad.unplaced
    return why if why is not None and why.reason is Reason.HEADING_OFF_COURSE else None


_LATE_S = 0.1  # by which a receiver's output follows its measurement: Pixhawk, NMEA and ROS drivers stamp either


class Unverified(Enum):
    """What is believed, with a place for its number."""

    PLACE = "the pad is where sightings alone say: nothing shows a detector that is always off by the same"
    FRAMES = "both receivers are taken to have one frame, for their phases are fixed: nothing sees the pad"
    STAMPS = "the vehicle's stamps: those that are {late_s:g} s late put the pad {off_m:.1f} m off, and nothing sees it"
    LEVER = "the vehicle's antenna_to_pad_m: nothing sees where the pad is on the vehicle"
    HEADING = (
        "the vehicle's heading: {off_deg:.0f} degrees put the pad {off_m:.1f} m off, and neither a course nor a "
        "detector has shown it"
    )


def unverified(s: Situation, c: CompanionConfig) -> tuple[str, ...]:
    """Return what nobody can know in this step, in words."""
    pad = s.pad
    if pad is None:
        return ()
    if pad.is_coarse or not pad.has_one_frame:
        return (Unverified.PLACE.value,) if pad.frame_offset.is_confirmed else ()
    if pad.frame_offset.is_confirmed:
        return ()
    off_m = _LATE_S * pad.ground_speed_m_s
    stamps = Unverified.STAMPS.value.format(late_s=_LATE_S, off_m=off_m)
    frames = (Unverified.FRAMES.value,) if c.integrity.receiver_frames is ReceiverFrames.AUTO else ()
    return (stamps, Unverified.LEVER.value, *frames, *_unverified_heading(s, c))


def _unverified_heading(s: Situation, c: CompanionConfig) -> tuple[str, ...]:
    """Return what a heading that is as far off as a course would let it be does to a pad beside the antenna."""
    pad = s.pad
    if pad is None or pad.unplaced is not None or pad.mounting.arm_m == 0.0 or s.vehicle.has_shown_heading:
        return ()
    off_rad = c.integrity.heading_off_max_rad
    off_m = 2.0 * pad.mounting.arm_m * math.sin(0.5 * off_rad)
    return (Unverified.HEADING.value.format(off_deg=math.degrees(off_rad), off_m=off_m),)
