"""Hashes of types against published ones.

Sources: docs/design.md of ros2/rmw_zenoh (String, AddTwoInts); for the others, constants that several independent
public projects hold to talk to real ROS 2 graphs.
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
    "sensor_msgs/msg/Imu": "7d9a00ff131080897a5ec7e26e315954b8eae3353c3f995c55faf71574000b5b",
    "nav_msgs/msg/Odometry": "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0",
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
