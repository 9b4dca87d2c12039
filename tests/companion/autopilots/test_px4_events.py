"""PX4's events in words."""

import pytest

from companion.autopilots.px4_events import refusal_of
from link.mavlink.dialect import DRAFT_MESSAGES, Message, event_id

CRITICAL, INFORMATION = 0x62, 0x66  # internal level in the upper half
OFFBOARD, POSITION = 1 << 14, 1 << 2


def _event(number: int, levels: int, modes: int = 0) -> Message:
    return DRAFT_MESSAGES[410](0, 0, number, 1000, 7, levels, [*modes.to_bytes(4, "little"), *[0] * 36])


def test_ids_are_the_published_hash_of_the_name() -> None:
    # The 32-bit FNV-1a test vectors of RFC 9923 for "a" and "foobar", cut to 24 bits.
    assert event_id("a") == 1 << 24 | 0x0C292C
    assert event_id("foobar") == 1 << 24 | 0x9CF968


@pytest.mark.parametrize(
    ("modes", "levels", "told"),
    [
        (OFFBOARD | POSITION, CRITICAL, "estimator hor pos not stable"),
        (POSITION, CRITICAL, None),
        (OFFBOARD, INFORMATION, None),
    ],
)
def test_check_is_told_in_words_when_it_bars_offboard(modes: int, levels: int, told: str | None) -> None:
    assert refusal_of(_event(event_id("check_estimator_hor_pos_not_stable"), levels, modes)) == told


def test_denial_is_told_whatever_the_mode() -> None:
    event = _event(event_id("commander_arm_denied_resolve_failures"), CRITICAL)
    assert refusal_of(event) == "arm denied resolve failures"


@pytest.mark.parametrize(("levels", "told"), [(CRITICAL, "event 0x01abcdef"), (INFORMATION, None)])
def test_unknown_event_is_told_by_its_id_when_it_is_an_error(levels: int, told: str | None) -> None:
    assert refusal_of(_event(0x01ABCDEF, levels)) == told
