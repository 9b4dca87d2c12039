"""The lines of the check: everything in order passes, and each thing amiss is told by its own line."""

from pathlib import Path
from typing import Any

import pytest

from companion.autopilots.choice import driver_for
from companion.check.assessment import MOTION, assess
from companion.check.command import print_table
from companion.check.findings import Level, advised_values, is_ready
from companion.check.observation import AutopilotFacts
from companion.config.companion import CompanionConfig
from link.errors import UserError
from link.mavlink.dialect import mavlink
from link.program.toml_config import validate
from link.records import replace
from link.zenoh.command_line import ZenohArguments
from tests.companion.check.test_rules import ARDUCOPTER_46, PX4_DEFAULTS
from tests.companion.check.test_vehicle_assessment import VEHICLE
from tests.companion.world import configured

GOOD = AutopilotFacts(
    autopilot_id=mavlink.MAV_AUTOPILOT_PX4,
    vehicle_type=mavlink.MAV_TYPE_QUADROTOR,
    version=(1, 16, 0),
    can_arm=True,
    has_origin=True,
    has_position=True,
    geoid_height_m=-0.4,
    round_trips=20,
    utc_known=True,
    utc_ahead_s=-0.004,
    clock_std_s=0.001,
    rates_hz=dict.fromkeys(MOTION, 50.0),
    latency_s=0.01,
    battery_share=0.9,
    has_range_finder=True,
    range_at_rest_m=0.2,
    parameters={
        **PX4_DEFAULTS,
        "MPC_Z_VEL_MAX_DN": 2.0,
        "LNDMC_XY_VEL_MAX": 12.0,
        "COM_OBL_RC_ACT": 5.0,
        "COM_RC_OVERRIDE": 3.0,
    },
)
CONFIG = CompanionConfig()


def test_everything_in_order_is_all_pass() -> None:
    findings = assess(GOOD, VEHICLE, 10.0, CONFIG)
    assert {one.level for one in findings} == {Level.PASS}
    assert is_ready(findings)


@pytest.mark.parametrize(
    ("changed", "line", "level"),
    [
        ({"autopilot_id": mavlink.MAV_AUTOPILOT_GENERIC}, "firmware", Level.FAIL),
        ({"version": (1, 12, 3)}, "firmware", Level.WARN),
        ({"version": None}, "firmware", Level.WARN),
        ({"is_id_shared": True}, "system id", Level.FAIL),
        ({"can_arm": False}, "arming checks", Level.WARN),
        ({"has_origin": False}, "estimator", Level.FAIL),
        ({"has_position": False}, "estimator", Level.FAIL),
        ({"geoid_height_m": None}, "heights", Level.FAIL),
        ({"round_trips": 0}, "clock", Level.FAIL),
        ({"utc_known": False}, "clock", Level.FAIL),
        ({"clock_std_s": 0.1}, "clock", Level.WARN),
        ({"utc_ahead_s": -0.11}, "time of day", Level.WARN),
        ({"utc_ahead_s": 4.2}, "time of day", Level.WARN),
        ({"rates_hz": {}}, MOTION[0], Level.FAIL),
        ({"rates_hz": dict.fromkeys(MOTION, 20.0)}, MOTION[1], Level.WARN),
        ({"latency_s": 0.3}, "latency", Level.WARN),
        ({"battery_share": 0.4}, "battery", Level.WARN),
        ({"battery_share": 0.2}, "battery", Level.FAIL),
        ({"battery_share": None}, "battery", Level.WARN),
        ({"has_range_finder": False}, "range finder", Level.WARN),
        ({"range_at_rest_m": 0.62}, "range at rest", Level.WARN),
    ],
)
def test_autopilot_amiss_is_told(changed: dict[str, Any], line: str, level: Level) -> None:
    by_name = {one.name: one for one in assess(replace(GOOD, **changed), VEHICLE, 10.0, CONFIG)}
    assert by_name[line].level is level
    assert by_name[line].advice


def test_time_of_day_is_told_with_what_it_does_to_the_vehicles_place() -> None:
    found = {one.name: one for one in assess(replace(GOOD, utc_ahead_s=-0.11), VEHICLE, 10.0, CONFIG)}["time of day"]
    assert found.found == "0.11 s behind this computer's"
    assert found.reason.startswith("at 10 m/s the vehicle is placed 1.1 m off")
    assert "time of day" not in {one.name for one in assess(replace(GOOD, utc_ahead_s=None), VEHICLE, 10.0, CONFIG)}


def test_position_that_comes_before_it_was_taken_is_told_unless_the_clocks_are_no_better_known() -> None:
    early, unsure = (
        {one.name: one for one in assess(replace(GOOD, latency_s=-0.002, clock_std_s=std_s), VEHICLE, 10.0, CONFIG)}
        for std_s in (0.0002, 0.0015)
    )
    assert early["latency"].level is Level.WARN
    assert early["latency"].found == "-2 ms: positions come before they are taken"
    assert (unsure["latency"].level, unsure["latency"].found) == (Level.PASS, "0 ms")


def test_position_that_is_not_sent_yet_is_waited_for_and_a_silent_link_is_mended() -> None:
    position, attitude = MOTION
    waits, silent = (
        {one.name: one for one in assess(replace(GOOD, rates_hz=rates_hz), VEHICLE, 10.0, CONFIG)}[position]
        for rates_hz in ({position: 0.0, attitude: 50.0}, {position: 0.0, attitude: 0.0})
    )
    assert waits.level is silent.level is Level.FAIL
    assert "GNSS fix" in waits.advice
    assert "baud rate" in silent.advice


@pytest.mark.parametrize("vehicle_type", range(0, 50, 3))
def test_what_the_companion_would_not_fly_fails_by_its_type(vehicle_type: int) -> None:
    by_name = {one.name: one for one in assess(replace(GOOD, vehicle_type=vehicle_type), VEHICLE, 10.0, CONFIG)}
    try:
        driver_for(GOOD.autopilot_id, vehicle_type)
    except UserError:
        assert by_name["firmware"].level is Level.FAIL
        assert f"MAV_TYPE {vehicle_type}" in by_name["firmware"].found
    else:
        assert by_name["firmware"].level is Level.PASS


def test_silent_vehicle_fails_where_it_was_said_where_it_is_met() -> None:
    silent = replace(VEHICLE, rate_hz=0.0)
    for is_expected in (False, True):
        findings = assess(GOOD, silent, 10.0, CONFIG, expects_vehicle=is_expected)
        assert is_ready(findings) is not is_expected


@pytest.mark.parametrize(
    ("given", "are_given"),
    [
        ({}, False),
        ({"mode": "client"}, False),
        ({"connect": ["tcp/127.0.0.1:1"]}, True),
        ({"listen": ["tcp/127.0.0.1:1"]}, True),
        ({"zenoh_config": Path("z.json5")}, True),
        ({"multicast": True}, True),
    ],
)
def test_endpoints_say_where_a_vehicle_is_met(given: dict[str, Any], *, are_given: bool) -> None:
    assert ZenohArguments(**given).are_given is are_given


def test_advised_values_make_an_arducopter_pass() -> None:
    seen = replace(GOOD, autopilot_id=mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, version=(4, 6, 0), parameters=ARDUCOPTER_46)
    before = assess(seen, VEHICLE, 12.0, CONFIG)
    assert not is_ready(before)
    after = assess(replace(seen, parameters={**ARDUCOPTER_46, **advised_values(before)}), VEHICLE, 12.0, CONFIG)
    assert {one.level for one in after} == {Level.PASS}


@pytest.mark.parametrize(
    ("table", "line", "level"),
    [
        ({"autopilot": {"kind": "ardupilot"}}, "firmware", Level.FAIL),
        ({"descent": {"sink": {"rate_max_m_s": 2.0}}}, "MPC_Z_VEL_MAX_DN", Level.WARN),
        ({"limits": {"battery_min_share": 0.85}}, "battery", Level.FAIL),
        ({"limits": {"battery_min_share": 0.7}}, "battery", Level.WARN),
        ({"abort": {"position_std_max_m": 0.04}}, "vehicle accuracy", Level.FAIL),
        ({"abort": {"fix_age_max_s": 0.15}}, "vehicle age", Level.FAIL),
    ],
)
def test_what_passes_with_the_defaults_is_judged_by_the_configuration_given(
    table: dict[str, Any], line: str, level: Level
) -> None:
    config = validate(CompanionConfig, table, source="test")
    by_name = {one.name: one for one in assess(GOOD, VEHICLE, 10.0, config)}
    assert by_name[line].level is level
    assert by_name[line].advice


def test_geoid_of_the_configuration_is_as_good_as_one_that_is_told() -> None:
    untold = replace(GOOD, geoid_height_m=None)
    for facts, config in ((untold, configured({"autopilot": {"geoid_height_m": 47.3}}, CONFIG)), (GOOD, CONFIG)):
        by_name = {one.name: one for one in assess(facts, VEHICLE, 10.0, config)}
        assert by_name["heights"].level is Level.PASS


def test_table_of_a_narrow_terminal_cuts_no_name(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    print_table(assess(replace(GOOD, range_at_rest_m=0.62), VEHICLE, 5.0, CONFIG), 5.0)
    cells = "".join(line.rstrip().rpartition("  ")[2] for line in capsys.readouterr().out.splitlines())
    assert "touchdown.range_finder.height_m" in cells
