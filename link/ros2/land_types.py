"""The action `decklander_msgs/action/Land`: its parts' definitions, hashes and bytes.

An action is three services and two topics below `<name>/_action`. `docs/decklander_msgs/Land.action` is what ROS
builds its own code from. Source: https://design.ros2.org/articles/actions.html; rosidl's types of an action's parts.
"""

import struct
from functools import cache
from typing import Any

import numpy as np
from rosbags.typesys import get_types_from_msg

from link.messages import LandingStatus
from link.payloads import cdr
from link.payloads.checks import PayloadError
from link.ros2.names import Endpoint
from link.ros2.routes import topic
from link.ros2.type_hash import service_hash, type_hash

LAND = "decklander_msgs/action/Land"
ID_BYTES = 16
_HEAD = b"\0\1\0\0"  # of CDR, little-endian
_UUID = "unique_identifier_msgs/msg/UUID"
_STATUSES = "action_msgs/msg/GoalStatusArray"
_CANCEL = "action_msgs/srv/CancelGoal"
GOAL, RESULT = "", "bool success\nstring reason\n"
FEEDBACK = "string phase\nstring reason\nfloat64[] height_above_pad_m\nfloat64[] time_to_contact_s\n"
"""What is asked and told; an array is empty where the value is not known."""


@cache
def endpoints(name: str) -> dict[str, Endpoint]:
    """Return the services and topics of an action by what they are for."""
    _register()
    below = f"{name}/_action"
    send = service_hash(
        f"{LAND}_SendGoal",
        f"unique_identifier_msgs/UUID goal_id\n{LAND}_Goal goal\n",
        "bool accepted\nbuiltin_interfaces/Time stamp\n",
        ((f"{LAND}_Goal", GOAL),),
    )
    get = service_hash(
        f"{LAND}_GetResult",
        "unique_identifier_msgs/UUID goal_id\n",
        f"int8 status\n{LAND}_Result result\n",
        ((f"{LAND}_Result", RESULT),),
    )
    info = "action_msgs/GoalInfo"
    cancel = service_hash(_CANCEL, f"{info} goal_info\n", f"int8 return_code\n{info}[] goals_canceling\n")
    feedback = f"{LAND}_FeedbackMessage"
    return {
        "send": Endpoint(name=f"{below}/send_goal", type_name=f"{LAND}_SendGoal", type_hash=send),
        "get": Endpoint(name=f"{below}/get_result", type_name=f"{LAND}_GetResult", type_hash=get),
        "cancel": Endpoint(name=f"{below}/cancel_goal", type_name=_CANCEL, type_hash=cancel),
        "feedback": Endpoint(name=f"{below}/feedback", type_name=feedback, type_hash=type_hash(feedback)),
        "status": topic(f"{below}/status", _STATUSES),
    }


@cache
def _register() -> None:
    store = cdr.typestore()
    store.register(get_types_from_msg(FEEDBACK, f"{LAND}_Feedback"))
    message = f"unique_identifier_msgs/UUID goal_id\n{LAND}_Feedback feedback\n"
    store.register(get_types_from_msg(message, f"{LAND}_FeedbackMessage"))


def goal_id_of(request: bytes) -> bytes:
    """Return the goal that a request of any of the three services begins with.

    Raises:
        PayloadError: It is too short.
    """
    goal_id = request[len(_HEAD) : len(_HEAD) + ID_BYTES]
    if len(goal_id) != ID_BYTES:
        raise PayloadError("a request without a goal's id")
    return goal_id


def send_response(*, accepted: bool, t_ns: int) -> bytes:
    """Return a Land_SendGoal_Response."""
    return _HEAD + struct.pack("<?3xiI", accepted, t_ns // 10**9, t_ns % 10**9)


def result_response(status: int, *, success: bool, reason: str) -> bytes:
    """Return a Land_GetResult_Response."""
    text = reason.encode() + b"\0"
    return _HEAD + struct.pack("<b?2xI", status, success, len(text)) + text


def cancel_response(code: int, goal_id: bytes | None) -> bytes:
    """Return a CancelGoal_Response, with the goal that is being cancelled if there is one."""
    head = _HEAD + struct.pack("<b3xI", code, goal_id is not None)
    return head if goal_id is None else head + goal_id + struct.pack("<iI", 0, 0)


def feedback_message(goal_id: bytes, status: LandingStatus) -> bytes:
    """Return a Land_FeedbackMessage."""
    store = cdr.typestore()
    return _bytes_of(
        f"{LAND}_FeedbackMessage",
        goal_id=_uuid(goal_id),
        feedback=store.types[f"{LAND}_Feedback"](
            phase=status.phase,
            reason=status.reason,
            height_above_pad_m=_optional(status.height_above_pad_m),
            time_to_contact_s=_optional(status.time_to_contact_s),
        ),
    )


def status_array(goals: dict[bytes, tuple[int, int]]) -> bytes:
    """Return a GoalStatusArray of goals by their ids, each with its status and when it was accepted (UTC, ns)."""
    types = cdr.typestore().types
    told = [
        types["action_msgs/msg/GoalStatus"](
            goal_info=types["action_msgs/msg/GoalInfo"](
                goal_id=_uuid(goal_id),
                stamp=types["builtin_interfaces/msg/Time"](sec=t_ns // 10**9, nanosec=t_ns % 10**9),
            ),
            status=status,
        )
        for goal_id, (status, t_ns) in goals.items()
    ]
    return _bytes_of(_STATUSES, status_list=told)


def _uuid(goal_id: bytes) -> Any:
    return cdr.typestore().types[_UUID](uuid=np.frombuffer(goal_id, dtype=np.uint8))


def _optional(value: float | None) -> Any:
    return np.array([] if value is None else [value], dtype=np.float64)


def _bytes_of(type_name: str, **values: Any) -> bytes:
    store = cdr.typestore()
    return bytes(store.serialize_cdr(store.types[type_name](**values), type_name, little_endian=True))
