"""The PX4 driver: what it asks for, when, and how often."""

import math
from itertools import chain

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.autopilots.driver import NO_AUTOPILOT, AutopilotCommand, AutopilotView, Desire, DriverMemory
from companion.autopilots.limits import acceleration_of_tilt_m_s2
from companion.autopilots.px4 import Px4Driver
from companion.config.companion import CompanionConfig
from link.mavlink.dialect import mavlink
from link.records import replace
from tests.companion.world import START_NS, STEP_NS

DRIVER = Px4Driver()
LIMITS = tuple(chain(*DRIVER.limit_names))
GROUND = replace(NO_AUTOPILOT, link_up=True)
ARMED = replace(GROUND, armed=True, in_control=True)
DISARM, SET_MODE = mavlink.MAV_CMD_COMPONENT_ARM_DISARM, mavlink.MAV_CMD_DO_SET_MODE
REJECTED, ACCEPTED = mavlink.MAV_RESULT_TEMPORARILY_REJECTED, mavlink.MAV_RESULT_ACCEPTED
OFF = Desire(armed=False, force_disarm=True)


def _run(
    view: AutopilotView, desire: Desire, duration_s: float, memory: DriverMemory | None = None
) -> tuple[DriverMemory, list[tuple[float, AutopilotCommand]]]:
    memory = DriverMemory() if memory is None else memory
    sent = []
    for step in range(round(duration_s * 1e9 / STEP_NS)):
        memory, commands = DRIVER.act(memory, view, desire, START_NS + step * STEP_NS)
        sent += [(step * STEP_NS * 1e-9, command) for command in commands]
    return memory, sent


@pytest.mark.parametrize(
    ("base_mode", "custom_mode", "is_in_control"),
    [
        (0x91, 0x0006_0000, True),
        (0x11, 0x0006_0000, True),
        (0x91, 0x0304_0000, False),
        (0x91, 0x0003_0000, False),
        (0x90, 0x0006_0000, False),
        (0x91, 0, False),
    ],
)
def test_only_offboard_is_control(base_mode: int, custom_mode: int, is_in_control: bool) -> None:
    assert DRIVER.is_in_control(base_mode, custom_mode) is is_in_control


@given(
    armed=st.booleans(),
    in_control=st.booleans(),
    failsafe=st.booleans(),
    landed=st.sampled_from([None, True, False]),
    refusals=st.integers(0, 5),
)
def test_nothing_is_asked_for_when_nothing_is_wanted(
    *, armed: bool, in_control: bool, failsafe: bool, landed: bool | None, refusals: int
) -> None:
    view = replace(GROUND, armed=armed, in_control=in_control, failsafe=failsafe, landed=landed)
    _, sent = _run(view, Desire(), 2.0, DriverMemory(disarm_refusals=refusals))
    assert sent == []


def test_mode_is_asked_for_after_setpoints_have_flowed_and_not_too_often() -> None:
    _, sent = _run(GROUND, Desire(control=True, armed=True), 3.0)
    assert [round(t_s, 2) for t_s, _ in sent] == [0.5, 1.5, 2.5]
    assert all(command.command == SET_MODE and command.parameters[:3] == (1.0, 6.0, 0.0) for _, command in sent)


def test_motors_are_armed_once_in_control_only() -> None:
    _, sent = _run(replace(GROUND, in_control=True), Desire(control=True, armed=True), 0.5)
    assert [(command.command, command.parameters[:2]) for _, command in sent] == [(DISARM, (1.0, 0.0))]


def test_motors_that_were_accepted_to_turn_are_not_ordered_again_until_they_are_wanted_anew() -> None:
    view, wanted = replace(GROUND, in_control=True), Desire(control=True, armed=True)
    memory, _ = _run(view, wanted, 0.1)
    assert _run(view, wanted, 3.0, DRIVER.acknowledged(memory, DISARM, REJECTED))[1]
    memory, sent = _run(view, wanted, 5.0, DRIVER.acknowledged(memory, DISARM, ACCEPTED))
    assert not sent
    memory, _ = _run(view, Desire(), 0.1, memory)
    assert _run(view, wanted, 1.5, memory)[1]


def test_late_answer_to_a_disarm_is_none_to_the_arming_that_follows_it_and_is_refused() -> None:
    view, wanted = replace(GROUND, in_control=True), Desire(control=True, armed=True)
    memory, _ = _run(view, wanted, 0.1)
    memory, _ = _run(ARMED, OFF, 0.1, memory)
    memory, _ = _run(view, Desire(), 0.1, memory)
    memory = DRIVER.acknowledged(memory, DISARM, ACCEPTED)
    memory, _ = _run(view, wanted, 0.1, memory)
    memory = DRIVER.acknowledged(memory, DISARM, ACCEPTED)
    memory = DRIVER.acknowledged(memory, DISARM, REJECTED)
    assert not memory.arm_accepted
    assert _run(view, wanted, 1.5, memory)[1]


def test_release_leaves_offboard_for_a_hover() -> None:
    _, sent = _run(ARMED, Desire(release=True), 0.5)
    assert [command.parameters[:3] for _, command in sent] == [(1.0, 4.0, 3.0)]


def test_disarm_is_forced_after_a_refusal_and_not_before() -> None:
    memory, sent = _run(ARMED, OFF, 1.0)
    assert sent
    assert all(command.parameters[:2] == (0.0, 0.0) for _, command in sent)
    memory = DRIVER.acknowledged(memory, DISARM, REJECTED)
    _, sent = _run(ARMED, OFF, 0.1, memory)
    assert [command.parameters[:2] for _, command in sent] == [(0.0, 21196.0)]


def test_disarm_is_not_forced_without_the_evidence() -> None:
    memory, _ = _run(ARMED, OFF, 0.1)
    memory = DRIVER.acknowledged(memory, DISARM, REJECTED)
    _, sent = _run(ARMED, Desire(armed=False, force_disarm=False), 1.0, memory)
    assert all(command.parameters[1] == 0.0 for _, command in sent)


@pytest.mark.parametrize(
    ("command", "result"), [(DISARM, ACCEPTED), (DISARM, mavlink.MAV_RESULT_IN_PROGRESS), (SET_MODE, REJECTED)]
)
def test_only_a_refused_disarm_is_a_refusal(command: int, result: int) -> None:
    memory, _ = _run(ARMED, OFF, 0.1)
    assert DRIVER.acknowledged(memory, command, result).disarm_refusals == 0


def test_refused_arming_is_no_refused_disarm() -> None:
    memory, _ = _run(replace(GROUND, in_control=True), Desire(control=True, armed=True), 0.1)
    memory = DRIVER.acknowledged(memory, DISARM, REJECTED)
    _, sent = _run(ARMED, OFF, 0.1, memory)
    assert [command.parameters[:2] for _, command in sent] == [(0.0, 0.0)]


def test_refusal_is_forgotten_after_a_bounce() -> None:
    memory, _ = _run(ARMED, OFF, 0.1)
    memory = DRIVER.acknowledged(memory, DISARM, REJECTED)
    memory, _ = _run(ARMED, Desire(), 0.1, memory)
    assert memory.disarm_refusals == 0
    assert not memory.disarm_asked


def test_limits_are_cut_to_the_parameters_and_never_raised() -> None:
    wanted = CompanionConfig().limits.flight_limits()
    cut = DRIVER.limits(wanted, {"MPC_XY_VEL_MAX": 12.0, "MPC_Z_VEL_MAX_DN": 1.0, "MPC_Z_VEL_MAX_UP": 2.0})
    assert (cut.speed_max_m_s, cut.descent_max_m_s, cut.climb_max_m_s) == (12.0, 1.0, 2.0)
    roomy = dict.fromkeys(LIMITS, 1e3)
    assert replace(DRIVER.limits(wanted, roomy), tilt_acceleration_m_s2=math.inf) == wanted


@given(st.dictionaries(st.sampled_from(LIMITS), st.floats()))
def test_no_parameter_whatever_takes_a_limit_away(parameters: dict[str, float]) -> None:
    wanted = CompanionConfig().limits.flight_limits()
    cut = DRIVER.limits(wanted, parameters)
    assert 0.0 < cut.speed_max_m_s <= wanted.speed_max_m_s
    assert 0.0 < cut.climb_max_m_s <= wanted.climb_max_m_s
    assert 0.0 < cut.descent_max_m_s <= wanted.descent_max_m_s
    assert cut.acceleration_max_m_s2 == wanted.acceleration_max_m_s2
    assert acceleration_of_tilt_m_s2(10.0) <= cut.tilt_acceleration_m_s2 < math.inf
