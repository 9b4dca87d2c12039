"""Which ROS 2 topics hold what the programs say and hear, as TOML; the defaults are the names of our own keys.

distribution = "humble"  # without it, Jazzy or later
[vehicle]
odometry = "/localization/kinematic_state"   # in place of fix, velocity and imu
odometry_origin = [47.4, 8.5, 400.0]
[pad]
size_m = [1.5, 1.5]
height_m = 1.5
frame = "landing_pad"
"""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from link.payloads.json_messages import Height, Lever, Rise, Size
from link.program.toml_config import StrictModel

VelocityType = Literal["geometry_msgs/msg/TwistWithCovarianceStamped", "geometry_msgs/msg/TwistStamped"]
Name = Annotated[str, Field(pattern=r"^(/[A-Za-z_][A-Za-z0-9_]*)+$")]
Latitude = Annotated[float, Field(ge=-90.0, le=90.0)]
Longitude = Annotated[float, Field(ge=-180.0, le=180.0)]
Geoid = Annotated[float, Field(ge=-120.0, le=120.0)]
Metres = Annotated[float, Field(ge=-1000.0, le=10000.0)]


class VehicleTopics(StrictModel):
    """Where the vehicle tells its motion."""

    fix: Name | None = None  # sensor_msgs/msg/NavSatFix; /{vehicle}/fix
    velocity: Name | None = None  # in ENU; /{vehicle}/fix_velocity
    velocity_type: VelocityType = "geometry_msgs/msg/TwistWithCovarianceStamped"
    imu: Name | None = None  # sensor_msgs/msg/Imu; /{vehicle}/imu
    gps: Name | None = None  # gps_msgs/msg/GPSFix, in place of fix and velocity
    gps_geoid_height_m: Geoid = 0.0  # added to its altitude: of the sea above the ellipsoid where it is above the sea
    odometry: Name | None = None  # nav_msgs/msg/Odometry, in place of the three
    odometry_frame: str = "map"  # its header's, with axes east, north and up
    odometry_origin: tuple[Latitude, Longitude, Metres] | None = None  # of that frame: degrees, m above the ellipsoid

    @model_validator(mode="after")
    def _check_odometry(self) -> "VehicleTopics":
        if (self.odometry is None) != (self.odometry_origin is None):
            raise ValueError("odometry and odometry_origin belong together")
        if self.odometry is not None and any((self.fix, self.velocity, self.imu, self.gps)):
            raise ValueError("odometry takes the place of fix, velocity, imu and gps: leave them out")
        if self.gps is not None and any((self.fix, self.velocity)):
            raise ValueError("gps takes the place of fix and velocity: leave them out")
        return self


class PadTopics(StrictModel):
    """The pad, where the vehicle does not describe it itself as `ground-vehicle` does."""

    size_m: tuple[Size, Size]
    height_m: Height  # above the road
    antenna_to_pad_m: tuple[Lever, Lever, Rise] | None = None  # forward, left, up; None: from the transforms
    tf_static: Name = "/tf_static"
    vehicle_frame: str = "base_link"
    antenna_frame: str = "base_link"  # where a fix, or the odometry, is
    frame: str = "landing_pad"


class TopicMap(StrictModel):
    """All that can be said about topics."""

    distribution: Literal["jazzy", "humble"] = "jazzy"  # or later; Humble has no hashes of types
    vehicle: VehicleTopics = VehicleTopics()
    pad: PadTopics | None = None
