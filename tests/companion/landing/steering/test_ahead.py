"""The plan of a step begins where its setpoint takes effect."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.autopilots.px4 import Px4Driver
from companion.autopilots.response import STATES
from companion.core.data import Array
from companion.landing.state.step_data import LinkDelay, StepInputs
from companion.landing.steering.ahead import make_up, shift_aim
from companion.landing.steering.targets import HORIZON_OFFSETS_S, Aim
from companion.landing.steering.virtual_model import Tracking
from companion.planning.guidance import ReferenceState, Target
from companion.situation.phases import Phase
from link.messages import Command
from link.records import replace
from tests.companion.world import UTC_AHEAD_NS, Flight, response_of

LAST_S = float(HORIZON_OFFSETS_S[-1])
shifts = st.floats(0.0, 0.8)


def _cubic(offset_s: Array) -> tuple[Array, Array]:
    """Place and velocity (n, 3) of a way of constant jerk."""
    start, rate, bend, jerk = (
        np.array(row) for row in ((3.0, -2.0, 4.0), (7.0, 0.5, -0.4), (-1.0, 2.0, 0.3), (0.4, -0.6, 0.2))
    )
    t = offset_s[:, np.newaxis]
    return start + (rate + (bend / 2.0 + jerk * t / 6.0) * t) * t, rate + (bend + jerk * t / 2.0) * t


def _aim() -> Aim:
    position, velocity = _cubic(HORIZON_OFFSETS_S)
    acceleration = np.outer(HORIZON_OFFSETS_S, [1.0, 2.0, 3.0])
    target = Target(
        offset_s=HORIZON_OFFSETS_S,
        position_enu_m=position,
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=acceleration,
    )
    return Aim(target=target, floor_enu_m=2.0 - 0.5 * HORIZON_OFFSETS_S, touched_enu_m=1.0 + HORIZON_OFFSETS_S)


@given(shifts)
def test_shifted_aim_is_the_way_that_much_later(by_s: float) -> None:
    shifted = shift_aim(_aim(), by_s)
    later_s = HORIZON_OFFSETS_S + by_s
    within = later_s <= LAST_S
    position, _ = _cubic(later_s)
    np.testing.assert_allclose(shifted.target.position_enu_m[within], position[within], atol=1e-9)
    np.testing.assert_allclose(shifted.target.acceleration_enu_m_s2[within, 1], 2.0 * later_s[within], atol=1e-9)
    np.testing.assert_allclose(shifted.floor_enu_m[within], 2.0 - 0.5 * later_s[within], atol=1e-9)
    assert shifted.touched_enu_m is not None
    np.testing.assert_allclose(shifted.touched_enu_m[within], 1.0 + later_s[within], atol=1e-9)


@given(shifts)
def test_shifted_aim_goes_on_beyond_its_end_as_it_moves_there(by_s: float) -> None:
    aim = _aim()
    last = shift_aim(aim, by_s).target
    onwards = aim.target.position_enu_m[-1] + by_s * aim.target.velocity_enu_m_s[-1]
    np.testing.assert_allclose(last.position_enu_m[-1], onwards, atol=1e-9)
    np.testing.assert_allclose(last.velocity_enu_m_s[-1], aim.target.velocity_enu_m_s[-1])


@pytest.mark.parametrize("driver", [Px4Driver(), ArduPilotDriver()], ids=lambda driver: driver.name)
def test_drone_that_lags_meets_its_target_by_what_the_model_is_led_to(driver: Px4Driver | ArduPilotDriver) -> None:
    """By the autopilot's own equations: the drone is off the model, and the target was moved by just that."""
    response, target = response_of(driver), _aim().target
    deviation = np.array([[0.4, 0.0], [-0.2, 0.1], [0.3, 0.0], [0.2, -0.5]])
    assert deviation.shape == (STATES, 2)
    start = ReferenceState(
        position_enu_m=np.zeros(3), velocity_enu_m_s=np.zeros(3), acceleration_enu_m_s2=np.array([2.0, -1.0, 0.5])
    )
    accelerates = np.array([2.0, -1.0])
    led = make_up(target, start, Tracking(deviation=deviation, compared_ns=0), response, late_s=0.05, ahead_s=0.1)
    then = response.carry(deviation, accelerates, 0.15)
    off = response.predict(then, np.tile(accelerates, (len(HORIZON_OFFSETS_S), 1)))
    np.testing.assert_allclose(led.position_enu_m[:, :2] + off[:, 0], target.position_enu_m[:, :2], atol=1e-4)
    np.testing.assert_allclose(led.velocity_enu_m_s[:, :2] + off[:, 1], target.velocity_enu_m_s[:, :2], atol=1e-4)
    np.testing.assert_array_equal(led.position_enu_m[:, 2], target.position_enu_m[:, 2])


def test_for_a_planner_that_foresees_no_lag_it_is_that_along_the_targets_way() -> None:
    response, target = response_of(ArduPilotDriver()), _aim().target
    still = ReferenceState(
        position_enu_m=np.zeros(3), velocity_enu_m_s=np.zeros(3), acceleration_enu_m_s2=np.array([4.0, 3.0, 0.0])
    )
    tracking = Tracking(compared_ns=0)
    led = make_up(target, still, tracking, response, late_s=0.0, ahead_s=0.0, planner_foresees=False)
    off = response.predict(np.zeros((STATES, 2)), target.acceleration_enu_m_s2[:, :2])
    np.testing.assert_allclose(led.position_enu_m[:, :2] + off[:, 0], target.position_enu_m[:, :2])


class DelayedFlight(Flight):
    """Setpoints take effect 0.1 s later: what they are held for at PX4 comes on top of the link."""

    delay_s = 0.09

    def inputs(self, command: Command | None = None) -> StepInputs:
        return replace(super().inputs(command), link_delay=LinkDelay(mean_s=self.delay_s))


def test_model_is_then_where_the_setpoint_that_takes_effect_was() -> None:
    """Whatever is planned later: the drone has been told this. A model that turned at once would be elsewhere."""
    flight, sent = DelayedFlight(), {}
    flight.start_and_reach(Phase.CHASE)
    compared = 0
    for _ in range(150):
        outputs = flight.step()
        model, setpoint = flight.memory.model, outputs.setpoint
        assert setpoint is not None
        assert model.reference is not None
        sent[setpoint.t_ns - UTC_AHEAD_NS] = np.array(setpoint.position_enu_m)
        told = sent.get(model.reference_ns)
        if told is not None:
            compared += 1
            np.testing.assert_allclose(model.reference.position_enu_m, told, atol=1e-6)
    assert compared > 100


@pytest.mark.parametrize(("before_s", "after_s"), [(0.01, 0.29), (0.29, 0.01)])
def test_setpoints_stay_on_the_models_way_as_a_link_becomes_slower_or_quicker(before_s: float, after_s: float) -> None:
    """At 4 m/s a setpoint that is dated 0.28 s wrong is 1.1 m off."""
    flight = DelayedFlight()
    flight.delay_s = before_s
    flight.start_and_reach(Phase.ALIGN)
    sent = []
    for step in range(20):
        flight.delay_s = before_s if step < 10 else after_s
        setpoint = flight.step().setpoint
        assert setpoint is not None
        assert setpoint.velocity_enu_m_s is not None
        sent.append((setpoint.t_ns, np.array(setpoint.position_enu_m), np.array(setpoint.velocity_enu_m_s)))
    for (start_ns, start, start_m_s), (end_ns, end, end_m_s) in itertools.pairwise(sent):
        moved = 0.5 * (start_m_s + end_m_s) * (end_ns - start_ns) * 1e-9
        np.testing.assert_allclose(end - start, moved, atol=0.05)
