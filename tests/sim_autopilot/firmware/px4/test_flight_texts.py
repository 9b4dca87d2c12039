"""What PX4 says to ground stations as a flight goes on, in its words."""

import pytest

from link.mavlink.dialect import Message, event_id, mavlink
from tests.sim_autopilot.pilot import Pilot, arm, px4, set_mode

INFO = 6
TAKE_OFF = (4, 2)


def station() -> Message:
    return mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3)


def watched() -> Pilot:
    pilot = Pilot()
    pilot.step(station())
    return pilot


def texts(pilot: Pilot) -> list[str]:
    """Whole texts, without the tab by which stations that show events leave them out."""
    said = pilot.all("STATUSTEXT")
    joined: list[str] = []
    for piece in said:
        if piece.chunk_seq == 0:
            joined.append(piece.text)
        else:
            joined[-1] += piece.text
    assert all(text.endswith("\t") for text in joined), joined
    return [text.rstrip("\t") for text in joined]


def flown_by_mode(pilot: Pilot) -> None:
    pilot.step(set_mode(*TAKE_OFF), arm())
    pilot.run_until(lambda: pilot.custom_mode() == 0x03040000, 20.0)


def test_a_companion_without_a_ground_station_gets_the_same_as_events_and_no_text() -> None:
    pilot = Pilot(px4())
    flown_by_mode(pilot)
    assert not pilot.all("STATUSTEXT")
    names = (
        "commander_armed_by",
        "navigator_takeoff_default_alt",
        "logger_open_file_time",
        "commander_takeoff_detected",
    )
    assert [event.id for event in pilot.all("EVENT")] == [event_id(name) for name in names]


def companion() -> Message:
    return mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_ONBOARD_CONTROLLER, 8, 0, 0, 4, 3)


@pytest.mark.slow
def test_a_companion_that_falls_silent_is_told_of_and_changes_nothing() -> None:
    pilot = watched()
    flown_by_mode(pilot)
    pilot.step(companion())
    pilot.received.clear()
    mode = pilot.custom_mode()
    pilot.run(4.9, lambda _t_s: station())
    assert texts(pilot) == []
    pilot.run(0.2, lambda _t_s: station())
    assert texts(pilot) == ["Connection to mission computer lost"]
    assert pilot.last("EVENT").id == event_id("commander_mission_comp_lost")
    pilot.step(companion())
    assert texts(pilot)[1:] == ["Onboard controller regained"]
    assert pilot.custom_mode() == mode
