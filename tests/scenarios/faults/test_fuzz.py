from itertools import islice

import pytest

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import mavlink
from scenarios.faults.fuzz import LINK_KINDS, fuzz, open_link
from scenarios.faults.fuzz_companion import fuzz_companion
from scenarios.faults.fuzz_frames import fuzz_frames

ORDERS = {"COMMAND_LONG", "COMMAND_INT", "PARAM_SET", "SET_MODE", "SET_POSITION_TARGET_LOCAL_NED", "MANUAL_CONTROL"}


@pytest.mark.slow
def test_the_same_seed_gives_the_same_frames() -> None:
    assert list(islice(fuzz_frames(3), 500)) == list(islice(fuzz_frames(3), 500))
    assert list(islice(fuzz_frames(3), 500)) != list(islice(fuzz_frames(4), 500))


def test_a_good_part_of_the_frames_are_messages_and_none_is_an_order_to_the_autopilot() -> None:
    codec, messages = MavlinkCodec(1, 1), []
    for frame in islice(fuzz_frames(1), 6_000):
        messages += codec.decode(frame)
    assert len(messages) > 1_000
    assert len({message.get_msgId() for message in messages}) > 0.5 * len(mavlink.mavlink_map)
    orders = [message for message in messages if message.get_type() in ORDERS]
    assert orders
    assert all(getattr(one, "target_system", getattr(one, "target", 0)) > 1 for one in orders)
    assert codec.statistics.bad_frames > 300


def test_what_a_full_serial_line_does_not_take_is_told_so_that_no_byte_of_a_stream_is_lost() -> None:
    with open_link("serial") as (transport, send):
        offered, taken = bytes(range(256)) * 2048, 0
        while part := send(offered[taken : taken + 1000]):
            taken += part
        assert 0 < taken < len(offered)
        received = b""
        while data := transport.receive(0.5):
            received += data
    assert received == offered[:taken]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("link", "firmware"), [*((kind, "px4") for kind in LINK_KINDS), ("udpin", "ardupilot")], ids="-".join
)
def test_a_hovering_drone_minds_no_broken_or_absurd_frame(link: str, firmware: str) -> None:
    result = fuzz(link, firmware, 10_000, seed=2)
    assert result.received_share == 1.0
    assert result.known_messages > 2_000
    assert result.drift_m < 0.2
    assert result.mode_kept
    assert result.not_finite == 0


@pytest.mark.slow
@pytest.mark.parametrize(("link", "forges"), [("datagram", False), ("stream", True)])
def test_a_landing_companion_minds_no_stranger_and_sends_nothing_absurd_whatever_comes(
    link: str, *, forges: bool
) -> None:
    result = fuzz_companion(link, "px4", 10_000, seed=2, forges=forges)
    assert result.frames >= 10_000
    assert result.payloads > 500
    assert result.not_finite == 0
    assert result.is_good
    assert forges or result.landed == result.flights == 1
