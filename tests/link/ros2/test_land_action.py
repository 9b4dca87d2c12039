"""The action of a landing over a real router, by a client that writes out its own bytes; its hashes and its rules."""

import struct
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import zenoh
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from link.messages import Command, CommandReply, LandingStatus, Order
from link.payloads import json_messages
from link.records import replace
from link.ros2.land_action import LandAction
from link.ros2.land_types import FEEDBACK, GOAL, RESULT, endpoints
from link.ros2.names import data_key
from link.ros2.options import Ros2Options
from link.ros2.session import Ros2Session, open_ros2_session
from link.ros2.type_hash import service_hash
from link.zenoh.keys import Keys
from link.zenoh.library_config import is_matched
from link.zenoh.session import ZenohOptions, open_session
from scenarios.processes.programs import free_tcp_endpoint
from tests.link.zenoh.waiting import until

DOMAIN = 3
KEYS = Keys()
THERE = endpoints("/drone/landing/land")
HEAD, GOAL_ID, OTHER = b"\0\1\0\0", bytes(range(1, 17)), bytes(range(2, 18))
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
STATUS = LandingStatus(
    stamp_ns=1,
    phase="descend",
    reason="aligned",
    relative_position_enu_m=None,
    relative_velocity_enu_m_s=None,
    height_above_pad_m=1.25,
    time_to_contact_s=None,
    armed=True,
    fix_age_s=0.1,
)


# Constants that public projects hold to talk to real ROS 2 graphs.
def test_hashes_of_an_actions_parts_are_the_published_ones() -> None:
    name, goal_id = "example_interfaces/action/Fibonacci", "unique_identifier_msgs/UUID goal_id\n"
    accepted = "bool accepted\nbuiltin_interfaces/Time stamp\n"
    send = service_hash(
        f"{name}_SendGoal", f"{goal_id}{name}_Goal goal\n", accepted, ((f"{name}_Goal", "int32 order\n"),)
    )
    assert send == "RIHS01_d1a57fb2a4afe8c21e34fb10db206f16ce6729b28531141472df92277c55b557"
    result = ((f"{name}_Result", "int32[] sequence\n"),)
    get = service_hash(f"{name}_GetResult", goal_id, f"int8 status\n{name}_Result result\n", result)
    assert get == "RIHS01_1b0de0d5d29dc955d92f546706568428632771db13ec84c15ec1c1a59f424a57"
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg("int32[] sequence\n", f"{name}_Feedback"))
    store.register(get_types_from_msg(f"{goal_id}{name}_Feedback feedback\n", f"{name}_FeedbackMessage"))
    feedback = store.hash_rihs01(f"{name}_FeedbackMessage")
    assert feedback == "RIHS01_c1de71afd52e49a89c53d8262366884185bc0a02f78ce051c4e46b0a7fe59bb2"
    published = {
        "cancel": "573d8b0a534451d7bc2ac8c5ffde8ac14b8593b7001175d0cd6516dcbeb8689a",
        "status": "6c1684b00f177d37438febe6e709fc4e2b0d4248dca4854946f9ed8b30cda83e",
    }
    assert {part: THERE[part].type_hash for part in published} == {
        part: f"RIHS01_{value}" for part, value in published.items()
    }


class Client:
    """A ROS client without ROS, and the companion's side of the landing."""

    def __init__(self, session: zenoh.Session, ours: Ros2Session) -> None:
        self.ours = ours
        self.commands: list[Command] = []
        self.refuses = False
        self.feedback: list[bytes] = []
        self.statuses: list[bytes] = []
        self.results: list[bytes] = []
        self._session = session
        self._held = (
            session.declare_subscriber(self._key("feedback"), lambda one: self.feedback.append(one.payload.to_bytes())),
            session.declare_subscriber(self._key("status"), lambda one: self.statuses.append(one.payload.to_bytes())),
        )
        ours.serve_later(KEYS.landing_command, self._take)
        self._wait_for_server()

    def call(self, part: str, request: bytes) -> bytes:
        replies = self._session.get(self._key(part), payload=HEAD + request, timeout=20.0)
        (answer,) = [reply.ok.payload.to_bytes() for reply in replies if reply.ok is not None]
        return answer

    def send(self, goal_id: bytes = GOAL_ID) -> bool:
        return bool(self.call("send", goal_id + b"\0")[4])

    def cancel(self, goal_id: bytes) -> tuple[int, int]:
        """Return the code and how many goals are being cancelled."""
        code, count = struct.unpack_from("<b3xI", self.call("cancel", goal_id + bytes(8)), 4)
        return code, count

    def wait_for_result(self, goal_id: bytes = GOAL_ID) -> None:
        def keep(reply: zenoh.Reply) -> None:
            if reply.ok is not None:
                self.results.append(reply.ok.payload.to_bytes())

        self._session.get(self._key("get"), keep, payload=HEAD + goal_id, timeout=20.0)

    def tell(self, phase: str) -> None:
        status = json_messages.encode(replace(STATUS, phase=phase))
        self.ours.publish(KEYS.landing_status, status, "application/json")

    def result(self) -> tuple[int, bool, str]:
        """Return status, success and reason of the one result, once it has come."""
        until(self.ours, lambda: bool(self.results))
        status, success, length = struct.unpack_from("<b?2xI", self.results[0], 4)
        return status, success, self.results[0][12 : 12 + length - 1].decode()

    def _wait_for_server(self) -> None:
        """Wait, as a ROS client does, until the router has told this side of every service of the action."""
        parts = [self._session.declare_querier(self._key(part)) for part in ("send", "cancel", "get")]
        until(self.ours, lambda: all(is_matched(part) for part in parts))

    def _take(self, payload: bytes, reply: object) -> None:
        self.commands.append(json_messages.decode(Order, payload).command)
        assert callable(reply)
        reply(json_messages.encode(CommandReply(accepted=not self.refuses, reason="")))

    def _key(self, part: str) -> str:
        return data_key(DOMAIN, THERE[part])


@pytest.fixture
def client() -> Iterator[Client]:
    there = free_tcp_endpoint()
    config = zenoh.Config.from_json5(
        f'{{mode: "client", connect: {{endpoints: ["{there}"]}}, scouting: {{multicast: {{enabled: false}}}}}}'
    )
    by_router = ZenohOptions(mode="client", connect=(there,))
    with (
        open_session(ZenohOptions(mode="router", listen=(there,))),
        zenoh.open(config) as session,
        open_ros2_session(by_router, Ros2Options(domain=DOMAIN), KEYS, ("/drone", "companion")) as ours,
    ):
        yield Client(session, ours)


def test_goal_starts_a_landing_and_hears_its_feedback_and_its_result(client: Client) -> None:
    assert client.send()
    assert client.commands == [Command.START]
    assert not client.send(OTHER)
    client.wait_for_result()

    def has_feedback() -> bool:
        client.tell("descend")
        return bool(client.feedback)

    until(client.ours, has_feedback)
    # the goal, "descend", "aligned", one height, no time
    body = struct.pack("<I8s", 8, b"descend\0") + struct.pack("<I8s", 8, b"aligned\0") + struct.pack("<Id", 1, 1.25)
    assert client.feedback[0].startswith(HEAD + GOAL_ID + body[:24])
    assert struct.pack("<d", 1.25) in client.feedback[0]
    client.tell("secured")
    assert client.result() == (SUCCEEDED, True, "aligned")
    until(client.ours, lambda: bool(client.statuses) and client.statuses[-1][-1] == SUCCEEDED)


def test_cancelled_goal_aborts_the_landing(client: Client) -> None:
    assert client.cancel(GOAL_ID) == (2, 0)
    assert client.send()
    client.wait_for_result()
    assert client.cancel(OTHER) == (2, 0)
    assert client.cancel(GOAL_ID) == (0, 1)
    assert client.commands == [Command.START, Command.ABORT]
    for phase in ("abort", "hold"):
        client.tell(phase)
    assert client.result()[:2] == (CANCELED, False)


def test_landing_that_ends_otherwise_is_an_aborted_goal(client: Client) -> None:
    assert client.send()
    client.wait_for_result()
    for phase in ("takeoff", "pilot in command"):
        client.tell(phase)
    assert client.result()[:2] == (ABORTED, False)


def test_refused_start_is_a_rejected_goal_and_another_may_come(client: Client) -> None:
    client.refuses = True
    assert not client.send()
    client.refuses = False
    assert client.send(OTHER)


def test_client_that_takes_no_feedback_holds_up_no_reply_to_a_command() -> None:
    is_waiting, goes_on = threading.Event(), threading.Event()
    services: dict[str, Callable[[bytes, Callable[[bytes], None]], None]] = {}
    replies: list[Callable[[bytes], None]] = []
    answers: list[bytes] = []

    def publish(_: bytes) -> None:
        is_waiting.set()
        goes_on.wait(20.0)

    node: Any = SimpleNamespace(
        publisher=lambda _: SimpleNamespace(publish=publish),
        latched_publisher=lambda _: SimpleNamespace(publish=publish),
        serve=lambda endpoint, take: services.update({endpoint.name.rpartition("/")[2]: take}),
    )
    action = LandAction(node, "/drone/landing/land", lambda _, reply: replies.append(reply))
    services["send_goal"](HEAD + GOAL_ID + b"\0", answers.append)
    teller = threading.Thread(target=action.tell, args=(STATUS,))
    teller.start()
    assert is_waiting.wait(20.0)
    accepted = json_messages.encode(CommandReply(accepted=True, reason=""))

    def answer_both() -> None:  # as the program's loop does
        replies[0](accepted)
        services["cancel_goal"](HEAD + GOAL_ID + bytes(8), answers.append)
        replies[1](accepted)

    loop = threading.Thread(target=answer_both, daemon=True)
    loop.start()
    loop.join(5.0)
    are_answered = len(answers) == 2
    goes_on.set()
    teller.join(20.0)
    assert are_answered


def test_action_file_says_what_is_sent() -> None:
    parts = (
        Path(__file__)
        .parents[3]
        .joinpath("docs/decklander_msgs/action/Land.action")
        .read_text(encoding="utf-8")
        .split("---\n")
    )
    assert parts == [GOAL, RESULT, FEEDBACK]
