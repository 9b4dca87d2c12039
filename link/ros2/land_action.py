"""The action server of a landing: a goal starts it, its statuses are the feedback, and how it ends is the result.

One goal at a time, as there is one drone. Zenoh's threads bring requests, the program's loop replies to commands, and
the publishing thread statuses, so all that is kept is under one lock. Only `tell` publishes, after it has released the
lock: a client that takes nothing more holds up that thread, and never the loop.
"""

import threading
import time
from collections.abc import Callable

from link.messages import Command, CommandReply, LandingStatus, Order
from link.payloads import json_messages
from link.payloads.checks import PayloadError
from link.ros2.land_types import (
    cancel_response,
    endpoints,
    feedback_message,
    goal_id_of,
    result_response,
    send_response,
    status_array,
)
from link.ros2.ros_node import Answer, RosNode

Take = Callable[[bytes, Answer], None]
"""Takes an operator's command as JSON, and an answer for its reply."""

_EXECUTING, _CANCELING, _SUCCEEDED, _CANCELED, _ABORTED = 2, 3, 4, 5, 6
"""action_msgs/msg/GoalStatus."""
_ACCEPTED, _REJECTED, _UNKNOWN = 0, 1, 2
"""action_msgs/srv/CancelGoal: its return codes."""
_ENDED = frozenset({"idle", "secured", "hold", "pilot in command"})
_SECURED = "secured"
_KEPT_MAX = 16  # of goals that have ended, and of who waits for a result
_ALL = bytes(16)  # the id that means all goals
_FORGOTTEN_S = 5.0  # a start that nobody has answered for so long is none


class LandAction:
    """The server.

    Args:
        node: that it belongs to.
        name: of the action, such as `/drone/landing/land`.
        take: takes the operator's commands.
    """

    def __init__(self, node: RosNode, name: str, take: Take) -> None:
        self._take = take
        self._lock = threading.Lock()
        self._active: bytes | None = None
        self._has_begun = False
        self._asked_s = 0.0
        self._goals: dict[bytes, tuple[int, int]] = {}
        self._results: dict[bytes, bytes] = {}
        self._waiting: list[tuple[bytes, Answer]] = []
        self._has_news = False
        there = endpoints(name)
        self._feedback, self._status = node.publisher(there["feedback"]), node.latched_publisher(there["status"])
        for what, serve in (("send", self._send_goal), ("get", self._get_result), ("cancel", self._cancel_goal)):
            node.serve(there[what], serve)

    def tell(self, status: LandingStatus) -> None:
        """Take a status of the landing, and tell of the goals; waits where a client takes nothing more."""
        with self._lock:
            goal_id = self._active
            self._has_begun = self._has_begun or status.phase not in _ENDED
            goes_on = not self._has_begun or status.phase not in _ENDED
            if goal_id is not None and not goes_on:
                self._finish(goal_id, status)
            goals, has_news = self._goals, self._has_news
            self._has_news = False
        if has_news:
            self._status.publish(status_array(goals))
        if goal_id is not None and goes_on:
            self._feedback.publish(feedback_message(goal_id, status))

    def _send_goal(self, request: bytes, answer: Answer) -> None:
        try:
            goal_id = goal_id_of(request)
        except PayloadError:
            return
        with self._lock:
            unanswered = self._active not in self._goals and time.monotonic() - self._asked_s > _FORGOTTEN_S
            if goal_id in self._goals or (self._active is not None and not unanswered):
                answer(send_response(accepted=False, t_ns=time.time_ns()))
                return
            self._active, self._has_begun, self._asked_s = goal_id, False, time.monotonic()

        def started(reply: bytes) -> None:
            accepted = json_messages.decode(CommandReply, reply).accepted
            t_ns = time.time_ns()
            with self._lock:
                if accepted:
                    self._set_status(goal_id, _EXECUTING, t_ns)
                elif self._active == goal_id:
                    self._active = None
            answer(send_response(accepted=accepted, t_ns=t_ns))

        self._take(json_messages.encode(Order(command=Command.START)), started)

    def _get_result(self, request: bytes, answer: Answer) -> None:
        try:
            goal_id = goal_id_of(request)
        except PayloadError:
            return
        with self._lock:
            known = self._results.get(goal_id)
            if known is None and goal_id == self._active and len(self._waiting) < _KEPT_MAX:
                self._waiting.append((goal_id, answer))
                return
        answer(known or result_response(0, success=False, reason="no such goal"))

    def _cancel_goal(self, request: bytes, answer: Answer) -> None:
        try:
            goal_id = goal_id_of(request)
        except PayloadError:
            return
        with self._lock:
            active = self._active
        if active is None or goal_id not in {active, _ALL}:
            answer(cancel_response(_UNKNOWN, None))
            return

        def aborted(reply: bytes) -> None:
            accepted = json_messages.decode(CommandReply, reply).accepted
            with self._lock:
                if accepted and active in self._goals and self._active == active:
                    self._set_status(active, _CANCELING, self._goals[active][1])
            answer(cancel_response(_ACCEPTED if accepted else _REJECTED, active if accepted else None))

        self._take(json_messages.encode(Order(command=Command.ABORT)), aborted)

    def _finish(self, goal_id: bytes, status: LandingStatus) -> None:
        """Keep how a goal has ended, and tell who waits for that; the lock is held."""
        before, t_ns = self._goals.get(goal_id, (_EXECUTING, time.time_ns()))
        success = status.phase == _SECURED
        ended = _SUCCEEDED if success else _CANCELED if before == _CANCELING else _ABORTED
        result = result_response(ended, success=success, reason=status.reason)
        self._results = dict([*self._results.items(), (goal_id, result)][-_KEPT_MAX:])
        self._active = None
        self._set_status(goal_id, ended, t_ns)
        for waiting_for, answer in self._waiting:
            if waiting_for == goal_id:
                answer(result)
        self._waiting = [one for one in self._waiting if one[0] != goal_id]

    def _set_status(self, goal_id: bytes, status: int, t_ns: int) -> None:
        """Keep a goal's status to be told; the lock is held."""
        self._goals = dict([*self._goals.items()][-_KEPT_MAX:]) | {goal_id: (status, t_ns)}
        self._has_news = True
