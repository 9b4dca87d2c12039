"""What the companion's steps hand to each other: SI units, radians, world ENU (W), UTC nanoseconds.

W is the autopilot's local frame turned to ENU: about its GPS_GLOBAL_ORIGIN, and laid out as the autopilot does.
Arrays are float64 and are never written in place. Unknown is None.
"""

import math
from enum import Enum

import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from link.messages import Quaternion, Vector3

Array = NDArray[np.float64]

_LIGHT_M_S = 299_792_458.0
_L1_HZ = 1575.42e6
FIXED_STD_MAX_M = 0.25 * _LIGHT_M_S / _L1_HZ
"""Horizontal, that a receiver with fixed phases states at most: 0.048 m."""

STEP_MAX_S = 0.1
"""A longer pause between two steps counts for so much: nothing that moves with the steps jumps."""


class Quantity(Enum):
    """What a measurement measures, each with the frame of its value."""

    __hash__ = object.__hash__  # by identity, as members compare: a name is hashed again at every look-up

    # How W has moved: by how much what is seen from the drone is elsewhere in it, and what stands on the ground, m (6).
    FRAME_STEP = "frame_step"
    POSITION = "position"  # of the antenna in W, m (3)
    VELOCITY = "velocity"  # of the antenna in W, m/s (3)
    HEADING = "heading"  # yaw of V about W's z, rad (1)
    YAW_RATE = "yaw_rate"  # rad/s (1)
    PAD = "pad"  # the pad's centre in W as seen from the drone, m (3)
    ACCELERATION = "acceleration"  # along V, horizontal but for gravity by what is not known of the pitch, m/s^2 (1)
    TILT = "tilt"  # roll and pitch of V, rad, and their rates, rad/s (4)
    # The place in the fixes' frame that a range finder sees below the drone, and how far it rises above the lowest that
    # was seen lately, m (4).
    SURFACE = "surface"


class Measurement(Struct, frozen=True, kw_only=True, eq=False):
    """A value `(n,)` with covariance `(n, n)`, taken at `t_ns`."""

    t_ns: int
    quantity: Quantity
    value: Array
    covariance: Array


class Mixture(Struct, frozen=True, kw_only=True, eq=False):
    """What k models of one filter hold, of position, velocity and acceleration in W, in that order.

    Attributes:
        weight: (k,) probabilities, which sum to 1.
        off: (k, 9) their means, off the mean of all.
        covariance: (k, 9, 9).
    """

    weight: Array
    off: Array
    covariance: Array


class VehicleEstimate(Struct, frozen=True, kw_only=True, eq=False):
    """The vehicle's reference point (its antenna) at `t_ns`.

    Attributes:
        position_enu_m: (3,) in W.
        velocity_enu_m_s: (3,) in W.
        acceleration_enu_m_s2: (3,) in W.
        covariance: (9, 9) of position, velocity, acceleration, in that order.
        yaw_rad: heading of V about W's z, None while it cannot be told (at rest, never measured).
        yaw_rate_rad_s: of V about W's z, None while it cannot be told.
        mixture: what each of several models holds of the pad's centre; None of a single one.
    """

    t_ns: int
    position_enu_m: Array
    velocity_enu_m_s: Array
    acceleration_enu_m_s2: Array
    covariance: Array
    yaw_rad: float | None
    yaw_rate_rad_s: float | None
    mixture: Mixture | None = None


class Forecast(Struct, frozen=True, kw_only=True, eq=False):
    """The vehicle's reference point at `t_ns` and at later instants.

    Attributes:
        offset_s: (n,) seconds after `t_ns`.
        position_enu_m: (n, 3).
        velocity_enu_m_s: (n, 3).
        acceleration_enu_m_s2: (n, 3).
        yaw_rad: (n,), None while the heading is unknown.
        position_std_m: (n, 3) standard deviation; the pad's, where the estimator knows its lever arm.
        is_coarse: the vehicle's fixes alone are too coarse to land by, or it sends none.
        yaw_std_rad: standard deviation of the heading now, 0 where there is none.
        grade: (n,) of the road in the direction of the heading, m of height per m; None where it is not estimated.
        tilt_rad: (n, 4) roll, its rate (rad/s), pitch and its rate of V against the road; None where it is not told.
        tilt_std_rad: (n, 4) standard deviations of the same.
        frame_offset_enu_m: (2,) of the drone's frame from the vehicle's fixes', None where it is not estimated.
        frame_offset_std_m: standard deviation of either of these, which sightings of the pad make small.
        is_height_told: lately a sighting or a range told how high it is for the drone, whose own height may be wrong.
        swing: (3, 2) angular frequency, rad/s, and damping of heave, roll and pitch; None as `tilt_rad`.
        climb_std_m_s: (n,) standard deviation of the pad's velocity upwards; None where it is not estimated.
        turns_on_spot: the heading is left out for it turns too fast on the spot for a forecast.
    """

    t_ns: int
    offset_s: Array
    position_enu_m: Array
    velocity_enu_m_s: Array
    acceleration_enu_m_s2: Array
    yaw_rad: Array | None
    position_std_m: Array
    is_coarse: bool = False
    yaw_std_rad: float = 0.0
    grade: Array | None = None
    tilt_rad: Array | None = None
    tilt_std_rad: Array | None = None
    frame_offset_enu_m: Array | None = None
    frame_offset_std_m: float = math.inf
    is_height_told: bool = False
    swing: Array | None = None
    climb_std_m_s: Array | None = None
    turns_on_spot: bool = False


class OwnState(Struct, frozen=True, kw_only=True):
    """The drone as its autopilot reports it; `t_ns` is when it was so.

    `acceleration_up_m_s2`, and `jolt_m_s2` as the size of the horizontal acceleration, are from the last reports'
    velocities, None before there are enough. The autopilot reported `velocity_bias_enu_m_s` more than the velocity.
    The orientation was so `attitude_age_s` earlier.
    """

    t_ns: int
    position_enu_m: Vector3
    velocity_enu_m_s: Vector3
    orientation_wxyz: Quaternion
    angular_velocity_flu_rad_s: Vector3
    acceleration_up_m_s2: float | None = None
    jolt_m_s2: float | None = None
    velocity_bias_enu_m_s: Vector3 = (0.0, 0.0, 0.0)
    attitude_age_s: float = 0.0


class RangeReading(Struct, frozen=True, kw_only=True):
    """What a range finder that looks down along the drone's body measured at `t_ns`.

    `own` is the drone then, None when that was not known or its local frame W has moved since.
    """

    t_ns: int
    distance_m: float
    own: OwnState | None = None


class Setpoint(Struct, frozen=True, kw_only=True):
    """What the autopilot is to follow from `t_ns` on; None leaves a group out."""

    t_ns: int
    position_enu_m: Vector3
    velocity_enu_m_s: Vector3 | None
    acceleration_enu_m_s2: Vector3 | None
    yaw_rad: float


class FlightLimits(Struct, frozen=True, kw_only=True):
    """What the planner may ask of the drone; each a magnitude.

    `tilt_acceleration_m_s2` is the horizontal thrust by mass of the largest tilt. What holds against the air is taken
    from it; what is left bounds the acceleration, too.
    """

    speed_max_m_s: float
    climb_max_m_s: float
    descent_max_m_s: float
    acceleration_max_m_s2: float
    vertical_acceleration_max_m_s2: float
    jerk_max_m_s3: float
    vertical_jerk_max_m_s3: float
    tilt_acceleration_m_s2: float = math.inf


GRAVITY_M_S2 = 9.81
"""At mid latitudes; 9.780 at the equator to 9.832 at the poles (WGS 84)."""


class Rival(Struct, frozen=True, kw_only=True):
    """Another companion that was there first: for this drone, or to land its own on this vehicle."""

    drone: str
    is_this_drone: bool
