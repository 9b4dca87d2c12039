"""What client programs ask of PX4 besides flying: calibration, versions and metadata, and the end of a mission."""

import json
import lzma
import struct
from math import nan

import pytest

from link.ftp.handlers import checksum
from link.mavlink.dialect import event_id, mavlink
from sim_autopilot.core.modes import Mode
from sim_autopilot.ground_station.px4.health_bits import ARMING_SUMMARY, HEALTH_SUMMARY, MODE_STATES
from tests.sim_autopilot.pilot import HOLD, Pilot, arm, command, setpoint
from tests.sim_autopilot.pilot_files import PilotFiles
from tests.sim_autopilot.planner import item, upload

pytestmark = pytest.mark.slow

REJECTED, DENIED, UNSUPPORTED = 1, 2, 3
STATION = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3)
CALIBRATE = mavlink.MAV_CMD_PREFLIGHT_CALIBRATION


def texts(pilot: Pilot) -> list[str]:
    return [text.text for text in pilot.all("STATUSTEXT")]


def calibration(pilot: Pilot) -> list[str]:
    """Its texts, without those about the ground station, which falls silent meanwhile."""
    return [text for text in texts(pilot) if text.startswith("[cal]")]


def test_a_calibration_for_which_nobody_turns_the_drone_fails() -> None:
    pilot = Pilot()
    pilot.step(STATION)
    pilot.step(command(CALIBRATE, 0.0, 0.0, 0.0, 0.0, 1.0))
    pilot.run(91.0)
    assert calibration(pilot)[-1] == "[cal] calibration failed: accel"


def test_nothing_is_calibrated_while_armed() -> None:
    pilot = Pilot()
    pilot.step(arm())
    assert pilot.acknowledged(command(CALIBRATE, 1.0)) == [REJECTED]


def test_every_event_that_is_sent_is_described_in_the_metadata() -> None:
    pilot = Pilot()
    files = PilotFiles(pilot)
    general = json.loads(lzma.decompress(files.read(b"etc/extras/component_general.json.xz")))
    (listed,) = (entry for entry in general["metadataTypes"] if entry["type"] == 4)
    file = files.read(listed["uri"].removeprefix("mftp://").encode())
    assert checksum(file) == listed["fileCrc"]
    events = json.loads(lzma.decompress(file))["components"]["1"]["event_groups"]["default"]["events"]
    pilot.step(command(mavlink.MAV_CMD_NAV_TAKEOFF, *(nan,) * 7))
    pilot.step(arm())
    pilot.run(8.0)
    pilot.acknowledged(command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 0.0))
    pilot.acknowledged(command(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH))
    pilot.run_until(lambda: not pilot.is_armed(), 60.0)
    sent = [event.id for event in pilot.all("EVENT")]
    names = {events[str(one & 0xFFFFFF)]["name"] for one in sent}
    assert {"commander_armed_by", "logger_open_file_time", "commander_takeoff_detected", "vrtl_return_at"} <= names
    said = events[str(sent[0] & 0xFFFFFF)]
    assert (said["message"], said["arguments"][0]["type"]) == ("Armed by {1}", "px4::arm_disarm_reason_t")


def arming_bits(pilot: Pilot) -> tuple[int, int]:
    """The modes in which it says that it arms, and those in which it flies."""
    pilot.received.clear()
    assert pilot.acknowledged(command(mavlink.MAV_CMD_RUN_PREARM_CHECKS)) == [0]
    summary, health = pilot.all("EVENT")
    assert [event.id for event in (summary, health)] == [event_id(ARMING_SUMMARY), event_id(HEALTH_SUMMARY)]
    _, _, _, can_arm, can_run = struct.unpack_from("<BIIII", bytes(summary.arguments))
    return can_arm, can_run


def bits(*modes: Mode) -> int:
    return sum(1 << MODE_STATES[mode][0] for mode in modes)


def test_the_report_on_arming_says_in_which_modes_it_arms_and_flies() -> None:
    pilot = Pilot()
    can_arm, can_run = arming_bits(pilot)
    assert can_arm == bits(Mode.HOLD, Mode.TAKEOFF)
    assert can_run & bits(Mode.RTL, Mode.LAND, Mode.HOLD) == bits(Mode.RTL, Mode.LAND, Mode.HOLD)
    assert not can_run & bits(Mode.OFFBOARD, Mode.POSITION, Mode.MISSION)
    upload(pilot, [item(0, 22, (0.0, 0.0, 5.0))])
    pilot.run(0.5, lambda _t: setpoint((0.0, 0.0, -3.0)))
    pilot.step(mavlink.MAVLink_manual_control_message(1, 0, 0, 500, 0, 0))
    can_arm, can_run = arming_bits(pilot)
    assert can_arm & can_run & bits(Mode.OFFBOARD, Mode.POSITION, Mode.MISSION)
    assert not can_arm & bits(Mode.RTL, Mode.LAND)


def test_the_metadata_name_every_mode_of_the_report_by_its_number_in_the_heartbeat() -> None:
    pilot = Pilot()
    described = json.loads(lzma.decompress(PilotFiles(pilot).read(b"etc/extras/all_events.json.xz")))
    component = described["components"]["1"]
    assert component["supported_protocols"] == ["health_and_arming_check"]
    groups = component["navigation_mode_groups"]["groups"]
    assert groups["4"] == [HOLD]
    entries = component["enums"]["navigation_mode_group_t"]["entries"]
    assert {str(1 << int(number)) for number in groups} == set(entries)


def test_a_mission_that_ends_in_the_air_is_followed_by_hold() -> None:
    pilot = Pilot()
    assert upload(pilot, [item(0, 22, (0.0, 0.0, 5.0)), item(1, 16, (0.0, 8.0, 5.0))]) == 0
    assert pilot.acknowledged(command(mavlink.MAV_CMD_MISSION_START)) == [0]
    pilot.run_until(lambda: pilot.custom_mode() == HOLD, 60.0)
    assert pilot.is_armed()
    pilot.run(5.0)
    assert pilot.position[1] == pytest.approx(8.0, abs=1.5)
    assert pilot.last("MISSION_CURRENT").mission_state == mavlink.MISSION_STATE_COMPLETE


def test_its_simulation_cannot_be_rebooted_and_has_no_fence_switch() -> None:
    pilot = Pilot()
    assert pilot.acknowledged(command(mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, 1.0)) == [DENIED]
    assert pilot.acknowledged(command(mavlink.MAV_CMD_DO_FENCE_ENABLE, 1.0)) == [UNSUPPORTED]
