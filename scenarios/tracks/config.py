"""The tracks' part of a scenario: which road, how fast, and the numbers that shape it.

Where no source is named, the number is a choice of this benchmark for an ordinary car.
"""

from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from link.program.toml_config import NotNegative, Positive, StrictModel

Waypoint = tuple[float, float]
_SPEED_ROUNDING_M_S = 1e-9


class Departure(StrictModel):
    """When the vehicle starts: `departs_s` after the drone has hovered at the waiting point, or after the start."""

    wait_for_drone: bool = True
    hover_radius_m: Positive = 2.5  # of a drone whose own place may be off by three times 0.5 m and more
    hover_s: NotNegative = 1.0
    departs_s: NotNegative = 1.0


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
    speed_m_s: Annotated[float, Field(gt=0.0, le=60.0)]
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
    brake_height_range_m: tuple[Positive, Positive] = (0.4, 1.6)


class RandomTrack(MovingTrack):
    """Acceleration that wanders along and across: an Ornstein-Uhlenbeck process on each, from the waiting point on."""

    kind: Literal["random"]
    sigma_m_s2: Positive = 0.8
    tau_s: Positive = 3.0


class RoughRoadTrack(MovingTrack):
    """A straight road that climbs behind the waiting point and shakes the vehicle."""

    kind: Literal["rough_road"]
    grade: Annotated[float, Field(ge=0.0, le=0.3)] = 0.05
    heave_m: NotNegative = 0.1
    heave_hz: Positive = 0.5
    roll_rad: Annotated[float, Field(ge=0.0, le=0.5)] = 0.0524  # 3 degrees
    roll_hz: Positive = 1.0
    pitch_rad: Annotated[float, Field(ge=0.0, le=0.5)] = 0.0524  # 3 degrees
    pitch_hz: Positive = 0.7


class SuspensionConfig(StrictModel):
    """How a body moves on its wheels: heave, pitch and roll, each a damped oscillator.

    Driven by the road under four wheels, and by braking and turning: so far the body dives and leans in the long run.
    """

    heave_hz: Positive = 1.3  # natural frequencies, undamped; a car's, Gillespie 1992, chapter 5
    pitch_hz: Positive = 1.5
    roll_hz: Positive = 1.5
    damping: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.3  # share of the critical
    dive_rad_s2_m: Annotated[float, Field(ge=0.0, le=0.03)] = 0.0025  # for each m/s^2 of braking
    lean_rad_s2_m: Annotated[float, Field(ge=0.0, le=0.03)] = 0.008  # for each m/s^2 to the inside of the turn
    wheelbase_m: Positive = 2.6
    track_m: Positive = 1.5


class HullConfig(StrictModel):
    """A ship's hull; that of DTMB 5415, a destroyer whose model many towing tanks have measured (ITTC, SIMMAN 2008)."""

    length_m: Positive = 142.0
    breadth_m: Positive = 19.06
    draught_m: Positive = 6.15
    block_coefficient: Annotated[float, Field(gt=0.0, le=1.0)] = 0.507
    metacentric_height_m: Positive = 1.95
    # Of radii of gyration of 0.37 of the breadth, and a quarter of added inertia: 2 pi k / sqrt(g GM).
    roll_period_s: Positive = 11.3
    roll_damping: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.1  # share of the critical, with bilge keels


class VesselTrack(StrictModel):
    """A ship that goes straight on through waves from about ahead, as for flying; its deck is the vehicle."""

    kind: Literal["vessel"]
    departure: Departure = Departure()
    significant_height_m: Positive
    modal_period_s: Positive
    speed_range_m_s: tuple[Positive, Positive] = (1.0, 8.0)  # drawn for each seed
    off_bow_max_rad: Annotated[float, Field(ge=0.0, le=1.5708)] = 0.7854  # where waves come from, drawn; 45 degrees
    deck_forward_m: float = -57.0  # of amidships; the flight deck of DTMB 5415's class is right aft
    acceleration_m_s2: Positive = 0.5
    run_s: Positive = 240.0  # behind the waiting point
    hull: HullConfig = HullConfig()


class DriveTrack(StrictModel):
    """A road and a drive along it in numbers; places are arc lengths from the road's beginning.

    Lists of lists, so that a file can be read and cut down by hand.
    """

    kind: Literal["drive"]
    departure: Departure = Departure()
    begins_m: Waypoint  # of the road, in W
    heading_rad: float = 0.0  # there
    # Of each stretch its length (m), and its curvature (1/m, positive to the left) at its beginning and at its end.
    stretches: Annotated[tuple[tuple[Positive, float, float], ...], Field(min_length=1)]
    # Lane changes and swerves: place (m), length (m), and how far to the left (m).
    shifts: tuple[tuple[NotNegative, Positive, float], ...] = ()
    grades: tuple[tuple[NotNegative, float], ...] = ()  # place (m) and grade; between two places it changes evenly
    humps: tuple[tuple[NotNegative, Positive, NotNegative], ...] = ()  # place of the middle (m), length (m), height (m)
    # Roughness as plane waves: amplitude (m), wavelength along the road (m), its ratio to that across, phase (rad).
    waves: tuple[tuple[NotNegative, Positive, float, float], ...] = ()
    # The drive from standstill: duration (s) and acceleration (m/s^2) of each leg; then the speed stays.
    legs: tuple[tuple[NotNegative, float], ...]
    suspension: SuspensionConfig = SuspensionConfig()

    @model_validator(mode="after")
    def _road_is_smooth(self) -> Self:
        for place, ((_, _, end_per_m), (_, begin_per_m, _)) in enumerate(pairwise(self.stretches)):
            if end_per_m != begin_per_m:
                raise ValueError(f"the curvature jumps between stretches[{place}] and [{place + 1}]")
        for place, ((before_m, _), (after_m, _)) in enumerate(pairwise(self.grades)):
            if after_m <= before_m:
                raise ValueError(f"grades[{place + 1}] must be behind grades[{place}]")
        return self

    @model_validator(mode="after")
    def _drives_forwards(self) -> Self:
        speed_m_s = 0.0
        for place, (duration_s, acceleration_m_s2) in enumerate(self.legs):
            speed_m_s += duration_s * acceleration_m_s2
            if speed_m_s < -_SPEED_ROUNDING_M_S:
                raise ValueError(f"legs[{place}] ends in reverse, at {speed_m_s:.3g} m/s")
        return self


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
