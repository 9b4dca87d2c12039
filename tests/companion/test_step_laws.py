"""What holds in every step: pure, finite, silent before a start, motors forced off only on the pad."""

import pickle

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from companion.autopilots.driver import AutopilotView
from companion.autopilots.frame_moves import FrameMoves
from companion.core.data import Array, Forecast
from companion.landing.state.memory import StepMemory
from companion.situation.phases import Phase
from companion.step import companion_step
from link.messages import Command
from link.records import replace
from tests.companion.facts import changed
from tests.companion.world import (
    CONFIG,
    DISARM,
    FLYING,
    GEAR_M,
    LANDING,
    SET_MODE,
    STEP_NS,
    Flight,
    KnownVehicle,
    kept,
    own_state,
    reached,
)

views = st.builds(
    AutopilotView,
    link_up=st.booleans(),
    armed=st.booleans(),
    in_control=st.booleans(),
    failsafe=st.booleans(),
    landed=st.sampled_from([None, True, False]),
    frame_moves=st.builds(FrameMoves, origin_count=st.integers(0, 3)),
)


@pytest.mark.slow
@given(views=st.lists(views, min_size=1, max_size=8), command=st.sampled_from([None, Command.ABORT, Command.HOLD]))
@settings(max_examples=60, deadline=None)
def test_nothing_is_commanded_nor_flown_before_a_start(views: list[AutopilotView], command: Command | None) -> None:
    flight = Flight()
    for view in views:
        flight.view = view
        outputs = flight.step(command)
        assert outputs.setpoint is None
        assert outputs.commands == ()
        assert flight.phase is Phase.IDLE


def test_disarm_is_forced_only_after_a_refusal() -> None:
    flight = reached(Phase.TOUCHDOWN)
    flight.run_until(Phase.SECURED, limit_s=2.0)
    disarms = [second for _, _, first, second in flight.told(DISARM) if first == 0.0]
    assert disarms[0] == 0.0
    assert disarms[-1] == 21196.0
    assert sorted(disarms) == disarms


@given(
    phase=st.sampled_from(Phase),
    height_m=st.floats(-3.0, 3.0),
    beside_m=st.floats(-3.0, 3.0),
    refusals=st.integers(0, 3),
    asked=st.booleans(),
    acknowledged=st.lists(st.tuples(st.sampled_from([DISARM, SET_MODE]), st.integers(0, 5)), max_size=3),
    own_age_s=st.floats(0.0, 2.0),
    command=st.sampled_from([None, *Command]),
    in_control=st.booleans(),
)
@pytest.mark.slow
@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_disarm_is_forced_only_on_the_pad_and_after_a_refusal(  # noqa: PLR0917 (drawn by name)
    phase: Phase,
    height_m: float,
    beside_m: float,
    refusals: int,
    asked: bool,
    acknowledged: list[tuple[int, int]],
    own_age_s: float,
    command: Command | None,
    in_control: bool,
) -> None:
    flown = kept(Phase.TOUCHDOWN)
    x, y, z = flown.vehicle.at(flown.t_ns).tolist()
    place = (x, y + beside_m, z + GEAR_M + height_m)
    inputs = replace(
        flown.inputs(command),
        own=own_state(flown.t_ns - round(own_age_s * 1e9), place),
        acknowledgements=tuple(acknowledged),
        autopilot=replace(flown.view, in_control=in_control),
    )
    driver = replace(flown.memory.control.driver, asked_ns=None, disarm_asked=asked, disarm_refusals=refusals)
    memory = replace(flown.memory, sortie=kept(Phase.FOLLOW).memory.sortie)  # a station, for the phases that keep one
    memory = changed(memory, phase=phase, since_ns=inputs.monotonic_ns, driver=driver, held={})
    after, outputs = companion_step(memory, inputs, flown.system)
    forced = [one for one in outputs.commands if one.command == DISARM and one.parameters[1] != 0.0]
    refused = refusals > 0 or (asked and any(one == DISARM and result for one, result in acknowledged))
    if forced:
        assert after.progress.phase is Phase.TOUCHDOWN
        assert height_m < CONFIG.descent.commit_height_m + 1e-6
        assert abs(beside_m) < 2.0 * CONFIG.descent.cone.radius_at_pad_m + 1e-6
        assert refused


def test_moved_origin_resets_the_estimate() -> None:
    flight = reached(Phase.CHASE)
    flight.sends_fixes = False
    flight.view = replace(flight.view, frame_moves=FrameMoves(origin_count=2))
    before = flight.memory.vehicle
    flight.step()
    assert (before.estimator is None, flight.memory.vehicle.estimator is None) == (False, True)
    assert flight.phase is Phase.ABORT


@pytest.mark.parametrize("phase", [Phase.WAITING, Phase.HOLD])
def test_local_frame_that_jumps_takes_the_setpoint_with_it(phase: Phase) -> None:
    flight = reached(phase)
    flight.sends_fixes = False  # nothing to chase
    flight.run(2.0)
    before = flight.step().setpoint
    shift = (31.0, -17.0, 4.0)
    x, y, z = flight.own.position_enu_m
    flight.own = replace(flight.own, position_enu_m=(x + shift[0], y + shift[1], z + shift[2]))
    flight.view = replace(flight.view, frame_moves=FrameMoves(origin_count=1, shift_enu_m=shift))
    after = flight.step().setpoint
    assert before is not None
    assert after is not None
    np.testing.assert_allclose(np.subtract(after.position_enu_m, before.position_enu_m), shift, atol=0.02)
    flight.run(2.0)
    assert flight.phase is phase
    assert flight.memory.model.tracking.error_m < 0.1


class _Broken(KnownVehicle):
    def forecast(self, memory: int | None, t_ns: int, offset_s: Array) -> Forecast | None:
        forecast = super().forecast(memory, t_ns, offset_s)
        return None if forecast is None else replace(forecast, velocity_enu_m_s=np.full((len(offset_s), 3), np.nan))


@pytest.mark.slow
@pytest.mark.parametrize("phase", [Phase.WAITING, *LANDING])
def test_estimate_that_is_not_finite_is_given_up_and_never_flown(phase: Phase) -> None:
    flight = reached(phase)
    flight.vehicle = _Broken(flight.vehicle.start_enu_m, flight.vehicle.velocity_enu_m_s)
    for _ in range(100):
        outputs = flight.step()
        assert outputs.setpoint is not None
        assert np.isfinite([*outputs.setpoint.position_enu_m, *(outputs.setpoint.velocity_enu_m_s or ())]).all()
        assert outputs.status.relative_position_enu_m is None
        assert flight.phase is (Phase.WAITING if phase is Phase.WAITING else Phase.ABORT)


numbers = st.floats(-9.9e5, 9.9e5)
places = st.tuples(numbers, numbers, numbers)


@given(
    phase=st.sampled_from(FLYING),
    reports=st.lists(st.tuples(places, places, st.integers(-(10**12), 10**12)), min_size=1, max_size=4),
    step_ns=st.sampled_from([1, STEP_NS, 10**9, 10**12]),
)
@pytest.mark.slow
@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_setpoints_are_finite_whatever_the_drone_reports(
    phase: Phase, reports: list[tuple[tuple[float, float, float], tuple[float, float, float], int]], step_ns: int
) -> None:
    base = kept(phase)
    memory, t_ns = base.memory, base.t_ns
    for position, velocity, late_ns in reports:
        t_ns += step_ns
        inputs = replace(base.inputs(), t_ns=t_ns, own=own_state(t_ns - late_ns, position, velocity))
        memory, outputs = companion_step(memory, inputs, base.system)
        if outputs.setpoint is not None:
            setpoint = outputs.setpoint
            assert setpoint.velocity_enu_m_s is not None
            assert setpoint.acceleration_enu_m_s2 is not None
            values = (*setpoint.position_enu_m, *setpoint.velocity_enu_m_s, *setpoint.acceleration_enu_m_s2)
            assert np.isfinite((*values, setpoint.yaw_rad)).all()


@pytest.mark.parametrize("phase", FLYING)
def test_step_is_pure(phase: Phase) -> None:
    flight = kept(phase)
    inputs = flight.inputs()
    before = _bytes(flight.memory)
    first = companion_step(flight.memory, inputs, flight.system)
    assert _bytes(flight.memory) == before
    second = companion_step(flight.memory, inputs, flight.system)
    assert _bytes(first[0]) == _bytes(second[0])
    assert first[1].setpoint == second[1].setpoint
    assert first[1].status == second[1].status


def _bytes(memory: StepMemory) -> bytes:
    held = tuple(sorted((one.name, since_ns) for one, since_ns in memory.progress.held.items()))
    return pickle.dumps((changed(memory, held={}), held))


def test_time_that_stands_still_does_not_move_the_setpoint() -> None:
    flight = reached(Phase.CHASE)
    inputs = flight.inputs()
    memory = flight.memory
    places = []
    for i in range(5):
        memory, outputs = companion_step(memory, replace(inputs, t_ns=inputs.t_ns + i), flight.system)
        assert outputs.setpoint is not None
        places.append(outputs.setpoint.position_enu_m)
    np.testing.assert_allclose(places, np.tile(places[0], (5, 1)), atol=0.02)
