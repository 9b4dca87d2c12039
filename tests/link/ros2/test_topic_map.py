"""A map of topics that says what cannot be is refused as it is read, in one line."""

from pathlib import Path

import pytest

from link.errors import UserError
from link.program.toml_config import load_config
from link.ros2.topic_map import TopicMap

ODOMETRY = '[vehicle]\nodometry = "/odometry"\nodometry_origin = {}\n'
PAD = "[pad]\nsize_m = {}\nheight_m = {}\nantenna_to_pad_m = {}\n"


def read(tmp_path: Path, text: str) -> TopicMap:
    path = tmp_path / "topics.toml"
    path.write_text(text, encoding="utf-8")
    return load_config(path, TopicMap)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (ODOMETRY.format([95.0, 8.5, 400.0]), r"vehicle\.odometry_origin\[0\] = 95\.0 does not fit"),
        (ODOMETRY.format([47.4, 181.0, 400.0]), r"vehicle\.odometry_origin\[1\] = 181\.0 does not fit"),
        (PAD.format([150.0, 1.5], 1.5, [0.0, 0.0, 0.0]), r"pad\.size_m\[0\] = 150\.0 does not fit"),
        (PAD.format([1.5, 1.5], 80.0, [0.0, 0.0, 0.0]), r"pad\.height_m = 80\.0 does not fit"),
        (PAD.format([1.5, 1.5], 1.5, [0.0, 0.0, 40.0]), r"pad\.antenna_to_pad_m\[2\] = 40\.0 does not fit"),
    ],
)
def test_a_place_that_is_none_and_a_pad_that_no_vehicle_has_are_refused(tmp_path: Path, text: str, told: str) -> None:
    with pytest.raises(UserError, match=told):
        read(tmp_path, text)


def test_a_place_at_a_pole_is_one(tmp_path: Path) -> None:
    origin = read(tmp_path, ODOMETRY.format([-90.0, 180.0, 2835.0])).vehicle.odometry_origin
    assert origin == (-90.0, 180.0, 2835.0)
