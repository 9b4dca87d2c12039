"""ROS 2 messages of our own, package `decklander_msgs`: what a recording holds and no standard message can say.

SI units, radians, world ENU. An array that may be empty is empty where the value is unknown; rows of vectors follow
one another. A recording holds these definitions, so any reader of MCAP decodes them.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from rosbags.serde import SerdeError
from rosbags.typesys import get_types_from_msg
from rosbags.typesys.store import Typestore

from link.payloads import cdr, foxglove_msgs
from link.payloads.checks import PayloadError
from link.payloads.ros_fields import WORLD_FRAME, to_header

PACKAGE = "decklander_msgs/msg"
_HEADER = "std_msgs/Header header\n"
_NAME_SHOWN = 60  # characters of what is no message's name

DEFINITIONS: dict[str, str] = {
    "NodeInput": "uint64 sequence\nuint8 kind\nint64 local_ns\nstring key\nuint8[] data\n",
    "VehicleEstimate": _HEADER
    + "float64[3] position_m\nfloat64[3] velocity_m_s\nfloat64[3] acceleration_m_s2\n"
    + "float64[81] covariance\nfloat64[] yaw_rad\nfloat64[] yaw_rate_rad_s\n",
    "Forecast": _HEADER
    + "float64[] offset_s\nfloat64[] position_m\nfloat64[] velocity_m_s\nfloat64[] acceleration_m_s2\n"
    + "float64[] position_std_m\nfloat64[] yaw_rad\n",
    "Trajectory": _HEADER
    + "float64[] offset_s\nfloat64[] position_m\nfloat64[] velocity_m_s\nfloat64[] acceleration_m_s2\n",
    "Setpoint": _HEADER
    + "float64[3] position_m\nfloat64[] velocity_m_s\nfloat64[] acceleration_m_s2\nfloat64 yaw_rad\n",
    "Step": _HEADER
    + "string phase\nstring reason\nstring text\nstring[] reply\nbool armed\nuint32 measurements\n"
    + "uint16[] commands\nfloat64[] command_parameters\n"
    + "float64[] relative_position_m\nfloat64[] relative_velocity_m_s\nfloat64[] height_above_pad_m\n"
    + "float64[] time_to_contact_s\nfloat64[] fix_age_s\n"
    + "string plan_status\nfloat64 plan_limit_excess\nuint32 plan_iterations\n"
    + "float64[] next_position_m\nfloat64[] next_velocity_m_s\nfloat64[] next_acceleration_m_s2\n",
    "ContactForecast": _HEADER
    + "float64[] in_s\nfloat64 s1\nfloat64 s2\nfloat64 unsafe\nfloat64 broken_off\n"
    + "float64 misses_position\nfloat64 misses_speed\nfloat64 misses_sink\nfloat64 misses_tilt\n",
    "StepTime": _HEADER + "float64 state_to_setpoint_s\n",
    "LinkStatistics": _HEADER
    + "uint64 bytes_received\nuint64 messages_received\nuint64 messages_sent\nuint64 bad_bytes\n"
    + "uint64 lost_messages\nuint64 commands_retried\nuint64 commands_timed_out\nuint32 round_trips\n"
    + "uint64 zenoh_bad_payloads\nuint64 records_dropped\n",
}
"""Each message's definition in ROS 2's own form."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RosMessage:
    """A message for a recording.

    Attributes:
        topic: without the leading slash, as the key on Zenoh.
        type_name: such as `decklander_msgs/msg/Step`.
        payload: in CDR.
    """

    topic: str
    type_name: str
    payload: bytes


@cache
def typestore() -> Typestore:
    """Return the standard messages, ours and those of a scene."""
    store = cdr.typestore()
    for name, text in DEFINITIONS.items():
        store.register(get_types_from_msg(text, f"{PACKAGE}/{name}"))
    for name, text in foxglove_msgs.DEFINITIONS.items():
        store.register(get_types_from_msg(text, f"{foxglove_msgs.PACKAGE}/{name}"))
    return store


def definition(type_name: str) -> str:
    """Return a message's definition with all that it refers to, as MCAP's `ros2msg` schemas have it."""
    return typestore().generate_msgdef(type_name, ros_version=2)[0]


def ros_message(topic: str, name: str, t_ns: int | None, **values: Any) -> RosMessage:
    """Return a message of ours; numbers in arrays may come as any nested sequence.

    Args:
        topic: without the leading slash.
        name: of the message, such as `Step`.
        t_ns: of its header; None for one without.
        values: its other fields, all of them.
    """
    type_name = f"{PACKAGE}/{name}"
    header = {} if t_ns is None else {"header": to_header(max(t_ns, 0), WORLD_FRAME)}
    message = typestore().types[type_name](**header, **values)
    payload = bytes(typestore().serialize_cdr(message, type_name, little_endian=True))
    return RosMessage(topic=topic, type_name=type_name, payload=payload)


def fields_of(payload: bytes, type_name: str) -> dict[str, Any]:
    """Return the fields of a message by their paths, such as `header.stamp.sec`: numbers, texts and flat arrays.

    Raises:
        PayloadError: the bytes are no such message, or there is none of that name.
    """
    if type_name not in typestore().types:
        raise PayloadError(f"{type_name[:_NAME_SHOWN]!r} is no message that is known here")
    found: dict[str, Any] = {}
    try:
        message = typestore().deserialize_cdr(payload, type_name)
    except SerdeError as error:
        raise PayloadError(f"not a {type_name}: {error}") from error
    _collect("", message, found)
    return found


def _collect(path: str, value: Any, found: dict[str, Any]) -> None:
    names = getattr(value, "__dataclass_fields__", None)
    if names is not None:
        for name in names:
            if name != "__msgtype__":
                _collect(f"{path}.{name}" if path else name, getattr(value, name), found)
    elif isinstance(value, list) and value and hasattr(value[0], "__dataclass_fields__"):
        for index, part in enumerate(value):
            _collect(f"{path}[{index}]", part, found)
    else:
        found[path] = value


def bytes_array(data: bytes) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Return bytes as a message's array."""
    return np.frombuffer(data, dtype=np.uint8)


def ids_array(ids: Sequence[int]) -> np.ndarray[Any, np.dtype[np.uint16]]:
    """Return small whole numbers as a message's array."""
    return np.array(ids, dtype=np.uint16)


def floats(values: Any) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return numbers, in whatever nesting, as a flat array; None as an empty one."""
    return np.empty(0) if values is None else np.asarray(values, dtype=np.float64).reshape(-1)
