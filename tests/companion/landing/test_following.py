"""The virtual model and an autopilot in a closed loop: a drone that is off its setpoints is brought over the pad."""

from typing import Any

import numpy as np
import pytest

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.autopilots.px4 import Px4Driver
from companion.autopilots.response import Cascade
from companion.core.data import Array
from companion.landing.state.step_data import LinkDelay, StepInputs, StepOutputs
from companion.landing.steering.flown_plan import extrapolate
from companion.landing.steering.following_height import chase_floor_m
from companion.situation.phases import Phase
from link.messages import Command, Vector3
from link.records import replace
from tests.companion.world import CONFIG, GEAR_M, PAD_HEIGHT_M, STEP_NS, Flight, KnownVehicle, configured, own_state

SPEED_M_S = 5.0
SUBSTEPS = 5
TIMEOUT_S = ArduPilotDriver.timeout_default_s
JERKS_M_S3 = (5.0, 20.0)


class CarryingDriver(Px4Driver):
    """A driver of an autopilot that carries setpoints on, as ArduPilot does, but takes off as PX4 does."""

    shaping = ArduPilotDriver().shaping


class CascadeFlight(Flight):
    """The drone follows by a position controller; it may hear of its setpoints late, and something may push it."""

    gains = Px4Driver().cascade({})
    late_s = 0.0
    push_enu_m_s2: Array = np.zeros(2)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.integrated: Array = np.zeros(2)

    def _fly(self, outputs: StepOutputs) -> None:
        before = self.own
        super()._fly(outputs)
        setpoint = outputs.setpoint
        if setpoint is None or setpoint.velocity_enu_m_s is None or setpoint.acceleration_enu_m_s2 is None:
            return
        if not (self.view.armed and self.view.in_control):
            return
        p, v = np.array(before.position_enu_m[:2]), np.array(before.velocity_enu_m_s[:2])
        velocity, acceleration = (
            np.array(one[:2]) for one in (setpoint.velocity_enu_m_s, setpoint.acceleration_enu_m_s2)
        )
        position = np.array(setpoint.position_enu_m[:2]) - velocity * self.late_s
        dt_s = STEP_NS * 1e-9 / SUBSTEPS
        for _ in range(SUBSTEPS):
            off = velocity + self.gains.position_per_s * (position - p) - v
            self.integrated = self.integrated + self.gains.integral_per_s2 * off * dt_s
            a = acceleration + self.gains.velocity_per_s * off + self.integrated + self.push_enu_m_s2
            p, v = p + (v + 0.5 * a * dt_s) * dt_s, v + a * dt_s
        self.own = own_state(self.own.t_ns, self._beside(p), (*v.tolist(), self.own.velocity_enu_m_s[2]))

    def _beside(self, p: Array) -> Vector3:
        x, y = p.tolist()
        return x, y, self.own.position_enu_m[2]


def _vehicle() -> KnownVehicle:
    return KnownVehicle((-30.0, 0.4, PAD_HEIGHT_M), (SPEED_M_S, 0.0, 0.0))


def _beside_pad_m(flight: Flight) -> float:
    """How far the drone is off the pad's centre."""
    return float(np.hypot(*(np.array(flight.own.position_enu_m) - flight.vehicle.at(flight.own.t_ns))[:2]))


class JitteryFlight(CascadeFlight):
    """Over a link whose delay differs by 50 ms from one setpoint to the next: 0.25 m at 5 m/s."""

    def inputs(self, command: Command | None = None) -> StepInputs:
        return replace(super().inputs(command), link_delay=LinkDelay(std_s=0.05))


def _flown(
    late_s: float,
    push_enu_m_s2: tuple[float, float],
    gains: Cascade,
    *,
    corrects_lag: bool,
    kind: type[CascadeFlight] = CascadeFlight,
    after_s: float = 3.0,
) -> list[float]:
    """The distances from the pad's centre in the second that begins `after_s` after the alignment did."""
    waits = configured(
        {
            "setpoints": {"corrects_lag": corrects_lag},
            "abort": {"near_speed_max_m_s": 1e-9},  # it is never slow enough to descend
            "descent": {"alignment": {"time_limit_s": 90.0}},
        }
    )
    flight = kind(vehicle=_vehicle(), config=waits)
    flight.late_s, flight.push_enu_m_s2, flight.gains = late_s, np.array(push_enu_m_s2), gains
    flight.start_and_reach(Phase.ALIGN)
    flight.run(after_s)
    distances = []
    for _ in range(50):
        flight.step()
        distances.append(_beside_pad_m(flight))
    assert flight.phase is Phase.ALIGN
    return distances


OFF: dict[str, Any] = {
    "late by 60 ms": (0.06, (0.0, 0.0), Px4Driver().cascade({})),
    "pushed, and slow to make up for it": (0.0, (-0.4, 0.3), replace(Px4Driver().cascade({}), integral_per_s2=1e-3)),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(OFF))
@pytest.mark.parametrize("kind", [CascadeFlight, JitteryFlight])
def test_drone_that_is_lastingly_off_its_setpoints_is_brought_over_the_pad(
    kind: type[CascadeFlight], name: str
) -> None:
    led, left = (max(_flown(*OFF[name], corrects_lag=corrects_lag, kind=kind)) for corrects_lag in (True, False))
    assert left > 0.2
    assert led < 0.25 * left


@pytest.mark.slow
def test_drone_that_follows_exactly_is_not_led_off_the_pad() -> None:
    """Its lean does not lag, though the model says so: it settles later than one whose lean does."""
    assert max(_flown(0.0, (0.0, 0.0), Px4Driver().cascade({}), corrects_lag=True, after_s=3.5)) < 0.05


@pytest.mark.parametrize("speed_m_s", [4.0, 9.0])
def test_model_of_an_autopilot_that_carries_setpoints_on_never_ends_low(speed_m_s: float) -> None:
    vehicle = KnownVehicle((-10.0 * speed_m_s, 0.4, PAD_HEIGHT_M), (speed_m_s, 0.0, 0.0))
    flight = Flight(vehicle=vehicle, driver=CarryingDriver())
    flight.start_and_reach(Phase.CHASE)
    floors_m = {Phase.CHASE: chase_floor_m(CONFIG), Phase.ALIGN: 0.0}
    while flight.phase is not Phase.DESCEND:
        plan = flight.step().plan
        if flight.phase in floors_m:
            assert plan is not None
            carried_on = extrapolate(plan.next_state, TIMEOUT_S)
            feet_over_pad_m = float(carried_on.position_enu_m[2]) - PAD_HEIGHT_M - GEAR_M
            assert feet_over_pad_m >= floors_m[flight.phase] - 0.01
    assert flight.history[-3:] == [Phase.CHASE, Phase.ALIGN, Phase.DESCEND]


@pytest.mark.slow
@pytest.mark.parametrize("vertical_jerk_max_m_s3", JERKS_M_S3)
def test_descent_sinks_no_faster_than_the_fastest_rate(vertical_jerk_max_m_s3: float) -> None:
    config = configured(
        {"limits": {"vertical_jerk_max_m_s3": vertical_jerk_max_m_s3}, "descent": {"alignment": {"height_m": 3.0}}}
    )
    flight = Flight(config=config)
    flight.start_and_reach(Phase.DESCEND)
    fastest_m_s = 0.0
    while flight.phase is Phase.DESCEND:
        reference = flight.memory.model.reference
        assert reference is not None
        fastest_m_s = max(fastest_m_s, -float(reference.velocity_enu_m_s[2]))
        flight.step()
    assert flight.phase is Phase.TOUCHDOWN
    assert fastest_m_s <= config.descent.sink.rate_max_m_s + 0.02
