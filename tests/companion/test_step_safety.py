"""Who is in command and when a landing is broken off: whole flights of the step."""

import math

import pytest

from companion.core.data import RangeReading
from companion.core.reasons import Reason
from companion.situation.phases import Phase
from companion.step import companion_step
from link.mavlink.dialect import mavlink
from link.messages import Command
from link.records import replace
from tests.companion.world import (
    CONFIG,
    DISARM,
    FLYING,
    GEAR_M,
    IMPATIENT,
    LANDING,
    PAD_HEIGHT_M,
    SET_MODE,
    Flight,
    KnownVehicle,
    own_state,
    reached,
)

BY_VALUE = [phase for phase in FLYING if phase not in (Phase.ABORT, Phase.HOLD)]


@pytest.mark.parametrize("phase", FLYING)
def test_pilots_mode_change_stops_setpoints_in_the_same_step_and_for_good(phase: Phase) -> None:
    flight = reached(phase)
    assert flight.view.in_control
    flight.view = replace(flight.view, in_control=False)
    commands = len(flight.commands)
    first = flight.step()
    assert first.setpoint is None
    assert flight.phase is Phase.PILOT
    assert first.text is not None
    flight.run(1.0)
    flight.view = replace(flight.view, in_control=True)
    given_back = flight.run(5.0)
    assert all(outputs.setpoint is None and outputs.status.flown_by == "other" for outputs in given_back)
    assert len(flight.commands) == commands
    assert flight.phase is Phase.PILOT


@pytest.mark.parametrize("phase", [phase for phase in FLYING if phase not in (Phase.TOUCHDOWN, Phase.ON_DECK)])
def test_restart_that_begins_with_another_mode_and_motors_off_is_said_to_be_one(phase: Phase) -> None:
    flight = reached(phase)
    flight.view = replace(flight.view, in_control=False, disarm_told=True)
    assert flight.step().setpoint is None
    assert (flight.phase, flight.reason) == (Phase.PILOT, Reason.DISARMED)
    flight.view = replace(flight.view, armed=False, restarted=True)
    text = flight.step().text
    assert flight.reason is Reason.AUTOPILOT_RESTARTED
    assert text is not None
    assert Reason.AUTOPILOT_RESTARTED.value in text
    assert flight.step().text is None


@pytest.mark.parametrize("is_off", [True, False])
def test_mode_that_changes_as_the_motors_are_switched_off_on_the_pad_is_the_pilots_only_if_they_run(
    *, is_off: bool
) -> None:
    flight = reached(Phase.TOUCHDOWN)
    flight.view = replace(flight.view, in_control=False, disarm_told=True)
    flight.step()
    assert flight.phase is Phase.TOUCHDOWN
    flight.view = replace(flight.view, armed=not is_off, disarm_told=is_off)
    flight.step()
    assert flight.phase is (Phase.SECURED if is_off else Phase.PILOT)


@pytest.mark.slow
def test_pilots_mode_change_before_the_motors_turn_counts_as_well() -> None:
    flight = Flight(refuses=frozenset({DISARM}))
    flight.start_and_reach(Phase.TAKEOFF)
    flight.run(1.5)
    assert flight.view.in_control
    flight.view = replace(flight.view, in_control=False)
    flight.step()
    modes = len(flight.told(SET_MODE))
    flight.run(10.0)
    assert flight.phase is Phase.PILOT
    assert len(flight.told(SET_MODE)) == modes
    assert not flight.view.armed


@pytest.mark.parametrize("phase", BY_VALUE)
def test_failsafe_ends_the_companions_flight(phase: Phase) -> None:
    flight = reached(phase)
    flight.view = replace(flight.view, failsafe=True)
    assert flight.step().setpoint is None
    assert flight.phase is Phase.PILOT
    assert flight.reason is Reason.AUTOPILOT_FAILSAFE


@pytest.mark.slow
@pytest.mark.parametrize("phase", [Phase.CHASE, Phase.ALIGN, Phase.DESCEND])
def test_failsafe_in_which_the_autopilot_follows_on_does_not_end_a_landing(phase: Phase) -> None:
    flight = reached(phase)
    flight.view = replace(flight.view, warns=True)
    flight.run_until(Phase.SECURED)
    assert Phase.ABORT not in flight.history
    assert not flight.view.armed


def test_nothing_is_begun_while_the_autopilot_reports_a_failsafe() -> None:
    flight = reached(Phase.ALIGN)
    flight.view = replace(flight.view, warns=True)
    flight.sends_fixes = False
    flight.run_until(Phase.ABORT)
    flight.sends_fixes = True
    flight.run_until(Phase.HOLD)
    assert "reports a failsafe" in flight.sentence
    flight.step()
    reply = flight.step(Command.START).reply
    assert reply is not None
    assert not reply.accepted
    assert reply.reason == flight.sentence


def test_autopilot_that_never_gives_control_is_given_up() -> None:
    flight = Flight(config=IMPATIENT, refuses=frozenset({SET_MODE}))
    flight.start_and_reach(Phase.TAKEOFF)
    flight.run(IMPATIENT.takeoff.refused_after_s + 1.0)
    assert flight.phase is Phase.IDLE
    assert flight.reason is Reason.CONTROL_REFUSED
    asked = len(flight.commands)
    flight.run(5.0)
    assert len(flight.commands) == asked


def test_airborne_drone_whose_control_is_refused_does_not_wait_for_it_for_ever() -> None:
    flight = Flight(config=IMPATIENT, refuses=frozenset({SET_MODE}))
    flight.view = replace(flight.view, armed=True, landed=False)
    flight.start_and_reach(Phase.TAKEOFF)
    flight.run(IMPATIENT.takeoff.refused_after_s + 1.0)
    assert flight.phase is Phase.IDLE


@pytest.mark.parametrize(("height_m", "waits_m"), [(1.0, 5.0), (7.0, 7.0)])
def test_drone_that_flies_at_a_start_waits_no_lower_than_one_that_takes_off(height_m: float, waits_m: float) -> None:
    flight = Flight(vehicle=KnownVehicle((-400.0, 0.4, PAD_HEIGHT_M), (0.0, 0.0, 0.0)))
    flight.view = replace(flight.view, armed=True, landed=False)
    flight.own = own_state(flight.t_ns, (2.0, -1.0, GEAR_M + height_m))
    flight.start_and_reach(Phase.WAITING)
    flight.run(5.0)
    assert flight.phase is Phase.WAITING
    assert flight.own.position_enu_m == pytest.approx((2.0, -1.0, GEAR_M + waits_m), abs=0.1)


def test_hold_before_the_motors_turn_ends_in_idle() -> None:
    for command in (Command.HOLD, Command.ABORT):
        flight = Flight()
        flight.start_and_reach(Phase.TAKEOFF)
        outputs = flight.step(command)
        assert outputs.setpoint is None
        assert flight.phase is Phase.IDLE
        flight.run(3.0)
        assert flight.commands == []


@pytest.mark.slow
@pytest.mark.parametrize("phase", LANDING)
@pytest.mark.parametrize("command", [Command.ABORT, Command.HOLD])
def test_operators_abort_climbs_and_ends_in_a_hold_without_retry(phase: Phase, command: Command) -> None:
    flight = reached(phase)
    reply = flight.step(command).reply
    assert reply is not None
    assert reply.accepted
    flight.run_until(Phase.HOLD)
    assert flight.history[-2:] == [Phase.ABORT, Phase.HOLD]
    assert flight.reason is Reason.BROKEN_OFF


def test_operator_can_end_the_retries_during_the_climb() -> None:
    flight = reached(Phase.ALIGN)
    flight.alive, flight.sends_fixes = False, False
    flight.run_until(Phase.ABORT)
    flight.sends_fixes = True
    reply = flight.step(Command.HOLD).reply
    assert reply is not None
    assert reply.accepted
    flight.run_until(Phase.HOLD)
    assert Phase.CHASE not in flight.history[-2:]


def test_abort_is_refused_with_the_reason_while_the_motors_are_switched_off() -> None:
    flight = reached(Phase.TOUCHDOWN)
    reply = flight.step(Command.ABORT).reply
    assert reply is not None
    assert not reply.accepted
    assert reply.reason == "nothing to abort in phase touchdown"


@pytest.mark.parametrize("phase", LANDING)
def test_vehicle_that_falls_silent_is_left_upwards_and_held_off(phase: Phase) -> None:
    flight = reached(phase)
    flight.sends_fixes = False
    flight.run_until(Phase.ABORT, limit_s=CONFIG.abort.fix_age_max_s + 0.1)
    assert flight.reason is Reason.VEHICLE_DATA_OLD
    height_m = flight.own.position_enu_m[2]
    flight.run_until(Phase.HOLD, limit_s=CONFIG.abort.time_limit_s + 0.1)
    assert flight.sentence == "no vehicle data"
    assert flight.own.position_enu_m[2] > height_m + 0.8 * CONFIG.abort.height_m


@pytest.mark.slow
@pytest.mark.parametrize("phase", LANDING)
def test_drone_that_does_not_know_where_it_is_aborts(phase: Phase) -> None:
    flight = reached(phase)
    flight.own_is_silent = True
    flight.run_until(Phase.ABORT, limit_s=CONFIG.abort.own_age_max_s + 0.1)
    assert flight.reason is Reason.OWN_POSITION_OLD
    flight.run_until(Phase.HOLD, limit_s=CONFIG.abort.time_limit_s + 0.1)
    assert not [one for one in flight.told(DISARM) if one[2] == 0.0]


def test_vehicle_that_falls_silent_during_the_climb_does_not_make_the_drone_turn_back() -> None:
    flight = reached(Phase.ALIGN)
    flight.config = CONFIG.model_copy(update={"abort": CONFIG.abort.model_copy(update={"height_m": 15.0})})
    flight.step(Command.ABORT)
    flight.run(1.0)
    flight.sends_fixes = False
    while flight.phase is Phase.ABORT:
        flight.step()
        assert flight.own.velocity_enu_m_s[0] > -0.3
    assert flight.own.velocity_enu_m_s[0] < 0.1


@pytest.mark.parametrize("phase", BY_VALUE)
def test_flight_out_of_touch_with_the_autopilot_is_given_up(phase: Phase) -> None:
    flight = reached(phase)
    flight.view = replace(flight.view, link_up=False)
    outputs = flight.step()
    assert flight.phase is Phase.PILOT
    assert outputs.setpoint is None


@pytest.mark.parametrize("phase", [Phase.WAITING, Phase.CHASE, Phase.DESCEND])
def test_motors_that_stop_in_the_air_end_the_companions_flight(phase: Phase) -> None:
    flight = reached(phase)
    flight.view = replace(flight.view, armed=False)
    assert flight.step().setpoint is None
    assert flight.phase is Phase.PILOT


def test_hold_time_of_an_abort_goes_on_through_the_phases_of_an_approach() -> None:
    flight = reached(Phase.ALIGN)
    while Reason.ALIGNED not in flight.memory.progress.held:
        flight.step()
    since_ns = flight.t_ns
    flight.vehicle = replace(flight.vehicle, std_m=CONFIG.abort.position_std_max_m + 0.1)
    while flight.phase in (Phase.ALIGN, Phase.DESCEND):
        flight.step()
    assert Phase.DESCEND in flight.history
    assert flight.reason is Reason.VEHICLE_UNCERTAIN
    assert flight.memory.progress.since_ns - since_ns < (CONFIG.abort.cone_hold_s + 0.05) * 1e9


def test_drone_that_the_pad_has_left_after_contact_is_pressed_down_where_it_is() -> None:
    flight = reached(Phase.TOUCHDOWN)
    x_m, y_m, z_m = flight.own.position_enu_m
    held = replace(flight.own, position_enu_m=(x_m - 2.0, y_m + 1.0, z_m), velocity_enu_m_s=(0.0, 0.0, 0.0))
    _, outputs = companion_step(flight.memory, replace(flight.inputs(), own=held), flight.system)
    assert outputs.setpoint is not None
    assert outputs.setpoint.velocity_enu_m_s is not None
    assert math.dist(outputs.setpoint.position_enu_m[:2], held.position_enu_m[:2]) < 0.1
    assert outputs.setpoint.position_enu_m[2] < z_m
    assert outputs.setpoint.velocity_enu_m_s[2] < -0.275  # what PX4's land detector asks for at least


@pytest.mark.parametrize(
    ("behind_m", "seen_m", "landed", "flies"),
    [
        (5.0, None, False, True),
        (2.0, None, False, False),  # on another part of the vehicle, for all that is known
        (2.0, 1.6, False, True),
        (5.0, 0.05, False, False),  # it stands on something, the road or a bonnet
        (5.0, None, True, False),
    ],
)
def test_drone_that_hovers_where_the_pad_was_is_not_pressed_down_but_climbs(
    behind_m: float, seen_m: float | None, landed: bool, flies: bool
) -> None:
    """As after a setpoint link that was silent from the last decimetres on: the autopilot held the drone."""
    flight = reached(Phase.TOUCHDOWN)
    x_m, y_m, z_m = flight.own.position_enu_m
    flight.own = replace(flight.own, position_enu_m=(x_m - behind_m, y_m, z_m), velocity_enu_m_s=(0.0, 0.0, 0.0))
    sensor_m = CONFIG.touchdown.range_finder.height_m
    seen = None if seen_m is None else RangeReading(t_ns=flight.t_ns, distance_m=seen_m + sensor_m, own=flight.own)
    flight.view = replace(flight.view, landed=landed, range_down=seen)
    outputs = flight.step()
    assert (flight.reason is Reason.LEFT_AFTER_CONTACT) is flies
    assert (flight.phase is Phase.ABORT) is flies
    assert outputs.setpoint is not None
    if flies:
        flight.run(1.0)
        assert flight.own.position_enu_m[2] > z_m
    else:
        assert outputs.setpoint.position_enu_m[2] < z_m


def test_motors_that_do_not_stop_on_the_pad_are_told() -> None:
    flight = reached(Phase.TOUCHDOWN)
    flight.refuses = frozenset({mavlink.MAV_CMD_COMPONENT_ARM_DISARM})
    first = flight.step()
    assert first.status.reason_code != "MOTORS_RUN"
    flight.run(6.0)
    assert flight.phase is Phase.TOUCHDOWN
    assert flight.view.armed
    assert flight.outputs is not None
    assert flight.outputs.status.reason_code == "MOTORS_RUN"
