"""A Zenoh session in the layout of rmw_zenoh: to a ROS 2 graph, the program is a node.

The programs go on speaking of their own keys (`link.zenoh.keys`); here these become topics, with a token for each
endpoint and an attachment on each sample. Attachments of samples that come are not read, so wrong and missing ones do
no harm.
"""

import time
from collections.abc import Callable

import zenoh
import zenoh.ext

from link.messages import Command, CommandReply, LandingStatus, Order, PadGeometry
from link.payloads import json_messages
from link.payloads.checks import PayloadError
from link.program.toml_config import load_config
from link.ros2 import foreign
from link.ros2.land_action import LandAction
from link.ros2.names import Endpoint, EntityKind, Qos, check_name, publishers_key
from link.ros2.options import Ros2Options
from link.ros2.ros_node import LATCHED, RosNode, RosPublisher
from link.ros2.routes import Route, changed, routes, topic, trigger, trigger_reply
from link.ros2.topic_map import PadTopics, TopicMap
from link.zenoh.inbox import Inbox
from link.zenoh.keys import Keys
from link.zenoh.library_config import open_library_session
from link.zenoh.options import ZenohOptions
from link.zenoh.session import INBOX_CAPACITY, Alive, Sample, ZenohSession, taken

_FRAMES_MAX = 1000  # of a robot; what is told beyond them is no robot's


class PadSource:
    """Tells the pad once it is known.

    Args:
        pad: of the map.
        transforms: into which static transforms come; None where the map says the place.
    """

    def __init__(self, pad: PadTopics, transforms: Inbox | None) -> None:
        self._pad = pad
        self._transforms = transforms
        self._known: foreign.Transforms = {}

    def geometry(self) -> PadGeometry | None:
        """Return the pad, None while the transforms do not say where it is."""
        pad, lever = self._pad, self._pad.antenna_to_pad_m
        if self._transforms is not None:
            for sample in self._transforms.take():
                self._learn(sample.payload)
            lever = foreign.lever(self._known, pad.vehicle_frame, pad.antenna_frame, pad.frame)
        if lever is None:
            return None
        return PadGeometry(size_m=pad.size_m, height_m=pad.height_m, antenna_to_pad_m=lever)

    def answer(self) -> bytes | None:
        """Return the pad as a payload, None while it is not known; empty, and so bad, if no vehicle has such a pad."""
        pad = self.geometry()
        try:
            return None if pad is None else json_messages.encode(pad)
        except PayloadError:
            return b""

    def _learn(self, payload: bytes) -> None:
        try:
            told = foreign.transforms_of(payload)
        except PayloadError:
            return
        if len(self._known | told) <= _FRAMES_MAX:
            self._known |= told


class Ros2Session(ZenohSession):
    """An open session of one ROS 2 node; use as a context manager.

    Args:
        session: the library's.
        domain: ROS_DOMAIN_ID.
        node: its namespace and name.
        keys: what the programs speak of.
        topics: where that is found in ROS.
        receive_clock_ns: stamps received samples.
    """

    def __init__(
        self,
        session: zenoh.Session,
        *,
        domain: int,
        node: tuple[str, str],
        keys: Keys,
        topics: TopicMap,
        receive_clock_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        super().__init__(session, receive_clock_ns=receive_clock_ns)
        self._keys = keys
        self._node = RosNode(session, domain, node, self._replies, has_hashes=topics.distribution != "humble")
        self._routes = routes(keys, topics)
        self._publishers_of: dict[str, RosPublisher] = {}
        self._land: LandAction | None = None
        self._pad = None if topics.pad is None else self._pad_source(topics.pad)

    def _send(self, key: str, payload: bytes, encoding: str) -> None:
        """Send `payload` to whoever subscribes to `key`, or to its topic."""
        route = self._routes.get(key)
        if route is None:
            super()._send(key, payload, encoding)
            return
        if route.to_ros is None:
            raise ValueError(f"{route.endpoint.name} is only read")
        self._ros_publisher(route).publish(route.to_ros(payload))
        if self._land is not None and key == self._keys.landing_status:
            self._land.tell(json_messages.decode(LandingStatus, payload))

    def is_heard(self, key: str, encoding: str) -> bool:
        """Return whether anybody subscribes to `key`, or to its topic."""
        route = self._routes.get(key)
        if route is None:
            return super().is_heard(key, encoding)
        return self._ros_publisher(route).is_heard

    def _fill(self, inbox: Inbox, key: str, sample_bytes_max: int | None) -> None:
        """Let come into `inbox` what is published on `key`, or on its topic; the samples carry `key`."""
        route = self._routes.get(key)
        if route is None:
            super()._fill(inbox, key, sample_bytes_max)
            return
        receive = self._into(inbox, key, route.from_ros, sample_bytes_max)
        self._held.append(self._session.declare_subscriber(self._node.data_key(route.endpoint), receive))
        self._node.declare(EntityKind.SUBSCRIPTION, route.endpoint, Qos())

    def watch_alive(self, key: str) -> Alive:
        """Return whether there is a token on `key`; for the vehicle's, whether anybody publishes its position."""
        if key == self._keys.alive:
            key = publishers_key(self._node.domain, self._routes[self._keys.fix].endpoint.name)
        return super().watch_alive(key)

    def ask(self, key: str, payload: bytes, timeout_s: float) -> Inbox:
        """Ask like `query`, but at once return the inbox into which the answers come.

        A pad that the map describes is answered from there, once the transforms that it needs have come.
        """
        if key != self._keys.pad or self._pad is None:
            return super().ask(key, payload, timeout_s)
        inbox = Inbox(capacity=1, wake_up=self.wake_up)
        answer = self._pad.answer()
        if answer is not None:
            inbox.put(Sample(key, answer, self._receive_clock_ns()))
        return inbox

    def serve_later(self, key: str, take: Callable[[bytes, Callable[[bytes], None]], None]) -> None:
        """Answer queries on `key`; commands of the landing are services, and an action, besides."""
        super().serve_later(key, take)
        if key == self._keys.landing_command:
            for command in Command:
                if command is Command.FOLLOW:
                    continue  # a trigger holds no station
                self._serve_trigger(trigger(f"/{self._keys.drone}/landing/{command.value}"), command, take)
            self._land = LandAction(self._node, f"/{self._keys.drone}/landing/land", take)

    def close(self) -> None:
        """Leave the graph and the network; a second call does nothing."""
        super().close()
        self._node.leave()

    def _serve_trigger(
        self, endpoint: Endpoint, command: Command, take: Callable[[bytes, Callable[[bytes], None]], None]
    ) -> None:
        request = json_messages.encode(Order(command=command))
        self._node.serve(endpoint, lambda _, answer: take(request, lambda reply: answer(_trigger_answer(reply))))

    def _ros_publisher(self, route: Route) -> RosPublisher:
        publisher = self._publishers_of.get(route.endpoint.name)
        if publisher is None:
            publisher = self._publishers_of[route.endpoint.name] = self._node.publisher(route.endpoint)
        return publisher

    def _pad_source(self, pad: PadTopics) -> PadSource:
        is_placed = pad.antenna_to_pad_m is not None
        return PadSource(pad, None if is_placed else self._subscribe_latched(topic(pad.tf_static, foreign.TRANSFORMS)))

    def _subscribe_latched(self, endpoint: Endpoint) -> Inbox:
        """Subscribe to what was published before, too, and to what later publishers have kept."""
        inbox = Inbox(capacity=INBOX_CAPACITY, wake_up=self.wake_up)
        self._held.append(
            zenoh.ext.declare_advanced_subscriber(
                self._session,
                self._node.data_key(endpoint),
                self._into(inbox, endpoint.name, bytes),
                history=zenoh.ext.HistoryConfig(detect_late_publishers=True),
            )
        )
        self._node.declare(EntityKind.SUBSCRIPTION, endpoint, LATCHED)
        return inbox

    def _into(
        self, inbox: Inbox, key: str, change: Callable[[bytes], bytes], bytes_max: int | None = None
    ) -> Callable[[zenoh.Sample], None]:
        def receive(sample: zenoh.Sample) -> None:
            if inbox.has_room(len(sample.payload)):
                inbox.put(Sample(key, changed(change, taken(sample.payload, bytes_max)), self._receive_clock_ns()))

        return receive


def open_ros2_session(options: ZenohOptions, ros2: Ros2Options, keys: Keys, node: tuple[str, str]) -> Ros2Session:
    """Return an open session of a node.

    Args:
        options: how to meet others.
        ros2: the domain and the map.
        keys: what the program speaks of.
        node: its namespace and name.

    Raises:
        UserError: The map is wrong, vehicle or drone have a name that ROS does not take, or see `open_session`.
    """
    check_name(f"/{keys.vehicle}", "--ros2: --vehicle")
    check_name(f"/{keys.drone}", "--ros2: --drone")
    topics = load_config(ros2.map_file, TopicMap)
    session = open_library_session(options, stamps=True)  # as rmw_zenoh's own configuration has it
    return Ros2Session(session, domain=ros2.domain, node=node, keys=keys, topics=topics)


def _trigger_answer(answer: bytes) -> bytes:
    """Return the answer of a Trigger for a reply in JSON."""
    reply = json_messages.decode(CommandReply, answer)
    return trigger_reply(accepted=reply.accepted, reason=reply.reason)
