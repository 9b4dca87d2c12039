"""Pictures as ROS 2 messages.

frame_id: `camera`, in ROS's optical convention (z along the axis, x to the right of the picture, y downwards).
"""

import numpy as np
from rosbags.typesys.stores import ros2_humble as ros

from link.messages import CameraImage, CompressedPicture
from link.payloads.checks import PayloadError
from link.payloads.ros_fields import Conversion, stamp_ns, to_header

_CAMERA_FRAME = "camera"
_SIDE_MAX_PX = 20_000  # no camera has more, and products of sides stay far from overflowing


def _image_to_ros(image: CameraImage) -> ros.sensor_msgs__msg__Image:
    data = np.frombuffer(image.data, np.uint8)
    header = to_header(image.t_ns, _CAMERA_FRAME)
    return ros.sensor_msgs__msg__Image(
        header, image.height_px, image.width_px, image.encoding, 0, image.row_bytes, data
    )


def _image_from_ros(message: ros.sensor_msgs__msg__Image) -> CameraImage:
    if not (0 < message.width <= _SIDE_MAX_PX and 0 < message.height <= _SIDE_MAX_PX):
        raise PayloadError(f"a picture of {message.width} x {message.height} pixels is none")
    if message.step < message.width or len(message.data) != message.step * message.height:
        raise PayloadError(f"{len(message.data)} bytes are not {message.height} rows of {message.step}")
    return CameraImage(
        t_ns=stamp_ns(message.header),
        width_px=message.width,
        height_px=message.height,
        encoding=message.encoding,
        row_bytes=message.step,
        data=message.data.tobytes(),
    )


def _compressed_to_ros(picture: CompressedPicture) -> ros.sensor_msgs__msg__CompressedImage:
    data = np.frombuffer(picture.data, np.uint8)
    return ros.sensor_msgs__msg__CompressedImage(to_header(picture.t_ns, _CAMERA_FRAME), picture.format, data)


def _compressed_from_ros(message: ros.sensor_msgs__msg__CompressedImage) -> CompressedPicture:
    return CompressedPicture(t_ns=stamp_ns(message.header), format=message.format, data=message.data.tobytes())


CONVERSIONS: dict[type[object], Conversion] = {
    CameraImage: Conversion(to_ros=_image_to_ros, from_ros=_image_from_ros),
    CompressedPicture: Conversion(to_ros=_compressed_to_ros, from_ros=_compressed_from_ros),
}
"""The two directions of each message, by its type in `link.messages`."""
