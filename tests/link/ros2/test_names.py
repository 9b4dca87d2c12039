"""Keys and tokens of rmw_zenoh, byte for byte.

Sources: DESIGN are the examples of docs/design.md of ros2/rmw_zenoh; CAPTURE is what an rmw_zenoh 0.10 (ROS 2 Lyrical,
`ros2 topic pub /chatter`) was seen to send, as published in the tests of the Go package rmwzenoh of conductor.dev;
PYZEROS is what pyzeros 0.1.0 (2lian/pyzeros2 on GitHub) declares, which talks to Jazzy and Lyrical. Of its data keys
those of pamoja-ros2 0.2.0 (Rust) are the same.
"""

import pytest

from link.errors import UserError
from link.ros2.names import (
    Endpoint,
    EntityKind,
    Qos,
    Token,
    check_name,
    data_key,
    dds_type,
    parse_qos,
    parse_token,
    publishers_key,
    qos_text,
    token_key,
)

STRING_HASH = "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
TWO_INTS_HASH = "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"
CHATTER = Endpoint(name="/chatter", type_name="std_msgs/msg/String", type_hash=STRING_HASH)
TWO_INTS = Endpoint(name="/add_two_ints", type_name="example_interfaces/srv/AddTwoInts", type_hash=TWO_INTS_HASH)
ROBOT_CHATTER = Endpoint(name="/robot1/chatter", type_name="std_msgs/msg/String", type_hash=STRING_HASH)

DESIGN_KEYS = [
    (0, CHATTER, f"0/chatter/std_msgs::msg::dds_::String_/{STRING_HASH}"),
    (0, ROBOT_CHATTER, f"0/robot1/chatter/std_msgs::msg::dds_::String_/{STRING_HASH}"),
    (2, TWO_INTS, f"2/add_two_ints/example_interfaces::srv::dds_::AddTwoInts_/{TWO_INTS_HASH}"),
]


def token(session: str, kind: EntityKind, node: str, depth: int, there: Endpoint) -> Token:
    return Token(
        domain=2,
        session_id=session,
        node_id=0,
        entity_id=10,
        kind=kind,
        namespace="",
        node=node,
        endpoint=there,
        qos=Qos(depth=depth),
    )


LISTENER = Token(
    domain=2,
    session_id="aac3178e146ba6f1fc6e6a4085e77f21",
    node_id=0,
    entity_id=0,
    kind=EntityKind.NODE,
    namespace="",
    node="listener",
)
DESIGN_TOKENS = [
    (LISTENER, "@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/0/NN/%/%/listener"),
    (
        token("aac3178e146ba6f1fc6e6a4085e77f21", EntityKind.SUBSCRIPTION, "listener", 10, CHATTER),
        (
            "@ros2_lv/2/aac3178e146ba6f1fc6e6a4085e77f21/0/10/MS/%/%/listener/%chatter/"
            f"std_msgs::msg::dds_::String_/{STRING_HASH}/::,10:,:,:,,"
        ),
    ),
    (
        token("8b20917502ee955ac4476e0266340d5c", EntityKind.PUBLISHER, "talker", 7, CHATTER),
        (
            "@ros2_lv/2/8b20917502ee955ac4476e0266340d5c/0/10/MP/%/%/talker/%chatter/"
            f"std_msgs::msg::dds_::String_/{STRING_HASH}/::,7:,:,:,,"
        ),
    ),
    (
        token("f9980ee0495eaafb3e38f0d19e2eae12", EntityKind.SERVICE, "add_two_ints_server", 10, TWO_INTS),
        (
            "@ros2_lv/2/f9980ee0495eaafb3e38f0d19e2eae12/0/10/SS/%/%/add_two_ints_server/%add_two_ints/"
            f"example_interfaces::srv::dds_::AddTwoInts_/{TWO_INTS_HASH}/::,10:,:,:,,"
        ),
    ),
    (
        token("e1dc8d1b45ae8717fce78689cc655685", EntityKind.CLIENT, "add_two_ints_client", 10, TWO_INTS),
        (
            "@ros2_lv/2/e1dc8d1b45ae8717fce78689cc655685/0/10/SC/%/%/add_two_ints_client/%add_two_ints/"
            f"example_interfaces::srv::dds_::AddTwoInts_/{TWO_INTS_HASH}/::,10:,:,:,,"
        ),
    ),
]
ODOMETRY_HASH = "RIHS01_3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"
TRIGGER_HASH = "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f"
STATE = Endpoint(name="/localization/kinematic_state", type_name="nav_msgs/msg/Odometry", type_hash=ODOMETRY_HASH)
START = Endpoint(name="/drone/landing/start", type_name="std_srvs/srv/Trigger", type_hash=TRIGGER_HASH)
STATE_ROW = f"nav_msgs::msg::dds_::Odometry_/{ODOMETRY_HASH}"
START_ROW = f"std_srvs::srv::dds_::Trigger_/{TRIGGER_HASH}"
PYZEROS_KEYS = [
    (7, STATE, f"7/localization/kinematic_state/{STATE_ROW}"),
    (7, START, f"7/drone/landing/start/{START_ROW}"),
]


def pyzeros(entity: int, kind: EntityKind, node: str, there: Endpoint | None = None, depth: int = 10) -> Token:
    namespace, _, name = node.rpartition("/")
    return Token(
        domain=7,
        session_id="e48c71bd01fa52f27af91cad59ce8fdb",
        node_id=0,
        entity_id=entity,
        kind=kind,
        namespace=namespace,
        node=name,
        endpoint=there,
        qos=Qos(is_reliable=kind is not EntityKind.SUBSCRIPTION, depth=depth),
    )


PYZEROS = "@ros2_lv/7/e48c71bd01fa52f27af91cad59ce8fdb/0"
PYZEROS_TOKENS = [
    (pyzeros(0, EntityKind.NODE, "/localization/ekf_localizer"), f"{PYZEROS}/0/NN/%/%localization/ekf_localizer"),
    (
        pyzeros(1, EntityKind.PUBLISHER, "/localization/ekf_localizer", STATE, 1),
        f"{PYZEROS}/1/MP/%/%localization/ekf_localizer/%localization%kinematic_state/{STATE_ROW}/::,1:,:,:,,",
    ),
    (
        pyzeros(2, EntityKind.SUBSCRIPTION, "/drone/companion", STATE, 5),
        f"{PYZEROS}/2/MS/%/%drone/companion/%localization%kinematic_state/{STATE_ROW}/2::,5:,:,:,,",
    ),
    (
        pyzeros(3, EntityKind.SERVICE, "/drone/companion", START),
        f"{PYZEROS}/3/SS/%/%drone/companion/%drone%landing%start/{START_ROW}/::,10:,:,:,,",
    ),
    (
        pyzeros(3, EntityKind.CLIENT, "/drone/companion", START),
        f"{PYZEROS}/3/SC/%/%drone/companion/%drone%landing%start/{START_ROW}/::,10:,:,:,,",
    ),
]
CAPTURE_QOS = [
    (Qos(depth=10), "::,10:,:,:,,"),
    (Qos(is_reliable=False, depth=5), "2::,5:,:,:,,"),
    (Qos(is_latched=True, depth=1), ":1:,1:,:,:,,"),
    (Qos(depth=42), "::,:,:,:,,"),  # rmw_zenoh's own default, left out
]


@pytest.mark.parametrize(("domain", "there", "key"), DESIGN_KEYS + PYZEROS_KEYS)
def test_data_key_is_that_of_the_design_document_and_of_others(domain: int, there: Endpoint, key: str) -> None:
    assert data_key(domain, there) == key


@pytest.mark.parametrize(("entity", "key"), DESIGN_TOKENS + PYZEROS_TOKENS, ids=lambda one: getattr(one, "node", ""))
def test_token_is_that_of_the_design_document_and_of_others(entity: Token, key: str) -> None:
    assert token_key(entity) == key
    read = parse_token(key)
    assert read is not None
    assert token_key(read) == key
    assert (read.node, read.kind, read.endpoint, read.qos) == (entity.node, entity.kind, entity.endpoint, entity.qos)


@pytest.mark.parametrize(("qos", "text"), CAPTURE_QOS)
def test_qos_is_as_captured(qos: Qos, text: str) -> None:
    assert qos_text(qos) == text
    assert parse_qos(text) == qos


@pytest.mark.parametrize(
    "key",
    [
        "",
        "decklander/vehicle/alive",
        "@ros2_lv/2/z/0/0/NN/%/%",  # too short
        "@ros2_lv/two/z/0/0/NN/%/%/node",
        "@ros2_lv/2/z/0/0/XX/%/%/node",  # no such kind
        "@ros2_lv/2/z/0/0/MP/%/%/node",  # a publisher of nothing
        "@ros2_lv/2/z/0/1/MP/%/%/node/%a/b/c/d",  # no quality of service
    ],
)
def test_other_keys_are_no_tokens(key: str) -> None:
    assert parse_token(key) is None


def test_tokens_of_a_topics_publishers_match_its_key() -> None:
    expected = publishers_key(2, "/chatter").split("/")
    (_, publisher) = DESIGN_TOKENS[2]
    assert all(want in {"*", "**", part} for want, part in zip(expected, publisher.split("/"), strict=False))


@pytest.mark.parametrize("name", ["fix", "/", "//fix", "/a-b", "/1a", "/a/"])
def test_what_ros_takes_for_no_name_is_refused(name: str) -> None:
    with pytest.raises(UserError, match="is no ROS name"):
        check_name(name, "--ros2: --vehicle")


def test_type_without_a_package_is_refused() -> None:
    with pytest.raises(ValueError, match="no type"):
        dds_type("String")
