"""The ArduCopter driver: what it asks for, in which order, and that nothing disturbs its own take-off."""

import math
from itertools import chain

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.autopilots.driver import NO_AUTOPILOT, AutopilotCommand, AutopilotView, Desire, DriverMemory
from companion.autopilots.limits import acceleration_of_tilt_m_s2
from companion.config.companion import CompanionConfig
from link.mavlink.dialect import mavlink
from link.records import replace
from sim_autopilot.firmware.ardupilot.parameters import OBEYED
from sim_autopilot.firmware.ardupilot.path_control import path_limits
from tests.companion.world import START_NS, STEP_NS

DRIVER = ArduPilotDriver()
LIMITS = tuple(chain(*DRIVER.limit_names))
GROUND = replace(NO_AUTOPILOT, link_up=True, landed=True)
GUIDED = replace(GROUND, in_control=True)
ARMED = replace(GUIDED, armed=True)
CLIMBING = replace(ARMED, landed=False, taking_off=True)
AIRBORNE = replace(ARMED, landed=False)
FLY = Desire(control=True, armed=True, takeoff_height_m=5.5)
ARM, MODE, TAKE_OFF = (
    mavlink.MAV_CMD_COMPONENT_ARM_DISARM,
    mavlink.MAV_CMD_DO_SET_MODE,
    mavlink.MAV_CMD_NAV_TAKEOFF,
)


def _run(
    view: AutopilotView, desire: Desire, duration_s: float, memory: DriverMemory | None = None
) -> tuple[DriverMemory, list[AutopilotCommand]]:
    memory = DriverMemory() if memory is None else memory
    sent: list[AutopilotCommand] = []
    for step in range(round(duration_s * 1e9 / STEP_NS)):
        memory, commands = DRIVER.act(memory, view, desire, START_NS + step * STEP_NS)
        sent += commands
    return memory, sent


@pytest.mark.parametrize(
    ("base_mode", "custom_mode", "is_in_control"),
    [(89, 4, True), (217, 4, True), (217, 9, False), (217, 6, False), (216, 4, False), (81, 0, False)],
)
def test_only_guided_is_control(base_mode: int, custom_mode: int, is_in_control: bool) -> None:
    assert DRIVER.is_in_control(base_mode, custom_mode) is is_in_control


@pytest.mark.parametrize(
    ("view", "expected"),
    [
        (GROUND, (MODE, (1.0, 4.0, 0.0, 0.0, 0.0, 0.0, 0.0))),
        (GUIDED, (ARM, (1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))),
        (ARMED, (TAKE_OFF, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 5.5))),
    ],
)
def test_flight_begins_by_mode_then_arming_then_take_off(view: AutopilotView, expected: tuple[int, object]) -> None:
    _, sent = _run(view, FLY, 0.5)
    assert [(command.command, command.parameters) for command in sent] == [expected]


@pytest.mark.parametrize(
    ("view", "climbs"), [(GROUND, True), (GUIDED, True), (ARMED, True), (CLIMBING, True), (AIRBORNE, False)]
)
def test_setpoints_are_held_back_until_its_own_take_off_is_over(view: AutopilotView, climbs: bool) -> None:
    memory, _ = _run(view, FLY, 0.1)
    assert memory.climbs_by_itself is climbs


def test_take_off_under_way_is_not_told_again() -> None:
    _, sent = _run(CLIMBING, FLY, 12.0)
    assert sent == []


def test_take_off_that_is_not_answered_is_asked_for_each_second_and_one_that_is_has_its_time() -> None:
    _, lost = _run(ARMED, FLY, 3.5)
    assert [command.command for command in lost] == [TAKE_OFF] * 4
    refused, _ = _run(ARMED, FLY, 0.1)
    refused = DRIVER.acknowledged(refused, TAKE_OFF, mavlink.MAV_RESULT_FAILED)
    assert len(_run(ARMED, FLY, 3.5, refused)[1]) == 3
    accepted, _ = _run(ARMED, FLY, 0.1)
    accepted = DRIVER.acknowledged(accepted, TAKE_OFF, mavlink.MAV_RESULT_ACCEPTED)
    assert _run(ARMED, FLY, 4.9, accepted)[1] == []
    assert len(_run(ARMED, FLY, 5.5, accepted)[1]) == 1


def test_setpoints_flow_in_every_phase_after_the_take_off() -> None:
    memory, _ = _run(ARMED, FLY, 0.1)
    memory, _ = _run(AIRBORNE, Desire(), 0.1, memory)
    assert not memory.climbs_by_itself


@given(armed=st.booleans(), in_control=st.booleans(), landed=st.sampled_from([None, True, False]))
def test_nothing_is_asked_for_when_nothing_is_wanted(*, armed: bool, in_control: bool, landed: bool | None) -> None:
    _, sent = _run(replace(GROUND, armed=armed, in_control=in_control, landed=landed), Desire(), 2.0)
    assert sent == []


def test_release_leaves_guided_for_a_hover_that_needs_no_sticks() -> None:
    _, sent = _run(AIRBORNE, Desire(release=True), 0.5)
    assert [command.parameters[:2] for command in sent] == [(1.0, 17.0)]


def test_disarm_is_forced_after_a_refusal_with_the_evidence_only() -> None:
    memory, sent = _run(AIRBORNE, Desire(armed=False, force_disarm=True), 0.1)
    memory = DRIVER.acknowledged(memory, ARM, mavlink.MAV_RESULT_FAILED)
    assert [command.parameters[:2] for command in sent] == [(0.0, 0.0)]
    _, without = _run(AIRBORNE, Desire(armed=False), 1.0, memory)
    assert all(command.parameters[1] == 0.0 for command in without)
    _, forced = _run(AIRBORNE, Desire(armed=False, force_disarm=True), 0.1, memory)
    assert [command.parameters[:2] for command in forced] == [(0.0, 21196.0)]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("Arm: Need Position Estimate", "Need Position Estimate"),
        ("PreArm: Gyros inconsistent", "Gyros inconsistent"),
        ("Arm: AHRS: waiting for home", "AHRS: waiting for home"),
        ("EKF3 IMU0 is using GPS", None),
    ],
)
def test_refused_arming_is_read_from_its_text(text: str, reason: str | None) -> None:
    message = mavlink.MAVLink_statustext_message(mavlink.MAV_SEVERITY_CRITICAL, text.encode())
    assert DRIVER.refusal(mavlink.MAVLink("").decode(bytearray(message.pack(mavlink.MAVLink("", 1, 1))))) == reason


@pytest.mark.parametrize(
    "parameters",
    [
        {
            "WPNAV_SPEED": 700.0,
            "WPNAV_SPEED_UP": 210.0,
            "WPNAV_SPEED_DN": 110.0,
            "ANGLE_MAX": 2200.0,
            "PSC_JERK_XY": 5.0,
        },
        {"WP_SPD": 7.0, "WP_SPD_UP": 2.1, "WP_SPD_DN": 1.1, "ATC_ANGLE_MAX": 22.0, "PSC_JERK_NE": 5.0},
        {"WP_SPD": 7.0, "WP_SPD_UP": 2.1, "WP_SPD_DN": 1.1, "ATC_ANGLE_MAX": 22.0, "PSC_NE_JERK": 5.0},
    ],
)
def test_limits_are_read_by_the_names_of_old_and_new_releases(parameters: dict[str, float]) -> None:
    cut = DRIVER.limits(CompanionConfig().limits.flight_limits(), parameters)
    assert (cut.speed_max_m_s, cut.climb_max_m_s, cut.descent_max_m_s) == pytest.approx((7.0, 2.1, 1.1))
    assert cut.jerk_max_m_s3 == pytest.approx(5.0)
    assert cut.tilt_acceleration_m_s2 == pytest.approx(acceleration_of_tilt_m_s2(22.0))


@pytest.mark.parametrize("name", ["PSC_JERK_Z", "PSC_JERK_D"])
def test_vertical_jerk_is_bounded_by_a_parameter_of_its_own(name: str) -> None:
    wanted = CompanionConfig().limits.flight_limits()
    cut = DRIVER.limits(wanted, {name: 7.0})
    assert cut.vertical_jerk_max_m_s3 == pytest.approx(7.0)
    assert cut.jerk_max_m_s3 == DRIVER.limits(wanted, {}).jerk_max_m_s3


@pytest.mark.parametrize(("acceleration_m_s2", "most_m_s3"), [(2.5, 10.8), (3.5, 12.8)])
def test_jerk_is_no_more_than_the_attitude_controller_allows(acceleration_m_s2: float, most_m_s3: float) -> None:
    """As AC_PosControl: half the root of the acceleration by that of the tilt, 1100 degrees/s^2 by default."""
    limits = CompanionConfig().limits.flight_limits()
    set_so, unlimited = (
        DRIVER.limits(limits, {"PSC_JERK_XY": jerk_m_s3, "WPNAV_ACCEL": 100.0 * acceleration_m_s2}).jerk_max_m_s3
        for jerk_m_s3 in (most_m_s3, 20.0)
    )
    assert set_so == pytest.approx(unlimited, rel=0.01)


@pytest.mark.parametrize(
    ("told", "most_m_s3"),
    [
        ({"ATC_ACCEL_R_MAX": 20000.0}, 6.5),  # as for propellers of 30 inches
        ({"ATC_ACC_P_MAX": 200.0}, 6.5),
        ({"ATC_RATE_P_MAX": 60.0}, 10.3),
        ({"ATC_RATE_R_MAX": 0.0, "ATC_ACCEL_P_MAX": 0.0}, 15.3),  # none
        ({"ATC_RATE_R_MAX": 1.0}, 1.0),
    ],
)
def test_jerk_is_no_more_than_slow_turns_of_the_body_leave(told: dict[str, float], most_m_s3: float) -> None:
    shaping = DRIVER.shaping({"PSC_JERK_XY": 20.0, "WPNAV_ACCEL": 500.0} | told)
    assert shaping is not None
    assert shaping.jerk_m_s3 == pytest.approx(most_m_s3, abs=0.05)


@pytest.mark.parametrize(
    "told",
    [{}, {"ATC_ACCEL_R_MAX": 20000.0}, {"ATC_ACCEL_P_MAX": 50000.0}, {"ATC_RATE_R_MAX": 60.0, "ATC_RATE_P_MAX": 90.0}],
)
def test_path_of_the_stand_in_keeps_to_the_jerk_that_is_planned_with(told: dict[str, float]) -> None:
    values = {one.name: one.default for one in OBEYED} | {"PSC_JERK_XY": 20.0, "WPNAV_ACCEL": 500.0} | told
    shaping = DRIVER.shaping(values)
    assert shaping is not None
    assert path_limits(values).jerk_m_s3 == pytest.approx(shaping.jerk_m_s3)


@pytest.mark.parametrize("told", [0.11, 0.3, 0.5])
def test_jerk_and_acceleration_count_as_no_less_than_the_firmware_states(told: float) -> None:
    """A path by a jerk of 0.1 m/s^3 ends a kilometre below the ground."""
    jerks = dict.fromkeys(("PSC_JERK_XY", "PSC_JERK_Z"), told)
    shaping = DRIVER.shaping(jerks | dict.fromkeys(("WPNAV_ACCEL", "WPNAV_ACCEL_Z"), 100.0 * told))
    assert shaping is not None
    assert (shaping.jerk_m_s3, shaping.vertical_jerk_m_s3) == (1.0, 1.0)
    assert (shaping.acceleration_m_s2, shaping.vertical_acceleration_m_s2) == (0.5, 0.5)


@pytest.mark.parametrize(
    ("parameters", "tilt_deg"),
    [
        ({"ANGLE_MAX": 4500.0, "PSC_ANGLE_MAX": 25.0}, 25.0),
        ({"ANGLE_MAX": 2500.0, "PSC_ANGLE_MAX": 40.0}, 25.0),
        ({"ANGLE_MAX": 4000.0, "PSC_ANGLE_MAX": 0.0}, 40.0),  # 0, the default, is none
        ({"ANGLE_MAX": 20.0}, 10.0),  # so little nobody means
        ({"PSC_ANGLE_MAX": 45.0}, 30.0),  # the general one is not known yet
    ],
)
def test_smaller_of_the_two_tilt_limits_counts(parameters: dict[str, float], tilt_deg: float) -> None:
    cut = DRIVER.limits(CompanionConfig().limits.flight_limits(), parameters)
    assert cut.tilt_acceleration_m_s2 == pytest.approx(acceleration_of_tilt_m_s2(tilt_deg))


@given(st.dictionaries(st.sampled_from(LIMITS), st.floats()))
def test_no_parameter_whatever_takes_a_limit_away(parameters: dict[str, float]) -> None:
    wanted = CompanionConfig().limits.flight_limits()
    cut = DRIVER.limits(wanted, parameters)
    assert 0.0 < cut.speed_max_m_s <= wanted.speed_max_m_s
    assert 0.0 < cut.climb_max_m_s <= wanted.climb_max_m_s
    assert 0.0 < cut.descent_max_m_s <= wanted.descent_max_m_s
    assert cut.acceleration_max_m_s2 == wanted.acceleration_max_m_s2
    assert 0.0 < cut.tilt_acceleration_m_s2 < math.inf


@pytest.mark.parametrize(
    "parameters",
    [
        {"PSC_POSXY_P": 1.3, "PSC_VELXY_P": 3.1, "PSC_VELXY_I": 0.7},
        {"PSC_NE_POS_P": 1.3, "PSC_NE_VEL_P": 3.1, "PSC_NE_VEL_I": 0.7},
    ],
)
def test_gains_are_read_by_the_names_of_old_and_new_releases(parameters: dict[str, float]) -> None:
    cascade = DRIVER.cascade(parameters)
    assert (cascade.position_per_s, cascade.velocity_per_s, cascade.integral_per_s2) == (1.3, 3.1, 0.7)
