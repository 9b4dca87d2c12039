"""A client for tests that uploads and downloads plans."""

from collections.abc import Sequence
from math import nan

from link.mavlink.dialect import Message, mavlink
from tests.sim_autopilot.pilot import Pilot

RELATIVE = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
DO = mavlink.MAV_FRAME_MISSION
LATITUDE, LONGITUDE = 524_733_000, 134_017_000
NORTH_M = 1e7 / 111_250.0  # wire units of latitude, at 52.5 degrees north
EAST_M = 1e7 / 67_960.0


def item(
    index: int,
    command: int,
    place: tuple[float, float, float] | None = None,
    parameters: tuple[float, float, float, float] = (0.0, 0.0, 0.0, nan),
    *,
    kind: int = 0,
    frame: int = RELATIVE,
) -> Message:
    """A MISSION_ITEM_INT at `place`: metres east and north of the datum, metres above home."""
    if place is None:
        x, y, z, frame = 0, 0, 0.0, DO
    else:
        x, y, z = round(LATITUDE + place[1] * NORTH_M), round(LONGITUDE + place[0] * EAST_M), place[2]
    return mavlink.MAVLink_mission_item_int_message(1, 1, index, frame, command, 0, 1, *parameters, x, y, z, kind)


def plan_messages(messages: Sequence[Message]) -> list[Message]:
    """Those of the mission protocol, without what is told of a flight."""
    told = {"MISSION_CURRENT", "MISSION_ITEM_REACHED"}
    return [m for m in messages if m.get_type().startswith("MISSION_") and m.get_type() not in told]


def upload(pilot: Pilot, items: Sequence[Message], kind: int = 0) -> int:
    """Upload, and return the result."""
    answers = plan_messages(pilot.step(mavlink.MAVLink_mission_count_message(1, 1, len(items), kind)))
    while answers and answers[-1].get_type().startswith("MISSION_REQUEST"):
        answers = plan_messages(pilot.step(items[answers[-1].seq]))
    return int(answers[-1].type)


def download(pilot: Pilot, kind: int = 0) -> list[Message]:
    """Download, and acknowledge."""
    (count,) = plan_messages(pilot.step(mavlink.MAVLink_mission_request_list_message(1, 1, kind)))
    items: list[Message] = []
    for index in range(count.count):
        items += plan_messages(pilot.step(mavlink.MAVLink_mission_request_int_message(1, 1, index, kind)))
    pilot.step(mavlink.MAVLink_mission_ack_message(1, 1, 0, kind))
    return items
