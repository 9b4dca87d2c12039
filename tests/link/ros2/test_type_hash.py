"""Hashes of types against published ones.

Sources: docs/design.md of ros2/rmw_zenoh (String, AddTwoInts); for the others, what ros2_pyterfaces 0.3.0 computes
from its own definitions to talk to graphs of Jazzy and Lyrical, and constants of several other public projects.
"""

import pytest

from link.payloads import cdr
from link.ros2.routes import RECORDS, TRIGGER, routes, trigger
from link.ros2.topic_map import TopicMap
from link.ros2.type_hash import service_hash, type_hash
from link.zenoh.keys import Keys

PUBLISHED = {
    "std_msgs/msg/String": "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18",
    "sensor_msgs/msg/NavSatFix": "62223ab3fe210a15976021da7afddc9e200dc9ec75231c1b6a557fc598a65404",
    "std_msgs/msg/Header": "f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01",
    "rosgraph_msgs/msg/Clock": "692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564",
    "unique_identifier_msgs/msg/UUID": "1b8e8aca958cbea28fe6ef60bf6c19b683c97a9ef60bb34752067d0f2f7ab437",
    "sensor_msgs/msg/CompressedImage": "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a",
    "sensor_msgs/msg/Image": "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47",
    "sensor_msgs/msg/JointState": "a13ee3a330e346c9d87b5aa18d24e11690752bd33a0350f11c5882bc9179260e",
    "sensor_msgs/msg/Imu": "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b",
    "nav_msgs/msg/Odometry": "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
    "nav_msgs/msg/Path": "1957a5bb3cee5da65c4e52e52b65a93df227efce4c20f8458b36e73066ca334b",
    "geometry_msgs/msg/PoseStamped": "10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8",
    "geometry_msgs/msg/TransformStamped": "0a241f87d04668d94099cbb5ba11691d5ad32c2f29682e4eb5653424bd275206",
    "geometry_msgs/msg/PoseWithCovarianceStamped": "26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e",
    "geometry_msgs/msg/TwistWithCovarianceStamped": "77b67434531e6529b7a0091357b186b6ebdb17fd9ffd3e0c7ce9d3fb11a44563",
    "geometry_msgs/msg/TwistStamped": "5f0fcd4f81d5d06ad9b4c4c63e3ea51b82d6ae4d0558f1d475229b1121db6f64",
}


@pytest.mark.parametrize("type_name", PUBLISHED)
def test_hash_of_a_message_is_the_published_one(type_name: str) -> None:
    assert type_hash(type_name) == f"RIHS01_{PUBLISHED[type_name]}"


def test_hash_of_a_service_is_the_published_one() -> None:
    two_ints = service_hash("example_interfaces/srv/AddTwoInts", "int64 a\nint64 b\n", "int64 sum\n")
    assert two_ints == "RIHS01_e118de6bf5eeb66a2491b5bda11202e7b68f198d6f67922cf30364858239c81a"
    assert trigger("/a").type_hash == "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f"
    assert trigger("/a").type_name == TRIGGER


def test_every_message_of_ours_has_a_hash() -> None:
    assert len({type_hash(name) for name in cdr.ROS_TYPES.values()}) == len(set(cdr.ROS_TYPES.values()))
    hashes = [route.endpoint.type_hash for route in routes(Keys(), TopicMap()).values()]
    assert len(hashes) >= len(RECORDS) + 6
    assert all(one.startswith("RIHS01_") and len(one) == 71 for one in hashes)
