"""Messages to and from the bytes that ROS 2 puts on the wire (CDR), with the encoding that names their type.

Written in little-endian order, read in either. What each field means in ROS is in `link.payloads.ros_sensors`,
`ros_motion` and `ros_images` beside it, imported with the first message. The definitions are those of ROS 2 Humble; on
the wire they are the same up to Jazzy.
"""

from functools import cache
from typing import TYPE_CHECKING, Any, TypeVar

from link.messages import (
    BodyTruth,
    CameraImage,
    CompressedPicture,
    Fix,
    FixVelocity,
    PadSighting,
    Plan,
    RotorTruth,
    VehicleImu,
)
from link.payloads.checks import PayloadError
from link.program.clock import ClockTick

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

    from link.payloads.ros_fields import Conversion

Message = (
    Fix
    | FixVelocity
    | VehicleImu
    | PadSighting
    | BodyTruth
    | RotorTruth
    | Plan
    | ClockTick
    | CameraImage
    | CompressedPicture
)
__all__ = ["ROS_TYPES", "Message", "PayloadError", "decode", "decode_ros", "encode", "encoding_of", "typestore"]

M = TypeVar("M", bound=Message)

ROS_TYPES: dict[type[object], str] = {
    Fix: "sensor_msgs/msg/NavSatFix",
    FixVelocity: "geometry_msgs/msg/TwistWithCovarianceStamped",
    VehicleImu: "sensor_msgs/msg/Imu",
    PadSighting: "geometry_msgs/msg/PoseWithCovarianceStamped",
    BodyTruth: "nav_msgs/msg/Odometry",
    RotorTruth: "sensor_msgs/msg/JointState",
    Plan: "nav_msgs/msg/Path",
    ClockTick: "rosgraph_msgs/msg/Clock",
    CameraImage: "sensor_msgs/msg/Image",
    CompressedPicture: "sensor_msgs/msg/CompressedImage",
}
"""The ROS 2 type of each message."""


def load() -> None:
    """Load what the first message of each type would load: 0.3 s that no step of a flight is to wait for."""
    _conversions()
    for ros_type in ROS_TYPES.values():
        typestore().get_msgdef(ros_type)


def encoding_of(message_type: type[Message]) -> str:
    """Return the Zenoh encoding of a message type, for instance `application/cdr;sensor_msgs/msg/NavSatFix`."""
    return f"application/cdr;{ROS_TYPES[message_type]}"


def encode(message: Message) -> bytes:
    """Return `message` as a CDR payload.

    Raises:
        PayloadError: If a value is not finite or the time is out of range: such a message must not be sent.
    """
    message_type = type(message)
    ros_message = _conversions()[message_type].to_ros(message)
    return bytes(typestore().serialize_cdr(ros_message, ROS_TYPES[message_type], little_endian=True))


def decode(message_type: type[M], payload: bytes) -> M:
    """Return the message of type `message_type` that a CDR payload holds.

    Raises:
        PayloadError: If the bytes are not such a message, or what it says cannot be.
    """
    message = _conversions()[message_type].from_ros(decode_ros(ROS_TYPES[message_type], payload))
    if not isinstance(message, message_type):
        raise TypeError(f"the conversion for {message_type.__name__} gave a {type(message).__name__}")
    return message


def decode_ros(ros_type: str, payload: bytes) -> Any:
    """Return the message of ROS 2's own type `ros_type` that a CDR payload holds, with its values unchecked.

    Raises:
        PayloadError: If the bytes are not such a message.
    """
    from rosbags.serde import SerdeError  # noqa: PLC0415 (with the type library, see above)

    try:
        return typestore().deserialize_cdr(payload, ros_type)
    except SerdeError as error:
        raise PayloadError(f"not a {ros_type}: {error}") from error


@cache
def typestore() -> "Typestore":
    """Return the library's own store of ROS 2 types."""
    from rosbags.typesys import Stores, get_typestore  # noqa: PLC0415 (0.1 s, not wanted by --help)

    return get_typestore(Stores.ROS2_HUMBLE)


@cache
def _conversions() -> "dict[type[object], Conversion]":
    from link.payloads import ros_images, ros_motion, ros_sensors  # noqa: PLC0415 (as above)

    return ros_sensors.CONVERSIONS | ros_motion.CONVERSIONS | ros_images.CONVERSIONS
