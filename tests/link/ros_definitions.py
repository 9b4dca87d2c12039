"""The ROS 2 messages of the contract, written out again from their .msg files for an independent CDR library."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from pycdr2 import IdlStruct
from pycdr2.types import array, float64, int8, int16, int32, sequence, uint8, uint16, uint32

if TYPE_CHECKING:  # the library's own container types are opaque to type checkers
    Floats = list[float]
    Floats9 = list[float]
    Floats36 = list[float]
    Strings = list[str]
    Ints = list[int]
else:
    Floats, Floats9, Floats36 = sequence[float64], array[float64, 9], array[float64, 36]
    Strings = sequence[str]
    Ints = sequence[int32]


@dataclass
class Time(IdlStruct):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct):
    stamp: Time
    frame_id: str


@dataclass
class Vector3(IdlStruct):
    x: float64
    y: float64
    z: float64


@dataclass
class Quaternion(IdlStruct):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Pose(IdlStruct):
    position: Vector3
    orientation: Quaternion


@dataclass
class PoseWithCovariance(IdlStruct):
    pose: Pose
    covariance: Floats36


@dataclass
class Twist(IdlStruct):
    linear: Vector3
    angular: Vector3


@dataclass
class TwistWithCovariance(IdlStruct):
    twist: Twist
    covariance: Floats36


@dataclass
class NavSatStatus(IdlStruct):
    status: int8
    service: uint16


@dataclass
class NavSatFix(IdlStruct):
    header: Header
    status: NavSatStatus
    latitude: float64
    longitude: float64
    altitude: float64
    position_covariance: Floats9
    position_covariance_type: uint8


@dataclass
class TwistWithCovarianceStamped(IdlStruct):
    header: Header
    twist: TwistWithCovariance


@dataclass
class Imu(IdlStruct):
    header: Header
    orientation: Quaternion
    orientation_covariance: Floats9
    angular_velocity: Vector3
    angular_velocity_covariance: Floats9
    linear_acceleration: Vector3
    linear_acceleration_covariance: Floats9


@dataclass
class PoseWithCovarianceStamped(IdlStruct):
    header: Header
    pose: PoseWithCovariance


@dataclass
class Odometry(IdlStruct):
    header: Header
    child_frame_id: str
    pose: PoseWithCovariance
    twist: TwistWithCovariance


@dataclass
class Transform(IdlStruct):
    translation: Vector3
    rotation: Quaternion


@dataclass
class TransformStamped(IdlStruct):
    header: Header
    child_frame_id: str
    transform: Transform


if TYPE_CHECKING:
    Transforms = list[TransformStamped]
else:
    Transforms = sequence[TransformStamped]


@dataclass
class TFMessage(IdlStruct):
    transforms: Transforms


@dataclass
class JointState(IdlStruct):
    header: Header
    name: Strings
    position: Floats
    velocity: Floats
    effort: Floats


@dataclass
class PoseStamped(IdlStruct):
    header: Header
    pose: Pose


if TYPE_CHECKING:
    Poses = list[PoseStamped]
else:
    Poses = sequence[PoseStamped]


@dataclass
class Path(IdlStruct):
    header: Header
    poses: Poses


@dataclass
class Clock(IdlStruct):
    clock: Time


@dataclass
class GPSStatus(IdlStruct):
    header: Header
    satellites_used: uint16
    satellite_used_prn: Ints
    satellites_visible: uint16
    satellite_visible_prn: Ints
    satellite_visible_z: Ints
    satellite_visible_azimuth: Ints
    satellite_visible_snr: Ints
    status: int16
    motion_source: uint16
    orientation_source: uint16
    position_source: uint16


@dataclass
class GPSFix(IdlStruct):
    header: Header
    status: GPSStatus
    latitude: float64
    longitude: float64
    altitude: float64
    track: float64
    speed: float64
    climb: float64
    pitch: float64
    roll: float64
    dip: float64
    time: float64
    gdop: float64
    pdop: float64
    hdop: float64
    vdop: float64
    tdop: float64
    err: float64
    err_horz: float64
    err_vert: float64
    err_track: float64
    err_speed: float64
    err_climb: float64
    err_time: float64
    err_pitch: float64
    err_roll: float64
    err_dip: float64
    position_covariance: Floats9
    position_covariance_type: uint8
