"""What the status says of a place that nothing verifies; nothing where sightings and receivers check each other."""

import pytest

from companion.config.companion import CompanionConfig
from companion.config.integrity import IntegrityConfig, ReceiverFrames
from companion.integrity.vehicle_data import Unverified, unverified
from companion.situation.situation import Situation
from companion.vehicle.pad import FrameOffset, PadMounting
from link.records import replace
from tests.companion.facts import CONFIG, changed, pad_at, situation

ONE = CompanionConfig(integrity=IntegrityConfig(receiver_frames=ReceiverFrames.ONE))
LEVER = Unverified.LEVER.value
LATE_AT_5_M_S = Unverified.STAMPS.value.format(late_s=0.1, off_m=0.5)


def facts(*, is_seen: bool, has_one_frame: bool = True, is_coarse: bool = False) -> Situation:
    offset = FrameOffset(distance_m=0.0, std_m=0.01, is_confirmed=is_seen)
    pad = replace(pad_at((3.0, -4.0, 0.0)), frame_offset=offset, has_one_frame=has_one_frame, is_coarse=is_coarse)
    return situation(pad=pad)


def test_vehicle_that_nothing_sees_is_where_its_stamps_say() -> None:
    assert unverified(facts(is_seen=False), ONE) == (LATE_AT_5_M_S, LEVER)
    assert unverified(facts(is_seen=False), CONFIG) == (LATE_AT_5_M_S, LEVER, Unverified.FRAMES.value)


@pytest.mark.parametrize(("has_one_frame", "is_coarse"), [(False, False), (True, True)])
def test_pad_that_sightings_alone_place_is_where_they_say(*, has_one_frame: bool, is_coarse: bool) -> None:
    seen = facts(is_seen=True, has_one_frame=has_one_frame, is_coarse=is_coarse)
    assert unverified(seen, CONFIG) == (Unverified.PLACE.value,)


def test_heading_that_no_course_has_shown_is_believed_where_the_pad_is_beside_the_antenna() -> None:
    arm = PadMounting(arm_m=1.3)
    unseen = facts(is_seen=False)
    assert unseen.pad is not None
    parked = changed(replace(unseen, pad=replace(unseen.pad, mounting=arm)), has_shown_heading=False)
    heading = Unverified.HEADING.value.format(off_deg=12.0, off_m=0.27)  # a chord: 2 * 1.3 m * sin(6 degrees)
    assert unverified(parked, ONE) == (LATE_AT_5_M_S, LEVER, heading)
    assert unverified(changed(parked, has_shown_heading=True), ONE) == (LATE_AT_5_M_S, LEVER)
    assert unverified(changed(unseen, has_shown_heading=False), ONE) == (LATE_AT_5_M_S, LEVER)
    seen = replace(parked, pad=replace(unseen.pad, mounting=arm, frame_offset=FrameOffset(distance_m=0.0)))
    assert unverified(seen, ONE) == ()


def test_sightings_and_receivers_of_one_frame_verify_each_other() -> None:
    assert unverified(facts(is_seen=True), CONFIG) == ()


def test_of_a_pad_that_nobody_knows_nothing_is_said() -> None:
    assert unverified(replace(situation(), pad=None), CONFIG) == ()
    assert unverified(facts(is_seen=False, has_one_frame=False), CONFIG) == ()
    assert unverified(facts(is_seen=False, is_coarse=True), CONFIG) == ()
