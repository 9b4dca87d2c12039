"""What can be set about a flight away from the vehicle: launch, station and the way home."""

from typing import Annotated

from pydantic import Field

from link.program.toml_config import NotNegative, Positive, StrictModel

Latitude = Annotated[float, Field(ge=-90.0, le=90.0)]
Longitude = Annotated[float, Field(ge=-180.0, le=180.0)]


class LaunchConfig(StrictModel):
    """The start from the vehicle's roof."""

    # A deck that leans by this lets a drone that lifts off slide by 9.8 m/s^2 x 0.09 x (0.3 s)^2 / 2 = 0.04 m before it
    # has levelled out, and turns none of its feet under: feet 0.3 m apart stand within 0.03 m.
    quiet_tilt_max_rad: Annotated[float, Field(gt=0.0, le=0.35)] = 0.09
    quiet_climb_max_m_s: Positive = 0.3  # of the deck: less than half of what a landing's sink may be (S2: 0.7 m/s)
    quiet_acceleration_max_m_s2: Positive = 1.2  # of the vehicle, horizontally
    # From the pad's middle, on each axis: as a landing puts it there (docs/worlds.md), or a hand on a marked pad.
    placed_std_m: Positive = 0.1
    quiet_hold_s: NotNegative = 0.5  # half a period of a car's body on its springs, 1 Hz
    # So long the motors idle on the deck; without a quiet moment they are stopped until the next one. PX4 and ArduPilot
    # stop them after 10 s by themselves, and their heartbeats tell up to a second late that they turn.
    idle_max_s: Positive = 7.0
    time_limit_s: Positive = 60.0  # without a quiet moment the launch is called off
    # Of the feet above the pad, where the station's flight begins. A drone may seem to be 0.5 m above the deck on which
    # it stands, and be taken for risen from there.
    clear_height_m: Annotated[float, Field(ge=1.0, le=120.0)] = 3.0
    lift_off_time_limit_s: Positive = 15.0  # ArduCopter leaves the ground 3.6 s after it was told to


class SortieConfig(StrictModel):
    """Stations relative to the vehicle, and the way home to it."""

    launch: LaunchConfig = LaunchConfig()
    offset_max_m: Positive = 100.0  # of a station from the pad; visual line of sight to a drone of 0.5 m ends there
    # Of the vehicle about the pad's centre, on every side: a car of 5 m with its pad in the middle. A van or a truck
    # sets its own.
    vehicle_radius_m: Positive = 3.0
    keep_out_margin_m: Positive = 1.0  # to that: rotors reach 0.35 m, and gusts move the drone by some decimetres
    # By so many standard deviations of the pad's place this grows: over fixes of 1 m a vehicle may be that much nearer.
    # As many as `chase.unseen_height_stds`, beyond the margin. Nothing else ends how high it climbs for them.
    keep_out_stds: Annotated[float, Field(ge=0.0, le=5.0)] = 2.0
    ground_clearance_m: Positive = 2.0  # of the feet above the vehicle's road: kerbs, people, what hangs over its side
    # Where the drone waits for a vehicle that stays silent: latitude and longitude in degrees, and metres above the
    # autopilot's origin; none: where the vehicle was last forecast to pass.
    rally_point_deg_m: tuple[Latitude, Longitude, float] | None = None
    expect_s: Positive = 20.0  # so long it waits there first; twice the outages of a link between houses
    return_time_limit_s: Positive = 400.0  # then it holds; the largest range, 2 km, at 5 m/s faster than the vehicle
    warn_before_s: Positive = 60.0  # the point of no return is told so long before it is reached
