"""The tracks' part of a scenario: which road, how fast, and the numbers that shape it.

Where no source is named, the number is a choice of this benchmark for an ordinary car.
"""

from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from link.program.toml_config import Ascending, NotNegative, Positive, StrictModel
from scenarios.tracks.drive_config import Departure, DriveTrack, Speed, VesselTrack, Waypoint


class StaticTrack(StrictModel):
    """A parked vehicle, ahead of the waiting point."""

    kind: Literal["static"]
    departure: Departure = Departure()
    parked_at_m: Waypoint = (6.0, 0.0)


class WaypointsTrack(StrictModel):
    """Waypoints, with constant acceleration from each to the next (the report's)."""

    kind: Literal["waypoints"]
    departure: Departure = Departure(departs_s=5.0)  # the report's vehicle stands for 5 s
    waypoints_m: Annotated[tuple[Waypoint, ...], Field(min_length=2)]
    speeds_m_s: Annotated[tuple[NotNegative, ...], Field(min_length=2)]
    smooth: bool = False  # on a curve through the waypoints instead of straight lines
    braking_m_s2: Positive = 3.0  # behind the last waypoint

    @model_validator(mode="after")
    def _speeds_fit(self) -> Self:
        if len(self.speeds_m_s) != len(self.waypoints_m):
            raise ValueError("speeds_m_s needs as many values as waypoints_m")
        for place, (before_m_s, after_m_s) in enumerate(pairwise(self.speeds_m_s)):
            if before_m_s + after_m_s == 0.0:
                raise ValueError(
                    f"speeds_m_s[{place}] and [{place + 1}], at neighbouring waypoints, must not both be 0"
                )
        for place, (point, after) in enumerate(pairwise(self.waypoints_m)):
            if point == after:
                raise ValueError(f"waypoints_m[{place}] and [{place + 1}] must not be the same point")
        return self


class MovingTrack(StrictModel):
    """What all tracks share that pass the waiting point at speed."""

    departure: Departure = Departure()
    speed_m_s: Speed
    acceleration_m_s2: Positive = 2.0
    braking_m_s2: Positive = 3.0
    approach_min_m: Positive = 40.0  # of road before the waiting point
    approach_s: NotNegative = 3.0  # at constant speed before the waiting point, at least
    road_min_m: Positive = 400.0  # of road behind the waiting point
    road_s: Positive = 60.0  # of driving behind the waiting point, at least


class StraightTrack(MovingTrack):
    """A straight road at constant speed."""

    kind: Literal["straight"]


class FigureEightTrack(MovingTrack):
    """Two circles joined by the tangents that cross between them; the waiting point is over the crossing."""

    kind: Literal["figure_eight"]
    radius_m: Positive = 16.5  # MBZIRC 2017
    centre_m: Positive = 23.3  # of each circle from the crossing; MBZIRC 2017

    @model_validator(mode="after")
    def _circles_do_not_meet(self) -> Self:
        if self.centre_m <= self.radius_m:
            raise ValueError("centre_m must be greater than radius_m")
        return self


class CircleTrack(MovingTrack):
    """A straight run-up into a circle to the left."""

    kind: Literal["circle"]
    radius_m: Positive = 20.0


class StopAndGoTrack(MovingTrack):
    """Driving, braking, standing and driving on, along a straight road."""

    kind: Literal["stop_and_go"]
    acceleration_m_s2: Positive = 1.5
    cruise_s: NotNegative = 5.0
    stop_s: NotNegative = 3.0


class LaneChangeTrack(MovingTrack):
    """A lane change to the left, then a turn of 90 degrees to the left."""

    kind: Literal["lane_change"]
    offset_m: Positive = 3.5
    change_s: Positive = 3.0
    turn_radius_m: Positive = 8.0
    change_after_s: Positive = 1.0  # behind the waiting point: while the drone aligns and descends
    turn_after_s: Positive = 3.0  # behind the lane change


class BrakeTrack(MovingTrack):
    """A straight road, and hard braking during the end of the descent.

    The height of the drone over the roof at which it begins is drawn evenly for each seed; sinking at 0.5 m/s these
    heights are 0.5 to 3 s before contact.
    """

    kind: Literal["brake"]
    deceleration_m_s2: Positive = 6.0
    brake_height_range_m: Annotated[tuple[Positive, Positive], Ascending] = (0.4, 1.6)


class RandomTrack(MovingTrack):
    """Acceleration that wanders along and across: an Ornstein-Uhlenbeck process on each, from the waiting point on."""

    kind: Literal["random"]
    sigma_m_s2: Positive = 0.8
    tau_s: Positive = 3.0


class ShakeConfig(StrictModel):
    """How a road shakes the vehicle: waves of heave, roll and pitch."""

    heave_m: Annotated[float, Field(ge=0.0, le=0.5)] = 0.1  # no suspension travels farther
    heave_hz: Positive = 0.5
    roll_rad: Annotated[float, Field(ge=0.0, le=0.5)] = 0.0524  # 3 degrees
    roll_hz: Positive = 1.0
    pitch_rad: Annotated[float, Field(ge=0.0, le=0.5)] = 0.0524  # 3 degrees
    pitch_hz: Positive = 0.7


class RoughRoadTrack(MovingTrack):
    """A straight road that climbs behind the waiting point and shakes the vehicle."""

    kind: Literal["rough_road"]
    grade: Annotated[float, Field(ge=0.0, le=0.3)] = 0.05
    shake: ShakeConfig = ShakeConfig()


TrackConfig = Annotated[
    StaticTrack
    | WaypointsTrack
    | StraightTrack
    | FigureEightTrack
    | CircleTrack
    | StopAndGoTrack
    | LaneChangeTrack
    | BrakeTrack
    | RandomTrack
    | RoughRoadTrack
    | VesselTrack
    | DriveTrack,
    Field(discriminator="kind"),
]
