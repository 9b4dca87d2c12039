"""Reasons are found by their names, and by the words that the panel and the log show."""

import pytest

from companion.core.reasons import Cause, Reason, sentence
from companion.runtime.reasons import reasons
from link.errors import UserError


def told(capsys: pytest.CaptureFixture[str], *words: str) -> list[str]:
    reasons(list(words))
    lines = capsys.readouterr().out.splitlines()
    return [line.partition(":")[0] for line in lines if not line.startswith(" ")]


@pytest.mark.parametrize(
    ("words", "name"),
    [
        (("offset_unknown",), "OFFSET_UNKNOWN"),
        (("Too fast against",), "TOO_FAST_NEAR_PAD"),
        (("too", "fast", "against"), "TOO_FAST_NEAR_PAD"),
        ((f"2026-11-28 abort {sentence(Cause(Reason.HEADING_OFF_COURSE, (31.0,)))} (HEADING)",), "HEADING_OFF_COURSE"),
    ],
    ids=["name", "a part of the sentence", "unquoted", "a whole line of the log"],
)
def test_reason_is_found(words: tuple[str, ...], name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert told(capsys, *words) == [name]


def test_station_that_is_absurdly_far_away_is_refused_in_one_readable_line() -> None:
    assert len(sentence(Cause(Reason.STATION_TOO_FAR, (1.7e308, 100.0)))) < 120
    assert "100.02 m from" in sentence(Cause(Reason.STATION_TOO_FAR, (100.02, 100.0)))


def test_what_to_do_is_told_as_that_and_not_where_there_is_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    reasons(["TOO_FAST_NEAR_PAD", "OPERATOR_HOLDS"])
    lines = capsys.readouterr().out.splitlines()
    assert [line for line in lines if "Look at, or do" in line] == [
        "  Look at, or do: Drive evenly, without hard brakes and turns; fly in less wind."
    ]


def test_several_names_are_told_in_their_order(capsys: pytest.CaptureFixture[str]) -> None:
    assert told(capsys, "CONTACT", "OFFSET_UNKNOWN") == ["CONTACT", "OFFSET_UNKNOWN"]


def test_what_no_reason_says_is_refused_with_the_nearest_name() -> None:
    with pytest.raises(UserError, match="'HARD_CONTAC'; did you mean HARD_CONTACT"):
        reasons(["HARD_CONTAC"])
    with pytest.raises(UserError, match="'no such thing'; `companion reasons` lists them all"):
        reasons(["no", "such", "thing"])


def test_reasons_are_shown_on_a_terminal_that_knows_ascii_only(capsys: pytest.CaptureFixture[str]) -> None:
    reasons()
    assert capsys.readouterr().out.isascii()


@pytest.mark.parametrize("reason", [Reason.SEEN_ELSEWHERE, Reason.ROAD_BELOW])
def test_lever_arm_of_the_wrong_sign_is_among_what_may_put_the_pad_elsewhere(
    reason: Reason, capsys: pytest.CaptureFixture[str]
) -> None:
    reasons([reason.name])
    assert "antenna_to_pad_m" in capsys.readouterr().out


def test_pad_that_is_seen_elsewhere_is_told_with_the_lever_arm() -> None:
    assert "antenna_to_pad_m" in sentence(Cause(Reason.SEEN_ELSEWHERE))


def test_mounting_of_the_camera_is_told_where_sightings_disagree_as_a_mirrored_one_has_them() -> None:
    assert "mounting" in sentence(Cause(Reason.SIGHTINGS_DISAGREE))


def test_sightings_that_move_the_pad_are_told_with_the_mounting(capsys: pytest.CaptureFixture[str]) -> None:
    assert "the camera's mounting" in sentence(Cause(Reason.SIGHTINGS_IMPOSSIBLE))
    reasons([Reason.SIGHTINGS_IMPOSSIBLE.name])
    assert "turned about the vertical" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize("reason", [Reason.STAMPS_AHEAD, Reason.VEHICLE_CLOCK_AHEAD])
def test_fixes_that_come_before_their_stamps_are_told_with_the_autopilots_link(reason: Reason) -> None:
    """Through a link that is full the autopilot's time comes late, before a flight as in it."""
    assert "the autopilot's link is too slow" in reason.value
