"""What PX4 says to ground stations as a flight goes on, in its words."""

from link.mavlink.dialect import Message, mavlink
from link.mavlink.event_ids import event_id
from tests.sim_autopilot.pilot import Pilot, arm, command, px4, set_mode, setpoint

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


def test_arming_the_log_take_off_and_landing_are_told_as_px4_does() -> None:
    pilot = watched()
    flown_by_mode(pilot)
    pilot.step(command(mavlink.MAV_CMD_NAV_LAND))
    pilot.run_until(lambda: not pilot.is_armed(), 30.0, lambda _t_s: station())
    assert texts(pilot) == [
        "Armed by external command",
        "Using default takeoff altitude: 2.5 m",
        "[logger] ./log/2026-11-18/11_06_40.ulg",
        "Takeoff detected",
        "Landing at current position",
        "Landing detected",
        "Disarmed by landing",
    ]
    assert {text.severity for text in pilot.all("STATUSTEXT")} == {INFO}


def test_a_return_tells_its_height_and_when_it_lands() -> None:
    pilot = watched()
    pilot.take_off(5.0)
    pilot.run(12.0, lambda _t_s: setpoint((15.0, 0.0, -5.0)))
    pilot.received.clear()
    pilot.step(set_mode(4, 5))
    pilot.run_until(lambda: not pilot.is_armed(), 90.0)
    assert texts(pilot)[:2] == ["RTL: start return at 120 m (30 m above destination)", "RTL: land at destination"]


def test_an_idle_drone_tells_that_it_disarms_by_itself_and_a_commanded_one_that_it_was_told() -> None:
    pilot = watched()
    pilot.step(arm())
    pilot.step(arm(armed=False))
    pilot.step(arm())
    pilot.run_until(lambda: not pilot.is_armed(), 20.0)
    ends = [text for text in texts(pilot) if text.startswith("Disarmed")]
    assert ends == ["Disarmed by external command", "Disarmed by auto preflight disarming"]


def test_a_ground_station_that_falls_silent_and_comes_back_is_told() -> None:
    pilot = watched()
    pilot.run(10.5)
    pilot.step(station())
    assert texts(pilot) == ["Connection to ground station lost", "GCS connection regained"]


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


def test_a_mission_start_without_a_mission_is_denied_with_its_reason() -> None:
    pilot = watched()
    pilot.step(command(mavlink.MAV_CMD_MISSION_START))
    assert texts(pilot) == ["Mission start denied! No valid mission"]


def companion() -> Message:
    return mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_ONBOARD_CONTROLLER, 8, 0, 0, 4, 3)


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
