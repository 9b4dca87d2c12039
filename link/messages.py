"""What travels between the programs over Zenoh, as plain data in SI units, radians, ENU and FLU.

Frames: W is the world (ENU about the datum), B the drone's body and V the vehicle's body (both FLU).
Quaternions are Hamilton, order wxyz. `t_ns` is the UTC instant of measurement in nanoseconds.
The wire forms (ROS 2 messages in CDR, JSON) live in `link.payloads.cdr` and `link.payloads.json_messages`.
"""

from enum import Enum

from msgspec import Struct

VEHICLE_LENGTH_MAX_M = 25.25
"""No vehicle on a road is longer: European Modular System, Directive 96/53/EC, article 4. So more is a mistake."""

VEHICLE_HEIGHT_MAX_M = 8.0
"""The largest truck that is built, a Caterpillar 797F, is 7.7 m high; on roads it is 4 m (Directive 96/53/EC)."""

Vector3 = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Matrix3 = tuple[float, float, float, float, float, float, float, float, float]


class Fix(Struct, frozen=True, kw_only=True):
    """A GNSS position of the vehicle's antenna; `altitude_m` is above the WGS 84 ellipsoid.

    `covariance_enu_m2` is row-major 3x3, None when the receiver does not state one.
    """

    t_ns: int
    latitude_rad: float
    longitude_rad: float
    altitude_m: float
    covariance_enu_m2: Matrix3 | None = None


class FixVelocity(Struct, frozen=True, kw_only=True):
    """The vehicle's velocity in ENU and, where known, its yaw rate.

    Without `is_vertical_measured` the third component, and what a covariance says of it, mean nothing.
    """

    t_ns: int
    velocity_enu_m_s: Vector3
    velocity_covariance_enu_m2_s2: Matrix3 | None = None
    is_vertical_measured: bool = True
    yaw_rate_rad_s: float | None = None
    yaw_rate_variance_rad2_s2: float | None = None


class VehicleImu(Struct, frozen=True, kw_only=True):
    """The vehicle's attitude (`q_WV`), angular velocity and specific force, each None when not measured."""

    t_ns: int
    orientation_wxyz: Quaternion | None = None
    orientation_covariance_rad2: Matrix3 | None = None
    angular_velocity_flu_rad_s: Vector3 | None = None
    angular_velocity_covariance_rad2_s2: Matrix3 | None = None
    specific_force_flu_m_s2: Vector3 | None = None
    specific_force_covariance_m2_s4: Matrix3 | None = None


class PadSighting(Struct, frozen=True, kw_only=True):
    """The pad's centre in the drone's body frame B (`base_link`), as a detector saw it at `t_ns`."""

    t_ns: int
    position_flu_m: Vector3
    orientation_wxyz: Quaternion
    position_covariance_m2: Matrix3


class CameraImage(Struct, frozen=True, kw_only=True):
    """A picture of the drone's camera, taken at `t_ns` (the middle of its exposure), row by row.

    `encoding` is ROS's name of the pixels (mono8, bgr8, rgb8); a row is `row_bytes` long and begins with its pixels.
    """

    t_ns: int
    width_px: int
    height_px: int
    encoding: str
    row_bytes: int
    data: bytes


class CompressedPicture(Struct, frozen=True, kw_only=True):
    """A picture as a file of the format that `format` names (jpeg, png)."""

    t_ns: int
    format: str
    data: bytes


class BodyTruth(Struct, frozen=True, kw_only=True):
    """True pose and motion of a body in the simulation: pose in W, velocities in the body frame."""

    t_ns: int
    position_enu_m: Vector3
    orientation_wxyz: Quaternion
    velocity_flu_m_s: Vector3
    angular_velocity_flu_rad_s: Vector3


class RotorTruth(Struct, frozen=True, kw_only=True):
    """True rotor speeds of the simulated drone."""

    t_ns: int
    speed_rad_s: tuple[float, float, float, float]


class PlannedPose(Struct, frozen=True, kw_only=True):
    """One point of a planned path."""

    t_ns: int
    position_enu_m: Vector3
    yaw_rad: float


class Plan(Struct, frozen=True, kw_only=True):
    """The path that the companion intends to fly, first point first."""

    t_ns: int
    poses: tuple[PlannedPose, ...]


class PadGeometry(Struct, frozen=True, kw_only=True):
    """The landing pad on the vehicle; `height_m` is above its road, or above the water of one that `is_afloat`.

    `antenna_to_pad_m` leads from the GNSS antenna to the pad's centre in V. No part of it all is larger than a vehicle.
    """

    size_m: tuple[float, float]
    height_m: float
    antenna_to_pad_m: Vector3
    is_afloat: bool = False


class Command(Enum):
    """What an operator may ask of the companion."""

    START = "start"
    ABORT = "abort"
    HOLD = "hold"
    START_ANYWAY = "start_anyway"  # although nothing usable has come from the vehicle
    LAUNCH = "launch"  # leave the vehicle that the drone stands on
    FOLLOW = "follow"  # keep a station relative to the vehicle
    RETURN = "return"  # come home to the vehicle, and land


class StationFrame(Enum):
    """Which way a station's offset looks ahead."""

    VEHICLE = "vehicle"  # where the vehicle heads
    COURSE = "course"  # where it drives
    NORTH = "north"


class Station(Struct, frozen=True, kw_only=True):
    """A place relative to the pad's centre: ahead, left and up, as `frame` looks."""

    offset_m: Vector3
    frame: StationFrame = StationFrame.VEHICLE


class Order(Struct, frozen=True, kw_only=True):
    """A command with what belongs to it: a station to a follow, nothing to any other."""

    command: Command
    station: Station | None = None


class CommandReply(Struct, frozen=True, kw_only=True):
    """Whether a command was accepted, and if not, why."""

    accepted: bool
    reason: str

    def __str__(self) -> str:
        """Return it in words."""
        return "accepted" if self.accepted else f"refused: {self.reason}"


class ContactForecast(Struct, frozen=True, kw_only=True):
    """How a descent that goes on now ends: probabilities of the contact that it leads to.

    Attributes:
        in_s: until the contact, a mean; None where none is expected.
        s1: a contact within the limits of S1, those of S2 included.
        s2: one within the limits of S2.
        unsafe: one beyond those of S1.
        broken_off: none, since the drone waits or breaks off before.
        misses_position: unsafe, and the place is farthest beyond its limit.
        misses_speed: unsafe, and the horizontal speed against the deck is.
        misses_sink: unsafe, and the sink rate is.
        misses_tilt: unsafe, and the tilt is.
    """

    in_s: float | None
    s1: float
    s2: float
    unsafe: float
    broken_off: float
    misses_position: float
    misses_speed: float
    misses_sink: float
    misses_tilt: float


class LinkStatus(Struct, frozen=True, kw_only=True):
    """What the companion tells the world about its links.

    `refused` says what of the vehicle's data was refused most in the last 5 s, and why. `open_to_strangers` are the
    links by which somebody without a key could take part.
    """

    mavlink_bad_bytes: int = 0
    zenoh_bad_payloads: int = 0
    refused: str = ""
    open_to_strangers: tuple[str, ...] = ()


class LandingStatus(Struct, frozen=True, kw_only=True):
    """What the companion tells the world about the landing; None where it does not know.

    `relative_position_enu_m` is of the drone's feet from the pad's centre: east and north are those of the drone, up is
    `height_above_pad_m`. `reason_code` names the reason without its numbers, for programs. `flown_by` is "companion"
    while the autopilot follows its setpoints, "failsafe" while one flies, else "other"; empty without an autopilot.
    `battery_share` is left, 0 to 1. `unverified` is what is believed of the pad's place since nothing that the drone
    has can verify it. `station_offset_m` is the station that is kept, ahead, left and up of the pad's centre in its
    frame: farther out or higher than ordered where the vehicle's place is vague. On the wire the fields of `links`
    stand beside the others.
    """

    stamp_ns: int
    phase: str
    reason: str
    reason_code: str = ""
    relative_position_enu_m: Vector3 | None
    relative_velocity_enu_m_s: Vector3 | None
    height_above_pad_m: float | None
    time_to_contact_s: float | None
    armed: bool
    fix_age_s: float | None
    flown_by: str = ""
    battery_share: float | None = None
    contact_forecast: ContactForecast | None = None
    unverified: tuple[str, ...] = ()
    station_offset_m: Vector3 | None = None
    links: LinkStatus = LinkStatus()
