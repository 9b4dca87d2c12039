"""What can be set about a landing: each phase from the take-off on, and the tests that abort it."""

from enum import Enum
from typing import Annotated

from pydantic import Field, ValidationInfo, field_validator

from link.program.toml_config import NotNegative, Positive, StrictModel


class LandingStyle(Enum):
    """The way from the waiting point onto the pad."""

    STAGED = "staged"  # chase above the vehicle, align, descend inside the cone, switch off
    DIRECT = "direct"  # the pad's centre is the target from the start, contact or not; the source report


class TakeoffConfig(StrictModel):
    """The climb to the waiting point and the wait."""

    waiting_height_m: Positive = 5.0  # above where it took off; source report, section "Task"
    reached_distance_m: Positive = 0.5
    refused_after_s: Positive = 30.0  # PX4 is armable 2.7 to 4.8 s after its start, ArduCopter 41.5 s
    time_limit_s: Positive = 60.0

    @field_validator("time_limit_s")
    @classmethod
    def _outlasts_a_refusal(cls, value: float, info: ValidationInfo) -> float:
        refused_after_s = info.data.get("refused_after_s")
        if refused_after_s is not None and value <= refused_after_s:
            raise ValueError(f"it must be more than refused_after_s, {refused_after_s:g}, or no refusal is ever told")
        return value


class ChaseConfig(StrictModel):
    """When the chase begins and when it is close enough."""

    height_m: Positive = 3.5  # above the pad, until the drone is over it; 5 m over a road under a roof of 1.5 m
    # And so many standard deviations of the pad's height more while it has to be seen first: with a deviation of 2 m,
    # one roof in 25 is 3.5 m or more higher than it is said to be, and the drone would fly into it.
    unseen_height_stds: NotNegative = 2.0
    unseen_height_max_m: Positive = 8.0  # in all; less than the range of the detector that is to see it (12 m here)
    start_acceleration_m_s2: Positive = 3.5  # share of the limit that the rendezvous is planned with
    # A vehicle this near whose road is said to be farther above or below the ground that the drone took off from than a
    # step and a hill can be, has a receiver with another height: a bank beside the road, and a steep street.
    ground_within_m: Positive = 30.0
    ground_step_max_m: Positive = 1.5
    ground_slope_max: NotNegative = 0.07  # metres for each metre between them
    # From this speed on the heading is compared with the course. So far off, the pad is 0.3 m beside its place at the
    # end of the benchmark's lever arm of 1.3 m; side slip and mounting are less.
    course_speed_min_m_s: Positive = 2.0
    heading_off_max_rad: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.21
    # So long a chase looks for a pad that has to be seen, over its said place, before it says what is missing. In this
    # time the offset does not change, and dropouts of a detector last a second.
    unseen_hold_s: Positive = 10.0
    passing_distance_m: Positive = 15.0  # a vehicle that passes farther away than this is not chased
    # One that has passed meanwhile is chased while so much more speed makes its lead up in that time.
    catch_up_speed_m_s: Positive = 10.0
    catch_up_s: Positive = 5.0
    # Slower than this is standing, or than so many standard deviations of a speed that is known less well than that:
    # over poor data a parked vehicle seems to move by 0.3 m/s now and then.
    parked_speed_m_s: Positive = 0.3
    parked_speed_stds: NotNegative = 1.5
    driving_hold_s: NotNegative = (
        0.5  # faster than that for so long is driving: estimates from fixes of 0.1 m jump for 0.3 s
    )
    parked_wait_s: NotNegative = 7.0  # a vehicle that stands may be about to depart
    time_limit_s: Positive = 60.0


class DescentConfig(StrictModel):
    """Alignment over the pad, the cone and the sink rate."""

    align_height_m: Positive = 1.5  # above the pad
    align_distance_m: Positive = 1.5  # horizontal, at which alignment begins
    aligned_distance_m: Positive = 0.25
    aligned_speed_m_s: Positive = 0.5
    aligned_hold_s: NotNegative = 0.2
    align_time_limit_s: Positive = 30.0
    descent_rate_max_m_s: Positive = 1.2
    descent_gain_hz: Positive = 1.0  # sink rate per metre of height left
    touchdown_sink_rate_m_s: Positive = 0.45  # S2 asks for 0.7 at most
    press_depth_m: Positive = 0.5  # how far below the pad the setpoint goes on, so that contact is firm
    cone_radius_at_pad_m: Positive = 0.3  # 0.2 of the width of a pad narrower than 1.5 m
    cone_slope: NotNegative = 0.35  # metres of radius per metre of height
    pad_width_min_m: Positive = 0.5  # narrower ones are refused: the cone would end narrower than 0.1 m
    # While the vehicle brakes or speeds up harder than this, as the drone must lean for, the descent waits, as it does
    # beside the cone and while the drone moves too fast against the pad.
    speed_change_max_m_s2: Positive = 1.2
    waiting_height_m: Positive = 0.85  # a heaving roof and a late stop leave the drone above `abort.near_height_m`
    # Likewise over a pad that only the detector places, which is blind below 0.5 m: what is known late grows old below.
    waiting_height_coarse_m: Positive = 0.7
    # Above this a pad that only the detector places is waited above, too, until it is within `aligned_distance_m`: what
    # is made up for below is speed against the pad at contact, and the detector is blind there.
    centred_height_m: NotNegative = 0.5
    # Faster than this against the pad it waits there, too, to settle (S2 asks for 0.5 at contact), and faster
    # than so many standard deviations of the vehicle's velocity, for of a speed that is hardly known nothing is gained.
    waiting_speed_m_s: Positive = 0.4
    waiting_speed_stds: NotNegative = 1.5
    # So far off, in hindsight, the vehicle's speed may have been believed; S1 asks for 1.0 m/s at contact. Beyond
    # it the descent waits until the vehicle stands, or has driven as expected for as long as from one stop to the next.
    surprise_speed_m_s: Positive = 0.7
    hard_brake_m_s2: Positive = 1.6  # over 2 s: surprises the drone, however fresh the data; `random` 0.7
    # A vehicle whose speed has changed like that in the last 15 s, and whose data are older than this, is waited above,
    # too: what it does in the last second is known too late. An even driver shows 0.1 m/s^2, `random` 0.7.
    uneven_acceleration_m_s2: Positive = 0.35
    winding_acceleration_m_s2: Positive = 0.8  # to the side; `figure_eight` shows 0.6 at 5 m/s and 1.2 at 7
    # A drone leans into a curve and levels in its last 0.3 s, which over such links comes 0.1 s early or late; with the
    # 6 degrees by which it sways there S1's 15 over trim are left for a curve of this.
    turning_acceleration_m_s2: Positive = 2.4
    uneven_age_s: NotNegative = 0.3
    stop_s: NotNegative = 4.0  # likewise, a vehicle that has stopped; `stop_and_go` departs after 3 s
    surprise_hold_s: NotNegative = 20.0  # `stop_and_go` brakes again 15 s later
    surprise_wait_max_s: NotNegative = 60.0  # for which it waits so without its time limit running: three surprises
    stray_hold_s: NotNegative = 3.0  # beside the cone or too fast, but high enough to be aligned again
    strays_max: Annotated[int, Field(ge=0, le=20)] = 3  # so often in one approach, as retries: a gust may last
    # Likewise an approach to a pad that has to be seen (again): 3 times at most in 60 landings over poor links.
    unseen_max: Annotated[int, Field(ge=0, le=100)] = 10
    commit_height_m: Positive = 0.35  # below this it lands rather than aborts
    # Standard deviation up to which a pad is landed on that the vehicle's fixes are too coarse to place: half of what
    # S1 allows. Its pattern must have been seen as lately as that, while the drone and the vehicle's clock wander.
    unseen_std_max_m: Positive = 0.25
    unseen_hold_s: NotNegative = 1.5  # in the alignment, before it climbs to see more of the road
    # Lean beyond that of the last second, as an acceleration: 8.7 degrees of the 15 over trim that S1 allows. Low above
    # the pad the drone then waits at the commit height for the gust or the correction to pass.
    sway_max_m_s2: Positive = 1.5
    calm_hold_s: NotNegative = 0.25
    sway_height_m: NotNegative = 0.1  # of the lowest foot, below which the contact comes before a stop
    time_limit_s: Positive = 30.0


class TouchdownConfig(StrictModel):
    """The signs of a contact and the switching off of the motors."""

    gear_height_m: NotNegative = 0.12  # from the feet to the point whose position the autopilot reports
    height_max_m: Positive = 0.35  # estimated height over the pad at which a contact is believed
    blocked_depth_m: Positive = 0.06  # how far the setpoint has sunk below the drone
    blocked_speed_m_s: Positive = 0.2  # relative vertical speed that counts as standing
    pressed_speed_m_s: Positive = 0.5  # likewise where it is pressed down and the range finder sees the pad at its feet
    falling_acceleration_m_s2: Positive = 3.5  # downwards faster than this nothing stands on a pad; half of the presses
    range_finder_height_m: NotNegative = 0.12  # of the range finder above the feet
    range_corrects_height: bool = (
        False  # for a drone whose own height wanders: the pad is where the range finder sees it
    )
    range_off_max_m: Positive = 0.4  # what it sees may be nearer than the pad by so much before a landing is broken off
    range_off_hold_s: NotNegative = 0.3  # so long readings and attitude belong together
    range_height_max_m: Positive = 0.15  # seen under the feet at which the range finder still agrees with a contact
    hold_s: NotNegative = 0.1
    jolt_m_s2: Positive = 25.0  # horizontally: no flying changes the velocity so fast, and no hold is waited for
    stopped_hold_s: Positive = 0.3  # after a jolt, pressed down without falling: in the air it would sink at 2 m/s then
    disputed_hold_s: NotNegative = 1.0  # instead, when the range finder does not agree
    level_height_m: NotNegative = 0.08  # below this the drone turns less than the deck, to touch down level
    level_late_stds: NotNegative = 1.5  # of the link's delay, by which it begins earlier: so late a setpoint may be
    foot_radius_m: NotNegative = 0.2  # of the feet about the drone's axis: the lowest of a leaning drone touches first
    # By so much of the pad's own acceleration, between these: what it turns more makes the contact slower than tilted,
    # and there is no time for what else would have it lean.
    level_share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.6
    level_acceleration_min_m_s2: Positive = 0.6  # 3.5 degrees
    level_acceleration_max_m_s2: Positive = 1.6  # 9 degrees; S2 allows 10 over trim
    level_speed_max_m_s: Positive = 0.35  # that this may bring against the pad; S2 asks for 0.5 at contact
    # Downwards, while the signs of a contact hold, and once they are believed: nearly the whole weight on the gear.
    try_acceleration_m_s2: Annotated[float, Field(ge=0.0, le=9.0)] = 5.0
    press_acceleration_m_s2: Annotated[float, Field(ge=0.0, le=9.0)] = 9.0
    # So far below the pad's surface for so long, and nothing was touched: it is not there. Heights are off by 0.4 m
    # over poor receivers, and a contact that the range finder disputes is believed after `disputed_hold_s`.
    missed_depth_m: Positive = 0.2
    missed_hold_s: Positive = 2.0
    lost_height_m: Positive = 0.6  # higher than this after a contact is a bounce or a slide
    lost_hold_s: NotNegative = 5.0  # higher than `height_max_m` for so long is none either, or the motors would be off

    @field_validator("try_acceleration_m_s2", "press_acceleration_m_s2")
    @classmethod
    def _would_fall(cls, value: float, info: ValidationInfo) -> float:
        falling_m_s2 = info.data.get("falling_acceleration_m_s2")
        if falling_m_s2 is not None and value <= falling_m_s2:
            raise ValueError(f"it must be more than falling_acceleration_m_s2, {falling_m_s2:g}, to tell pad from air")
        return value


class AbortConfig(StrictModel):
    """The abort tests and the climb after one."""

    fix_age_max_s: Positive = 1.0
    fix_ahead_max_s: NotNegative = 0.05  # so far in the future a fix may be stamped: what clocks err by
    fix_ahead_hold_s: Positive = 1.0  # each fix of that time is; a late or early one says nothing
    # Share of the vehicle's measurements of 10 s that the estimator rejects; over poor links with outages 0.07 at most.
    rejected_share_max: Annotated[float, Field(gt=0.0, le=1.0)] = 0.2
    own_age_max_s: Positive = 0.5  # of the drone's own report; 25 of them in a row are missing then
    position_std_max_m: Positive = 1.5
    # Of the drone's distance from its setpoint, in standard deviations of what gusts do to it by the autopilot's model
    # and of the way that it makes while a setpoint is late by the link's jitter.
    tracking_stds_max: Positive = 10.0
    tracking_hold_s: NotNegative = 1.0
    cone_hold_s: NotNegative = 0.3
    near_height_m: Positive = 0.4  # below this there is no time to wait; what is higher climbs back to wait
    near_speed_max_m_s: Positive = 0.8  # S1 asks for 1.0 at contact
    near_speed_hold_s: NotNegative = 0.06
    alive_lost_fix_age_max_s: NotNegative = 0.5  # in place of `fix_age_max_s` once the vehicle's token is lost
    height_m: Positive = 5.0  # above the pad, or above where the abort began without a vehicle
    # For so long vehicle and autopilot are heard without a break before the next approach: a retry is soon lost to an
    # outage that goes on, or to another one.
    heard_hold_s: NotNegative = 1.0
    time_limit_s: Positive = 10.0
    retries_max: Annotated[int, Field(ge=0, le=20)] = 3


class ForecastConfig(StrictModel):
    """The forecast of the contact that a descent leads to; it is told, and decides nothing."""

    period_s: Annotated[float, Field(ge=0.02, le=0.1)] = 0.1  # between two of them; a descent sinks 0.05 m meanwhile
