"""A node of a ROS 2 graph on a Zenoh session: its entities' tokens, publishers that number what they say, services."""

import threading
import time
from collections.abc import Callable

import zenoh
import zenoh.ext

from link.records import replace
from link.ros2 import attachment
from link.ros2.attachment import Attachment
from link.ros2.names import ADMIN_SPACE, Endpoint, EntityKind, Qos, Token, data_key, parse_token, token_key
from link.ros2.type_hash import NOT_SUPPORTED
from link.zenoh.library_config import is_matched, open_library_session
from link.zenoh.options import ZenohOptions
from link.zenoh.replies import Replies

_NODE_ID = 0
_GRAPH_S = 2.0
LATCHED = Qos(is_latched=True, depth=1)
"""Who comes later gets what was said last."""

Answer = Callable[[bytes], None]


class RosPublisher:
    """Says payloads on a topic, each with its number, time and publisher.

    Args:
        publisher: the library's.
        token: of this entity.
    """

    def __init__(self, publisher: "zenoh.Publisher | zenoh.ext.AdvancedPublisher", token: str) -> None:
        self._publisher = publisher
        self._identity = attachment.publisher_id(token)
        self._lock = threading.Lock()
        self._sequence = 0

    def publish(self, payload: bytes) -> None:
        """Send a payload; from any thread."""
        with self._lock:
            self._sequence += 1
            told = Attachment(sequence=self._sequence, source_time_ns=time.time_ns(), publisher_id=self._identity)
            self._publisher.put(payload, attachment=attachment.encode(told))

    @property
    def is_heard(self) -> bool:
        """Whether anybody subscribes."""
        return is_matched(self._publisher)


class RosNode:
    """The node of a program.

    Args:
        session: the library's.
        domain: ROS_DOMAIN_ID.
        name: its namespace and name.
        has_hashes: its types have hashes, which Humble's have not.
        replies: send the answers of its services.
    """

    def __init__(
        self, session: zenoh.Session, domain: int, name: tuple[str, str], replies: Replies, *, has_hashes: bool
    ) -> None:
        self.domain = domain
        self._session, self._name, self._replies = session, name, replies
        self._has_hashes = has_hashes
        self._entities = _NODE_ID
        self._held: list[object] = []  # what Zenoh would undeclare when nobody holds it
        self.declare(EntityKind.NODE, None, Qos())

    def declare(self, kind: EntityKind, endpoint: Endpoint | None, qos: Qos) -> str:
        """Show an entity to the graph and return its token's key."""
        namespace, node = self._name
        token = Token(
            domain=self.domain,
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

    def data_key(self, endpoint: Endpoint) -> str:
        """Return the key of an endpoint's samples or requests."""
        return data_key(self.domain, self._written(endpoint))

    def publisher(self, endpoint: Endpoint) -> RosPublisher:
        """Return a new publisher of a topic."""
        publisher = self._session.declare_publisher(
            self.data_key(endpoint), congestion_control=zenoh.CongestionControl.BLOCK
        )
        return RosPublisher(publisher, self.declare(EntityKind.PUBLISHER, endpoint, Qos()))

    def latched_publisher(self, endpoint: Endpoint) -> RosPublisher:
        """Return a new publisher whose last sample those get, too, who come later."""
        publisher = zenoh.ext.declare_advanced_publisher(
            self._session,
            self.data_key(endpoint),
            cache=zenoh.ext.CacheConfig(max_samples=1),
            publisher_detection=True,
        )
        return RosPublisher(publisher, self.declare(EntityKind.PUBLISHER, endpoint, LATCHED))

    def serve(self, endpoint: Endpoint, take: Callable[[bytes, Answer], None]) -> None:
        """Answer calls of a service by `take(request, answer)`: `answer(response)` once, from any thread."""
        key = self.data_key(endpoint)

        def receive(query: zenoh.Query) -> None:
            request = b"" if query.payload is None else query.payload.to_bytes()
            take(request, lambda response: self._replies.put(query, lambda: _answer(query, key, response)))

        self._held.append(self._session.declare_queryable(key, receive, complete=True))
        self.declare(EntityKind.SERVICE, endpoint, Qos())

    def leave(self) -> None:
        """Take all of it back."""
        self._held.clear()

    def _written(self, endpoint: Endpoint) -> Endpoint:
        """Return an endpoint as this distribution writes it."""
        return endpoint if self._has_hashes else replace(endpoint, type_hash=NOT_SUPPORTED)


def _answer(query: zenoh.Query, key: str, response: bytes) -> None:
    """Answer a call, with the caller's own number."""
    asked = None if query.attachment is None else attachment.decode(query.attachment.to_bytes())
    told = Attachment(
        sequence=0 if asked is None else asked.sequence,
        source_time_ns=time.time_ns(),
        publisher_id=bytes(16) if asked is None else asked.publisher_id,
    )
    query.reply(key, response, attachment=attachment.encode(told))


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
