"""Key expressions of rmw_zenoh: of a topic's data, and of the liveliness tokens that make up the ROS graph.

    <domain>/<name>/<type>/<hash>
    @ros2_lv/<domain>/<session>/<node id>/<entity id>/<kind>/<enclave>/<namespace>/<node>[/<name>/<type>/<hash>/<qos>]

In a token, `%` stands for each `/` of a name.
Source: ros2/rmw_zenoh, docs/design.md, "Topic and Service name mapping" and "Graph Cache"; `qos_to_keyexpr`.
"""

import re
from enum import Enum

from msgspec import Struct

from link.errors import UserError

ADMIN_SPACE = "@ros2_lv"
_DEPTH_DEFAULT = 42
"""What rmw_zenoh leaves out of a token."""

_NAME = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")
_TYPE = re.compile(r"(?P<package>[A-Za-z]\w*)/(?P<kind>msg|srv|action)/(?P<name>[A-Za-z]\w*)")
_DDS_TYPE = re.compile(r"(?P<package>[A-Za-z]\w*)::(?P<kind>msg|srv|action)::dds_::(?P<name>[A-Za-z]\w*)_")


class EntityKind(Enum):
    """What a token stands for."""

    NODE = "NN"
    PUBLISHER = "MP"
    SUBSCRIPTION = "MS"
    SERVICE = "SS"
    CLIENT = "SC"


class Qos(Struct, frozen=True, kw_only=True):
    """What of an endpoint's quality of service travels; the rest is ROS's default.

    Attributes:
        is_reliable: else best effort.
        is_latched: transient local: who comes later gets what was published before.
        depth: samples that are kept.
    """

    is_reliable: bool = True
    is_latched: bool = False
    depth: int = 10


class Endpoint(Struct, frozen=True, kw_only=True):
    """A topic or service: its full name (`/car/fix`), its type (`sensor_msgs/msg/NavSatFix`) and the type's hash."""

    name: str
    type_name: str
    type_hash: str


class Token(Struct, frozen=True, kw_only=True):
    """An entity of the ROS graph; only a node has no endpoint."""

    domain: int
    session_id: str
    node_id: int
    entity_id: int
    kind: EntityKind
    namespace: str
    node: str
    endpoint: Endpoint | None = None
    qos: Qos = Qos()


def check_name(name: str, source: str) -> str:
    """Return a full ROS name.

    Raises:
        UserError: It is none; `source` says where it was written.
    """
    if not _NAME.fullmatch(name):
        raise UserError(f"{source} {name!r} is no ROS name: write it as /car/fix, of letters, digits and '_'")
    return name


def data_key(domain: int, endpoint: Endpoint) -> str:
    """Return the key on which a topic's samples travel, or a service's requests."""
    return f"{domain}/{endpoint.name.strip('/')}/{dds_type(endpoint.type_name)}/{endpoint.type_hash}"


def publishers_key(domain: int, name: str) -> str:
    """Return the key of the tokens of all publishers of a topic, of whatever type."""
    return f"{ADMIN_SPACE}/{domain}/*/*/*/{EntityKind.PUBLISHER.value}/*/*/*/{_mangled(name)}/**"


def token_key(token: Token) -> str:
    """Return the key on which an entity's token is declared."""
    parts = [
        ADMIN_SPACE,
        str(token.domain),
        token.session_id,
        str(token.node_id),
        str(token.entity_id),
        token.kind.value,
        "%",  # no enclave
        _mangled(token.namespace),
        token.node,
    ]
    if token.endpoint is not None:
        endpoint = token.endpoint
        parts += [_mangled(endpoint.name), dds_type(endpoint.type_name), endpoint.type_hash, qos_text(token.qos)]
    return "/".join(parts)


def parse_token(key: str) -> Token | None:
    """Return the entity whose token is on `key`, None for what is no token of this layout."""
    parts = key.split("/")
    if len(parts) not in {9, 13} or parts[0] != ADMIN_SPACE or not all(parts):
        return None
    try:
        kind = EntityKind(parts[5])
        domain, node_id, entity_id = int(parts[1]), int(parts[3]), int(parts[4])
        endpoint, qos = (None, Qos()) if kind is EntityKind.NODE else _endpoint(parts[9:])
    except (ValueError, IndexError):
        return None
    return Token(
        domain=domain,
        session_id=parts[2],
        node_id=node_id,
        entity_id=entity_id,
        kind=kind,
        namespace=_demangled(parts[7]),
        node=_demangled(parts[8]),
        endpoint=endpoint,
        qos=qos,
    )


def _endpoint(parts: list[str]) -> tuple[Endpoint, Qos]:
    name, type_name, type_hash, qos = parts
    endpoint = Endpoint(name=_demangled(name), type_name=ros_type(type_name), type_hash=type_hash)
    return endpoint, parse_qos(qos)


def dds_type(type_name: str) -> str:
    """Return `std_msgs/msg/String` as `std_msgs::msg::dds_::String_`.

    Raises:
        ValueError: It is no type of ROS 2.
    """
    match = _TYPE.fullmatch(type_name)
    if match is None:
        raise ValueError(f"{type_name!r} is no type such as std_msgs/msg/String")
    return f"{match['package']}::{match['kind']}::dds_::{match['name']}_"


def ros_type(type_name: str) -> str:
    """Return `std_msgs::msg::dds_::String_` as `std_msgs/msg/String`; what is written otherwise stays."""
    match = _DDS_TYPE.fullmatch(type_name)
    return type_name if match is None else f"{match['package']}/{match['kind']}/{match['name']}"


def qos_text(qos: Qos) -> str:
    """Return the compact form: what is rmw_zenoh's default (reliable, volatile, the last 42) is left out."""
    reliability = "" if qos.is_reliable else "2"
    durability = "1" if qos.is_latched else ""
    depth = "" if qos.depth == _DEPTH_DEFAULT else str(qos.depth)
    return f"{reliability}:{durability}:,{depth}:,:,:,,"


def parse_qos(text: str) -> Qos:
    """Return what a compact form says.

    Raises:
        ValueError: It is none.
    """
    reliability, durability, history, *_ = text.split(":")
    depth = history.partition(",")[2]
    return Qos(
        is_reliable=reliability != "2",
        is_latched=durability == "1",
        depth=int(depth) if depth else _DEPTH_DEFAULT,
    )


def _mangled(name: str) -> str:
    return name.replace("/", "%") or "%"


def _demangled(name: str) -> str:
    return name.replace("%", "/")
