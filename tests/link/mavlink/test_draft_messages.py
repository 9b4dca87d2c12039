"""PX4's draft messages: known to the codec as any other message is."""

import pytest

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import DRAFT_MESSAGES


# CRC_EXTRA and payload length as in the C headers that PX4 is built with.
@pytest.mark.parametrize(
    ("message_id", "crc_extra", "length"),
    [(8, 117, 36), (80, 14, 4), (380, 232, 20), (396, 50, 160), (410, 160, 53), (411, 106, 3)],
)
def test_seed_and_length_are_those_of_the_c_headers(message_id: int, crc_extra: int, length: int) -> None:
    draft = DRAFT_MESSAGES[message_id]
    assert (draft.crc_extra, draft.unpacker.size) == (crc_extra, length)


def test_event_survives_the_wire() -> None:
    arguments = list(range(40))
    event = DRAFT_MESSAGES[410](191, 1, 0x0139_C2A7, 12_345, 65_530, 0x62, arguments)
    (heard,) = MavlinkCodec(255, 190).decode(MavlinkCodec(1, 1).encode(event))
    assert heard.get_type() == "EVENT"
    assert (heard.id, heard.event_time_boot_ms, heard.sequence, heard.log_levels) == (0x0139_C2A7, 12_345, 65_530, 0x62)
    assert heard.arguments == arguments
