"""The hashes by which ROS 2 tells versions of a type apart: RIHS01, the SHA-256 of a type's description (REP-2016)."""

from functools import cache
from typing import Any

from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from link.payloads import decklander_msgs

NOT_SUPPORTED = "TypeHashNotSupported"
"""What rmw_zenoh writes for a hash in Humble, whose types have none."""

_CHAR = (Nodetype.BASE, ("char", 0))
_CHAR_AS_UINT8 = (Nodetype.BASE, ("uint8", 0))
_EVENT_INFO = "service_msgs/msg/ServiceEventInfo"


@cache
def type_hash(type_name: str) -> str:
    """Return the hash of a message type of ROS 2 or of `decklander_msgs`, such as `RIHS01_df668c...`."""
    return decklander_msgs.typestore().hash_rihs01(type_name)


@cache
def service_hash(type_name: str, request: str, response: str, parts_of: tuple[tuple[str, str], ...] = ()) -> str:
    """Return the hash of a service type.

    REP-2016 describes a service as a type of three fields: its request, its response and its event.

    Args:
        type_name: such as `std_srvs/srv/Trigger`.
        request: the definition of the request, in ROS's own form.
        response: the definition of the response.
        parts_of: names and definitions of types that these refer to and ROS itself does not have.
    """
    store = get_typestore(Stores.ROS2_JAZZY)  # the first release that has events of services
    for name, text in parts_of:
        store.register(get_types_from_msg(text, name))
    constants, fields = store.fielddefs[_EVENT_INFO]
    store.fielddefs[_EVENT_INFO] = (constants, [(name, _as_described(field)) for name, field in fields])
    parts = {part: f"{type_name}_{part.capitalize()}" for part in ("request", "response", "event")}
    for part, text in (("request", request), ("response", response)):
        (store.fielddefs[parts[part]],) = get_types_from_msg(text, "std_srvs/msg/Part").values()
    named: dict[str, Any] = {part: (Nodetype.NAME, name) for part, name in parts.items()}
    at_most_one: dict[str, Any] = {part: (Nodetype.SEQUENCE, (named[part], 1)) for part in ("request", "response")}
    store.fielddefs[parts["event"]] = ([], [("info", (Nodetype.NAME, _EVENT_INFO)), *at_most_one.items()])
    store.fielddefs[type_name] = ([], [(f"{part}_message", named[part]) for part in parts])
    return store.hash_rihs01(type_name)


def _as_described(field: Any) -> Any:
    """Return a field as rosidl describes it, to which `char` is uint8; rosbags 0.11 takes it for a type of its own."""
    kind, what = field
    return (kind, (_CHAR_AS_UINT8, what[1])) if what[0] == _CHAR else field
