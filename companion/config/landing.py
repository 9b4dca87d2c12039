"""What can be set about the take-off, the chase, and the tests that abort a landing."""

from typing import Annotated

from pydantic import Field, ValidationInfo, field_validator

from link.program.toml_config import POSITIVE_MIN, NotNegative, Positive, StrictModel

FlownHeight = Annotated[float, Field(gt=0.0, le=120.0)]
"""Above the ground, or above the pad, m. Without a permit of its own no drone flies higher: regulation (EU) 2019/947,
UAS.OPEN.010 (120 m), and 14 CFR 107.51 (400 ft, 122 m)."""


class TakeoffConfig(StrictModel):
    """The climb to the waiting point and the wait."""

    waiting_height_m: FlownHeight = 5.0  # above where it took off; source report, section "Task"
    reached_distance_m: Positive = 0.5  # less than that height, or the drone is there on the ground
    refused_after_s: Positive = 30.0  # PX4 is armable 2.7 to 4.8 s after its start, ArduCopter 41.5 s
    time_limit_s: Positive = 60.0

    @field_validator("reached_distance_m")
    @classmethod
    def _is_reached_in_the_air(cls, value: float, info: ValidationInfo) -> float:
        waiting_height_m = info.data.get("waiting_height_m")
        if waiting_height_m is not None and value >= waiting_height_m:
            raise ValueError(f"it must be less than waiting_height_m, {waiting_height_m:g}, or no take-off is needed")
        return value

    @field_validator("time_limit_s")
    @classmethod
    def _outlasts_a_refusal(cls, value: float, info: ValidationInfo) -> float:
        refused_after_s = info.data.get("refused_after_s")
        if refused_after_s is not None and value <= refused_after_s:
            raise ValueError(f"it must be more than refused_after_s, {refused_after_s:g}, or no refusal is ever told")
        return value


class ChaseConfig(StrictModel):
    """When the chase begins and when it is close enough."""

    height_m: FlownHeight = 3.5  # above the pad, until the drone is over it; 5 m over a road under a roof of 1.5 m
    # And so many standard deviations of the pad's height more while it has to be seen first: with a deviation of 2 m,
    # one roof in 25 is 3.5 m or more higher than it is said to be, and the drone would fly into it.
    unseen_height_stds: NotNegative = 2.0
    unseen_height_max_m: FlownHeight = 8.0  # in all; less than the range of the detector that is to see it (12 m here)
    # Of the acceleration limit, and of the jerk's, that suffices for a chase that begins in time.
    start_fraction: Annotated[float, Field(gt=0.0, le=1.0)] = 0.7
    # So long a chase looks for a pad that has to be seen, over its said place, before it says what is missing; and for
    # that of a vehicle that tells nothing, anywhere. In this time the offset does not change, and dropouts of a
    # detector last a second.
    unseen_hold_s: Positive = 10.0
    passing_distance_m: Positive = 15.0  # a vehicle that passes farther away than this is not chased
    # One that has passed meanwhile is chased while so much more speed makes its lead up in that time.
    catch_up_speed_m_s: Positive = 10.0
    catch_up_s: Positive = 5.0
    # Slower than this is standing, or than so many standard deviations of a speed that is known less well than that:
    # over poor data a parked vehicle seems to move by 0.3 m/s now and then. What stands is not chased as it passes.
    parked_speed_m_s: Annotated[float, Field(ge=POSITIVE_MIN, le=3.0)] = 0.3
    parked_speed_stds: Annotated[float, Field(ge=0.0, le=5.0)] = 1.5
    # Faster than that for so long is driving: estimates from fixes of 0.1 m jump for 0.3 s.
    driving_hold_s: Annotated[float, Field(ge=0.0, le=5.0)] = 0.5
    parked_wait_s: NotNegative = 7.0  # a vehicle that stands may be about to depart
    time_limit_s: Positive = 60.0


class AbortConfig(StrictModel):
    """The abort tests and the climb after one."""

    fix_age_max_s: Positive = 1.0
    own_age_max_s: Positive = 0.5  # of the drone's own report; 25 of them in a row are missing then
    position_std_max_m: Positive = 1.5
    # Of the drone's distance from its setpoint, in standard deviations of what gusts do to it by the autopilot's model
    # and of the way that it makes while a setpoint is late by the link's jitter.
    tracking_stds_max: Positive = 10.0
    tracking_hold_s: NotNegative = 1.0
    cone_hold_s: NotNegative = 0.3
    near_height_m: Positive = 0.4  # below this there is no time to wait; what is higher climbs back to wait
    near_speed_max_m_s: Positive = 0.8  # S1 asks for 1.0 at contact
    near_speed_hold_s: NotNegative = 0.06  # for which it must be too fast near the pad: three reports at 50 Hz
    may_stand_below_m: NotNegative = 0.1  # its own height errs by so much: one that does not sink may have touched
    alive_lost_fix_age_max_s: NotNegative = 0.5  # in place of `fix_age_max_s` once the vehicle's token is lost
    height_m: FlownHeight = 5.0  # above the pad, or above where the abort began without a vehicle
    # For so long vehicle and autopilot are heard without a break before the next approach: a retry is soon lost to an
    # outage that goes on, or to another one.
    heard_hold_s: NotNegative = 1.0
    time_limit_s: Positive = 10.0
    retries_max: Annotated[int, Field(ge=0, le=20)] = 3
