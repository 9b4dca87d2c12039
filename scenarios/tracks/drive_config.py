"""What goes along a track in numbers: when it starts, a road, a drive and a body on wheels, and a ship in the sea."""

from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from link.program.toml_config import Ascending, Coordinate, NotNegative, Positive, StrictModel

Waypoint = tuple[Coordinate, Coordinate]
"""East and north in W, m."""
SHIFT_CURVATURE = 8.0
"""Of a shift by d over a length L the greatest curvature is this times d / L^2 (`drive`)."""
_CURVATURE_MAX_PER_M = 10.0  # beyond it a vehicle turns on the spot
Curvature = Annotated[float, Field(ge=-_CURVATURE_MAX_PER_M, le=_CURVATURE_MAX_PER_M)]
"""1/m, positive to the left."""
_SPEED_MAX_M_S = 60.0  # 216 km/h
Speed = Annotated[float, Field(gt=0.0, le=_SPEED_MAX_M_S)]
Grade = Annotated[float, Field(ge=-0.35, le=0.35)]
"""No street is steeper than Baldwin Street in Dunedin, 0.348."""


class Departure(StrictModel):
    """When the vehicle starts: `departs_s` after the drone has hovered at the waiting point, or after the start."""

    wait_for_drone: bool = True
    hover_radius_m: Positive = 2.5  # of a drone whose own place may be off by three times 0.5 m and more
    hover_s: NotNegative = 1.0
    departs_s: NotNegative = 1.0
    backwards: bool = False  # with its rear ahead, all along the track


_SPEED_ROUNDING_M_S = 1e-9


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


class LateBrake(StrictModel):
    """The vehicle brakes to a stop once the drone is so low over its roof."""

    deceleration_m_s2: Positive  # from once the drone is so low on, to a stop
    height_above_roof_m: Positive  # of the drone, which is over the vehicle


class DriveTrack(StrictModel):
    """A road and a drive along it in numbers; places are arc lengths from the road's beginning.

    Lists of lists, so that a file can be read and cut down by hand.
    """

    kind: Literal["drive"]
    departure: Departure = Departure()
    begins_m: Waypoint  # of the road, in W
    heading_rad: float = 0.0  # there
    # Of each stretch its length (m), and its curvature (1/m, positive to the left) at its beginning and at its end.
    stretches: Annotated[tuple[tuple[Positive, Curvature, Curvature], ...], Field(min_length=1)]
    # Lane changes and swerves: place (m), length (m), and how far to the left (m).
    shifts: tuple[tuple[NotNegative, Positive, Coordinate], ...] = ()
    grades: tuple[tuple[NotNegative, Grade], ...] = ()  # place (m) and grade; between two places it changes evenly
    humps: tuple[tuple[NotNegative, Positive, NotNegative], ...] = ()  # place of the middle (m), length (m), height (m)
    # Roughness as plane waves: amplitude (m), wavelength along the road (m), its ratio to that across, phase (rad).
    waves: tuple[tuple[NotNegative, Positive, float, float], ...] = ()
    # The drive from standstill: duration (s) and acceleration (m/s^2) of each leg; then the speed stays.
    legs: tuple[tuple[NotNegative, float], ...]
    brake: LateBrake | None = None  # that the drone's height begins, whatever the legs say
    suspension: SuspensionConfig = SuspensionConfig()

    @model_validator(mode="after")
    def _road_is_smooth(self) -> Self:
        for place, ((_, _, end_per_m), (_, begin_per_m, _)) in enumerate(pairwise(self.stretches)):
            if end_per_m != begin_per_m:
                raise ValueError(f"the curvature jumps between stretches[{place}] and [{place + 1}]")
        for place, (_, length_m, left_m) in enumerate(self.shifts):
            if SHIFT_CURVATURE * abs(left_m) > _CURVATURE_MAX_PER_M * length_m**2:
                raise ValueError(f"shifts[{place}] is too short for {left_m:g} m to the side")
        for place, ((before_m, _), (after_m, _)) in enumerate(pairwise(self.grades)):
            if after_m <= before_m:
                raise ValueError(f"grades[{place + 1}] must be behind grades[{place}]")
        return self

    @model_validator(mode="after")
    def _drives_forwards_and_no_faster_than_vehicles_do(self) -> Self:
        speed_m_s = 0.0
        for place, (duration_s, acceleration_m_s2) in enumerate(self.legs):
            speed_m_s += duration_s * acceleration_m_s2
            if speed_m_s < -_SPEED_ROUNDING_M_S:
                raise ValueError(f"legs[{place}] ends in reverse, at {speed_m_s:.3g} m/s")
            if speed_m_s > _SPEED_MAX_M_S:
                raise ValueError(f"legs[{place}] ends at {speed_m_s:.3g} m/s; {_SPEED_MAX_M_S:g} m/s are the most")
        return self


class HullConfig(StrictModel):
    """A ship's hull; that of DTMB 5415, a destroyer whose model many towing tanks have measured (ITTC, SIMMAN 2008)."""

    length_m: Annotated[float, Field(ge=1.0, le=500.0)] = 142.0  # from a dinghy's to the longest ship's
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
    speed_range_m_s: Annotated[tuple[Speed, Speed], Ascending] = (1.0, 8.0)  # drawn for each seed
    off_bow_max_rad: Annotated[float, Field(ge=0.0, le=1.5708)] = 0.7854  # where waves come from, drawn; 45 degrees
    deck_forward_m: Coordinate = -57.0  # of amidships; the flight deck of DTMB 5415's class is right aft
    acceleration_m_s2: Positive = 0.5
    run_s: Positive = 240.0  # behind the waiting point
    hull: HullConfig = HullConfig()
