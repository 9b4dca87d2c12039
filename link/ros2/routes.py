"""Which of our keys travel on which ROS 2 topic, and how a payload changes on the way.

Most of our payloads are ROS 2 messages already and pass unchanged. What has no route keeps its own key: the clock and
the truth of a simulation, and what only our own programs ask each other.
"""

from collections.abc import Callable
from math import radians
from typing import Any

from msgspec import Struct

from link.frames.geodesy import Datum
from link.payloads import cdr, decklander_msgs
from link.payloads.checks import PayloadError
from link.ros2 import foreign, gps_fix
from link.ros2.names import Endpoint
from link.ros2.topic_map import TopicMap, VehicleTopics
from link.ros2.type_hash import service_hash, type_hash
from link.zenoh.keys import Keys

Change = Callable[[bytes], bytes]
"""From one payload to another; raises PayloadError for what it refuses."""

STRING = "std_msgs/msg/String"
TRIGGER = "std_srvs/srv/Trigger"
_TRIGGER_REPLY = "bool success\nstring message\n"
RECORDS = {"own": foreign.ODOMETRY, "estimate": "VehicleEstimate", "forecast": "Forecast", "link": "LinkStatistics"}
"""What the companion alone knows and shows, and its types (`companion.runtime.live_state`)."""


class Route(Struct, frozen=True, kw_only=True):
    """A topic in place of a key.

    Attributes:
        endpoint: name, type and hash.
        to_ros: from our payload to the topic's; None where we never publish on it.
        from_ros: from the topic's payload to ours.
    """

    endpoint: Endpoint
    to_ros: Change | None
    from_ros: Change


def topic(name: str, type_name: str) -> Endpoint:
    """Return a topic with its type's hash."""
    return Endpoint(name=name, type_name=type_name, type_hash=type_hash(type_name))


def trigger(name: str) -> Endpoint:
    """Return a service of type std_srvs/srv/Trigger."""
    return Endpoint(name=name, type_name=TRIGGER, type_hash=service_hash(TRIGGER, "", _TRIGGER_REPLY))


def routes(keys: Keys, topics: TopicMap) -> dict[str, Route]:
    """Return the route of each key that has one."""
    drone = f"/{keys.drone}"
    plain = {
        keys.pad_pose: (f"{drone}/pad_pose", "geometry_msgs/msg/PoseWithCovarianceStamped"),
        keys.landing_plan: (f"{drone}/landing/plan", "nav_msgs/msg/Path"),
    }
    for record, type_name in RECORDS.items():
        full = type_name if "/" in type_name else f"{decklander_msgs.PACKAGE}/{type_name}"
        plain[keys.record(record)] = (f"{drone}/companion/{record}", full)
    status = Route(endpoint=topic(f"{drone}/landing/status", STRING), to_ros=to_string, from_ros=from_string)
    return {key: _unchanged(*there) for key, there in plain.items()} | {
        keys.landing_status: status,
        **_vehicle_routes(keys, topics.vehicle),
    }


def _vehicle_routes(keys: Keys, topics: VehicleTopics) -> dict[str, Route]:
    if topics.odometry is not None and topics.odometry_origin is not None:
        return _odometry_routes(keys, topics.odometry, topics.odometry_frame, topics.odometry_origin)
    vehicle = f"/{keys.vehicle}"
    imu = _unchanged(topics.imu or f"{vehicle}/imu", "sensor_msgs/msg/Imu")
    if topics.gps is not None:
        return _gps_routes(keys, topics.gps, topics.gps_geoid_height_m) | {keys.imu: imu}
    velocity = topics.velocity or f"{vehicle}/fix_velocity"
    has_covariance = topics.velocity_type != foreign.TWIST
    return {
        keys.fix: _unchanged(topics.fix or f"{vehicle}/fix", "sensor_msgs/msg/NavSatFix"),
        keys.fix_velocity: _unchanged(velocity, topics.velocity_type)
        if has_covariance
        else _read_only(topic(velocity, foreign.TWIST), foreign.velocity_of_twist),
        keys.imu: imu,
    }


def _odometry_routes(keys: Keys, name: str, frame: str, origin_deg_m: tuple[float, float, float]) -> dict[str, Route]:
    latitude_deg, longitude_deg, altitude_m = origin_deg_m
    origin = Datum(latitude_rad=radians(latitude_deg), longitude_rad=radians(longitude_deg), altitude_m=altitude_m)
    endpoint = topic(name, foreign.ODOMETRY)
    return {
        keys.fix: _read_only(endpoint, lambda payload: foreign.fix_of_odometry(payload, frame, origin)),
        keys.fix_velocity: _read_only(endpoint, lambda payload: foreign.velocity_of_odometry(payload, frame)),
        keys.imu: _read_only(endpoint, lambda payload: foreign.imu_of_odometry(payload, frame)),
    }


def _gps_routes(keys: Keys, name: str, geoid_height_m: float) -> dict[str, Route]:
    gps_fix.register()
    endpoint = topic(name, gps_fix.GPS_FIX)
    return {
        keys.fix: _read_only(endpoint, lambda payload: gps_fix.fix_of_gps(payload, geoid_height_m)),
        keys.fix_velocity: _read_only(endpoint, gps_fix.velocity_of_gps),
    }


def _unchanged(name: str, type_name: str) -> Route:
    return Route(endpoint=topic(name, type_name), to_ros=_same, from_ros=_same)


def _same(payload: bytes) -> bytes:
    return payload


def _read_only(endpoint: Endpoint, read: Callable[[bytes], Any]) -> Route:
    return Route(endpoint=endpoint, to_ros=None, from_ros=lambda payload: cdr.encode(read(payload)))


def to_string(text: bytes) -> bytes:
    """Return UTF-8 text as a std_msgs/msg/String."""
    store = cdr.typestore()
    return bytes(store.serialize_cdr(store.types[STRING](text.decode()), STRING))


def from_string(payload: bytes) -> bytes:
    """Return the text of a std_msgs/msg/String as UTF-8."""
    return str(cdr.decode_ros(STRING, payload).data).encode()


def trigger_reply(*, accepted: bool, reason: str) -> bytes:
    """Return a std_srvs/srv/Trigger_Response: a bool, padding to 4, and a text behind its length, ended by 0."""
    text = reason.encode() + b"\0"
    return b"\0\1\0\0" + bytes([accepted, 0, 0, 0]) + len(text).to_bytes(4, "little") + text


def changed(change: Change, payload: bytes) -> bytes:
    """Return a changed payload; what is refused becomes an empty one, which its reader counts as bad."""
    try:
        return change(payload)
    except PayloadError:
        return b""
