"""What a check gathers from an autopilot's messages."""

import pytest

from companion.check.reading import Reader
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.session import MavlinkSession
from tests.link.mavlink.fake_autopilot import MS, START_NS


def battery(number: int, percent: int) -> Message:
    return mavlink.MAVLink_battery_status_message(number, 0, 0, 2500, [0] * 10, -1, -1, -1, percent)


@pytest.mark.parametrize(
    ("told", "share"),
    [([(0, 80), (1, 5)], 0.8), ([(1, 5)], None), ([(0, -1), (2, 50)], None), ([(0, 80), (0, 79)], 0.79)],
)
def test_only_the_first_battery_counts_as_in_flight(told: list[tuple[int, int]], share: float | None) -> None:
    reader, autopilot = Reader(MavlinkSession(1)), MavlinkCodec(1, 1)
    heartbeat = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_QUADROTOR, mavlink.MAV_AUTOPILOT_PX4, 0, 0, 3, 3)
    for k, message in enumerate((heartbeat, *(battery(*one) for one in told))):
        reader.receive(autopilot.encode(message), START_NS + k * MS)
    assert reader.facts().battery_share == share
