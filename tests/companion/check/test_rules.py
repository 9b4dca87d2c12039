"""The rules about parameters: what is advised passes, in every spelling, and what was flown passes unchanged."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.check.findings import Finding, Level, advised_values
from companion.check.firmwares import FIRMWARES
from companion.check.rules import SPEED_SHARE_ADVISED, ParameterRule, Spelling, judge, names_of
from companion.config.companion import CompanionConfig
from companion.landing.decisions.feasibility import catching_up_m_s
from link.mavlink.dialect import mavlink

SINK_M_S = 1.2
ARDUPILOT_RULES = FIRMWARES[mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA].rules_for(SINK_M_S)
PX4_RULES = FIRMWARES[mavlink.MAV_AUTOPILOT_PX4].rules_for(SINK_M_S)
ALL = [*PX4_RULES, *ARDUPILOT_RULES]
SPELLED = [(rule, spelling) for rule in ALL for spelling in rule.spellings]
ARDUCOPTER_46 = {
    "ANGLE_MAX": 3000.0,
    "PSC_ANGLE_MAX": 0.0,
    "WPNAV_SPEED": 1000.0,
    "WPNAV_ACCEL": 250.0,
    "WPNAV_SPEED_DN": 150.0,
    "WPNAV_SPEED_UP": 250.0,
    "GUID_TIMEOUT": 3.0,
    "GUID_OPTIONS": 0.0,
    "GPS_DRV_OPTIONS": 0.0,
    "FS_GCS_ENABLE": 0.0,
    "FS_EKF_ACTION": 1.0,
    "DISARM_DELAY": 10.0,
    "PSC_JERK_XY": 5.0,
    "WPNAV_ACCEL_Z": 100.0,
    "PSC_JERK_Z": 5.0,
}
"""Defaults, with which 3, 5 and 8 m/s were flown, and 10.2 m/s was the ceiling."""
ARDUCOPTER_47 = {
    "ATC_ANGLE_MAX": 30.0,
    "PSC_ANGLE_MAX": 0.0,
    "WP_SPD": 10.0,
    "WP_ACC": 2.5,
    "WP_SPD_DN": 1.5,
    "WP_SPD_UP": 2.5,
    **{name: ARDUCOPTER_46[name] for name in list(ARDUCOPTER_46)[6:-3]},
    "PSC_JERK_NE": 5.0,
    "WP_ACC_Z": 1.0,
    "PSC_JERK_D": 5.0,
}
ARDUCOPTER_471 = {
    {"PSC_JERK_NE": "PSC_NE_JERK", "PSC_JERK_D": "PSC_D_JERK"}.get(name, name): value
    for name, value in ARDUCOPTER_47.items()
}
PX4_DEFAULTS = {
    "MPC_XY_VEL_MAX": 12.0,
    "MPC_TILTMAX_AIR": 45.0,
    "MPC_Z_VEL_MAX_DN": 1.5,
    "MPC_Z_VEL_MAX_UP": 3.0,
    "LNDMC_XY_VEL_MAX": 1.5,
    "COM_OF_LOSS_T": 1.0,
    "COM_OBL_RC_ACT": 0.0,
    "NAV_DLL_ACT": 0.0,
    "COM_DISARM_LAND": 2.0,
    "COM_RC_OVERRIDE": 1.0,
}


def names(findings: list[Finding], level: Level) -> set[str]:
    return {one.name for one in findings if one.level is level}


@pytest.mark.parametrize(("rule", "spelling"), SPELLED, ids=[spelling.name for _, spelling in SPELLED])
@given(before=st.floats(0.0, 255.0), speed_m_s=st.floats(0.0, 30.0))
def test_advised_value_passes(rule: ParameterRule, spelling: Spelling, before: float, speed_m_s: float) -> None:
    value = rule.advised(before, speed_m_s) * spelling.per_unit
    (found,) = judge([rule], {spelling.name: value}, speed_m_s)
    assert found.level is Level.PASS


@pytest.mark.parametrize(
    ("rules", "name", "before", "advised"),
    [
        (ARDUPILOT_RULES, "GUID_OPTIONS", 0b110101, 0b101),
        (ARDUPILOT_RULES, "GPS_DRV_OPTIONS", 0b110100, 0b100100),
        (PX4_RULES, "COM_RC_OVERRIDE", 0b1101, 0b1111),
    ],
)
def test_advice_keeps_the_other_bits(
    rules: tuple[ParameterRule, ...], name: str, before: float, advised: float
) -> None:
    assert advised_values(judge(rules, {name: before}, 5.0)) == {name: advised}


@pytest.mark.parametrize("rules", [PX4_RULES, ARDUPILOT_RULES])
def test_parameter_that_is_not_answered_is_a_warning_with_no_value_to_set(rules: tuple[ParameterRule, ...]) -> None:
    findings = judge(rules, {}, 5.0)
    assert len(findings) == len(rules)
    assert all(one.level is Level.WARN and one.set_to is None and one.advice for one in findings)


@pytest.mark.parametrize("defaults", [ARDUCOPTER_46, ARDUCOPTER_47, ARDUCOPTER_471], ids=["4.6", "4.7", "4.7.1"])
def test_arducopters_defaults_serve_8_m_s_and_not_12(defaults: dict[str, float]) -> None:
    assert set(defaults) <= set(names_of(ARDUPILOT_RULES))
    found = judge(ARDUPILOT_RULES, defaults, 8.0)
    assert names(found, Level.FAIL) == set()
    assert "not answered" not in {one.found for one in found}
    tilt, _, speed = list(defaults)[:3]
    assert names(judge(ARDUPILOT_RULES, defaults, 12.0), Level.FAIL) == {tilt, speed}


def test_both_spellings_are_advised_the_same_in_their_own_units() -> None:
    old = {one.name: one.set_to for one in judge(ARDUPILOT_RULES, ARDUCOPTER_46, 12.0)}
    new = {one.name: one.set_to for one in judge(ARDUPILOT_RULES, ARDUCOPTER_47, 12.0)}
    assert (old["ANGLE_MAX"], new["ATC_ANGLE_MAX"]) == (4500.0, 45.0)  # flown at 12 m/s
    assert (old["WPNAV_SPEED"], new["WP_SPD"]) == (1500.0, 15.0)  # flown at 12 m/s
    assert (old["WPNAV_ACCEL"], new["WP_ACC"]) == (500.0, 5.0)  # half of the jerk that is advised


def test_px4s_defaults_serve_10_m_s_and_not_11() -> None:
    assert set(PX4_DEFAULTS) == set(names_of(PX4_RULES))
    assert names(judge(PX4_RULES, PX4_DEFAULTS, 10.0), Level.FAIL) == set()
    assert names(judge(PX4_RULES, PX4_DEFAULTS, 11.0), Level.FAIL) == {"MPC_XY_VEL_MAX"}


@pytest.mark.parametrize(
    ("action", "level"), [(5.0, Level.PASS), (0.0, Level.WARN), (6.0, Level.FAIL), (7.0, Level.FAIL)]
)
def test_stopping_the_motors_when_setpoints_stay_away_is_a_failure(action: float, level: Level) -> None:
    found = {one.name: one.level for one in judge(PX4_RULES, {**PX4_DEFAULTS, "COM_OBL_RC_ACT": action}, 5.0)}
    assert found["COM_OBL_RC_ACT"] is level


@pytest.mark.parametrize(("value", "level"), [(0.0, Level.PASS), (45.0, Level.PASS), (20.0, Level.FAIL)])
def test_tilt_limit_by_position_has_to_be_off_or_large_enough(value: float, level: Level) -> None:
    (found,) = (
        one
        for one in judge(ARDUPILOT_RULES, {**ARDUCOPTER_46, "PSC_ANGLE_MAX": value}, 8.0)
        if one.name == "PSC_ANGLE_MAX"
    )
    assert found.level is level


@pytest.mark.parametrize(
    ("action", "level"), [(0.0, Level.PASS), (2.0, Level.WARN), (5.0, Level.FAIL), (6.0, Level.FAIL)]
)
def test_stopping_the_motors_for_a_lost_ground_station_is_a_failure(action: float, level: Level) -> None:
    found = {one.name: one.level for one in judge(PX4_RULES, {**PX4_DEFAULTS, "NAV_DLL_ACT": action}, 5.0)}
    assert found["NAV_DLL_ACT"] is level


@pytest.mark.parametrize("vehicle_m_s", [0.5, 5.0, 20.0, 35.0])
def test_a_vehicle_that_a_check_advises_for_is_not_refused_in_flight(vehicle_m_s: float) -> None:
    assert SPEED_SHARE_ADVISED * vehicle_m_s > catching_up_m_s(vehicle_m_s, CompanionConfig())


@pytest.mark.parametrize("autopilot_id", list(FIRMWARES))
def test_a_launch_asks_for_twice_the_speed_of_the_vehicle_to_come_home_to_it(autopilot_id: int) -> None:
    rules = FIRMWARES[autopilot_id].rules_for(SINK_M_S, launches=True)
    name, unit = ("MPC_XY_VEL_MAX", 1.0) if autopilot_id == mavlink.MAV_AUTOPILOT_PX4 else ("WPNAV_SPEED", 100.0)
    found = [one for one in judge(rules, {name: 8.5 * unit}, 7.0) if one.name == name]
    assert [one.level for one in found] == [Level.PASS, Level.WARN]
    assert advised_values(found) == {name: 14.0 * unit}
