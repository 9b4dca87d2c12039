"""A Zenoh session in the layout of rmw_zenoh: to a ROS 2 graph, the program is a node.

The programs go on speaking of their own keys (`link.zenoh.keys`); here these become topics, with a token for each
endpoint and an attachment on each sample. Attachments of samples that come are not read, so wrong and missing ones do
no harm.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass

import zenoh
import zenoh.ext

from link.messages import Command, CommandReply
from link.payloads import json_messages
from link.program.toml_config import load_config
from link.records import replace
from link.ros2 import attachment, foreign
from link.ros2.attachment import Attachment
from link.ros2.names import (
    ADMIN_SPACE,
    Endpoint,
    EntityKind,
    Qos,
    Token,
    check_name,
    data_key,
    parse_token,
    publishers_key,
    token_key,
)
from link.ros2.options import Ros2Options
from link.ros2.pad_source import PadSource
from link.ros2.routes import Route, changed, routes, topic, trigger, trigger_reply
from link.ros2.topic_map import PadTopics, TopicMap
from link.ros2.type_hash import NOT_SUPPORTED
from link.zenoh.keys import Keys
from link.zenoh.library_config import open_library_session
from link.zenoh.options import ZenohOptions
from link.zenoh.session import INBOX_CAPACITY, Alive, Inbox, Sample, ZenohSession

_NODE_ID = 0
_GRAPH_S = 2.0


@dataclass(slots=True, kw_only=True)
class _Publisher:
    publisher: zenoh.Publisher
    identity: bytes
    sequence: int = 0


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
        self._domain, self._node, self._keys = domain, node, keys
        self._has_hashes = topics.distribution != "humble"
        self._routes = routes(keys, topics)
        self._endpoints: dict[str, _Publisher] = {}
        self._entities = _NODE_ID
        self._declare(EntityKind.NODE, None, Qos())
        self._pad = None if topics.pad is None else self._pad_source(topics.pad)

    def _send(self, key: str, payload: bytes, encoding: str) -> None:
        """Send `payload` to whoever subscribes to `key`, or to its topic."""
        route = self._routes.get(key)
        if route is None:
            super()._send(key, payload, encoding)
            return
        if route.to_ros is None:
            raise ValueError(f"{route.endpoint.name} is only read")
        there = self._endpoint(route)
        there.sequence += 1
        told = Attachment(sequence=there.sequence, source_time_ns=time.time_ns(), publisher_id=there.identity)
        there.publisher.put(route.to_ros(payload), attachment=attachment.encode(told))

    def is_heard(self, key: str, encoding: str) -> bool:
        """Return whether anybody subscribes to `key`, or to its topic."""
        route = self._routes.get(key)
        if route is None:
            return super().is_heard(key, encoding)
        status: object = self._endpoint(route).publisher.matching_status  # its stub calls it a plain truth value
        return bool(getattr(status, "matching", status))

    def subscribe(self, key: str, *, capacity: int = INBOX_CAPACITY, bytes_max: int | None = None) -> Inbox:
        """Return the inbox of all that is published on `key`, or on its topic; the samples carry `key`."""
        route = self._routes.get(key)
        if route is None:
            return super().subscribe(key, capacity=capacity, bytes_max=bytes_max)
        inbox = Inbox(capacity=capacity, wake_up=self.wake_up, bytes_max=bytes_max)
        self._held.append(
            self._session.declare_subscriber(self._data_key(route.endpoint), self._into(inbox, key, route.from_ros))
        )
        self._declare(EntityKind.SUBSCRIPTION, route.endpoint, Qos())
        return inbox

    def watch_alive(self, key: str) -> Alive:
        """Return whether there is a token on `key`; for the vehicle's, whether anybody publishes its position."""
        if key == self._keys.alive:
            key = publishers_key(self._domain, self._routes[self._keys.fix].endpoint.name)
        return super().watch_alive(key)

    def ask(self, key: str, payload: bytes, timeout_s: float) -> Inbox:
        """Ask like `query`, but at once return the inbox into which the answers come.

        A pad that the map describes is answered from there, once the transforms that it needs have come.
        """
        if key != self._keys.pad or self._pad is None:
            return super().ask(key, payload, timeout_s)
        inbox = Inbox(capacity=1, wake_up=self.wake_up)
        pad = self._pad.geometry()
        if pad is not None:
            inbox.put(Sample(key, json_messages.encode(pad), self._receive_clock_ns()))
        return inbox

    def serve_later(self, key: str, take: Callable[[bytes, Callable[[bytes], None]], None]) -> None:
        """Answer queries on `key`; commands of the landing are services of type std_srvs/srv/Trigger besides."""
        super().serve_later(key, take)
        if key == self._keys.landing_command:
            for command in Command:
                self._serve_trigger(trigger(f"/{self._keys.drone}/landing/{command.value}"), command, take)

    def _serve_trigger(
        self, endpoint: Endpoint, command: Command, take: Callable[[bytes, Callable[[bytes], None]], None]
    ) -> None:
        key, request = self._data_key(endpoint), json_messages.encode(command)

        def receive(query: zenoh.Query) -> None:
            take(request, lambda answer: self._replies.put(query, lambda: _reply_trigger(query, key, answer)))

        self._held.append(self._session.declare_queryable(key, receive, complete=True))
        self._declare(EntityKind.SERVICE, endpoint, Qos())

    def _endpoint(self, route: Route) -> _Publisher:
        endpoint = self._endpoints.get(route.endpoint.name)
        if endpoint is None:
            publisher = self._session.declare_publisher(
                self._data_key(route.endpoint), congestion_control=zenoh.CongestionControl.BLOCK
            )
            token = self._declare(EntityKind.PUBLISHER, route.endpoint, Qos())
            endpoint = _Publisher(publisher=publisher, identity=attachment.publisher_id(token))
            self._endpoints[route.endpoint.name] = endpoint
        return endpoint

    def _pad_source(self, pad: PadTopics) -> PadSource:
        is_placed = pad.antenna_to_pad_m is not None
        return PadSource(pad, None if is_placed else self._subscribe_latched(topic(pad.tf_static, foreign.TRANSFORMS)))

    def _subscribe_latched(self, endpoint: Endpoint) -> Inbox:
        """Subscribe to what was published before, too, and to what later publishers have kept."""
        qos = Qos(is_latched=True, depth=1)
        inbox = Inbox(capacity=INBOX_CAPACITY, wake_up=self.wake_up)
        self._held.append(
            zenoh.ext.declare_advanced_subscriber(
                self._session,
                self._data_key(endpoint),
                self._into(inbox, endpoint.name, bytes),
                history=zenoh.ext.HistoryConfig(detect_late_publishers=True),
            )
        )
        self._declare(EntityKind.SUBSCRIPTION, endpoint, qos)
        return inbox

    def _into(self, inbox: Inbox, key: str, change: Callable[[bytes], bytes]) -> Callable[[zenoh.Sample], None]:
        def receive(sample: zenoh.Sample) -> None:
            if inbox.has_room(len(sample.payload)):
                inbox.put(Sample(key, changed(change, sample.payload.to_bytes()), self._receive_clock_ns()))

        return receive

    def _declare(self, kind: EntityKind, endpoint: Endpoint | None, qos: Qos) -> str:
        """Show an entity to the graph and return its token's key."""
        namespace, node = self._node
        token = Token(
            domain=self._domain,
            session_id=str(self._session.zid()),
            node_id=_NODE_ID,
            entity_id=self._entities,
            kind=kind,
            namespace=namespace,
            node=node,
            endpoint=None if endpoint is None else self._written(endpoint),
            qos=qos,
        )
        self._entities += 1
        key = token_key(token)
        self._held.append(self._session.liveliness().declare_token(key))
        return key

    def _data_key(self, endpoint: Endpoint) -> str:
        return data_key(self._domain, self._written(endpoint))

    def _written(self, endpoint: Endpoint) -> Endpoint:
        """Return an endpoint as this distribution writes it."""
        return endpoint if self._has_hashes else replace(endpoint, type_hash=NOT_SUPPORTED)


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
    return Ros2Session(open_library_session(options), domain=ros2.domain, node=node, keys=keys, topics=topics)


def read_graph(options: ZenohOptions, domain: int) -> list[Token]:
    """Return all entities of a ROS graph that answer.

    Raises:
        UserError: The session cannot be opened.
    """
    session = open_library_session(options)
    try:
        replies = session.liveliness().get(f"{ADMIN_SPACE}/{domain}/**", timeout=_GRAPH_S)
        found = (parse_token(str(reply.ok.key_expr)) for reply in replies if reply.ok is not None)
        return [token for token in found if token is not None]
    finally:
        session.close()  # type: ignore[no-untyped-call]  # its stub has no return type


def _reply_trigger(query: zenoh.Query, key: str, answer: bytes) -> None:
    """Answer the call of a Trigger, with the caller's own number, by a reply in JSON."""
    asked = None if query.attachment is None else attachment.decode(query.attachment.to_bytes())
    told = Attachment(
        sequence=0 if asked is None else asked.sequence,
        source_time_ns=time.time_ns(),
        publisher_id=bytes(16) if asked is None else asked.publisher_id,
    )
    reply = json_messages.decode(CommandReply, answer)
    payload = trigger_reply(accepted=reply.accepted, reason=reply.reason)
    query.reply(key, payload, attachment=attachment.encode(told))
