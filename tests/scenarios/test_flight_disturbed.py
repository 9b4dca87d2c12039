"""What goes wrong in each phase of a flight, and how it ends: on the simulator's ground truth, in lockstep."""

from collections.abc import Sequence

import numpy as np
import pytest

from companion.runtime.build import build_node
from companion.runtime.node import CompanionNode
from companion.situation.phases import Phase
from link.keys import Keys
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.messages import Command
from scenarios.catalogue import load_scenario
from scenarios.lockstep import Lockstep

pytestmark = pytest.mark.slow

SCENARIO = load_scenario("straight_5")
STEPS_PER_S = 100
GROUND_STATION = MavlinkCodec(255, 190)
STOPPED_RAD_S = 50.0
POSITION_MODE = 3.0
HOLD_MODE = (4.0, 3.0)


class Disturbed(Lockstep):
    """A lockstep run whose vehicle can fall silent; `setpoints` counts those that the companion sends."""

    vehicle_is_silent = False
    setpoints = 0

    def fly(self, duration_s: float) -> None:
        for _ in range(round(duration_s * STEPS_PER_S)):
            self.step()

    def tell(self, message: Message) -> None:
        """Let a ground station send a message to the autopilot."""
        self.simulation.receive(GROUND_STATION.encode(message))

    @property
    def phase(self) -> Phase:
        return self.companion.phase

    def _advance_companion(self, t_ns: int) -> None:
        if self.vehicle_is_silent:
            self._channels.zenoh.take(2**62)
        super()._advance_companion(t_ns)

    def _send(self, frames: Sequence[bytes], t_ns: int) -> None:
        reader = MavlinkCodec(1, 1)
        sent = [message for frame in frames for message in reader.decode(frame)]
        self.setpoints += sum(one.get_type() == "SET_POSITION_TARGET_LOCAL_NED" for one in sent)
        super()._send(frames, t_ns)

    def restart_companion(self) -> None:
        """Kill the companion and start another one, that knows nothing."""
        self.companion: CompanionNode = build_node(SCENARIO.system.companion, Keys())
        self.companion.receive_pad(self.simulation.vehicle.pad)

    @property
    def height_m(self) -> float:
        """True height of the drone above the vehicle's point on the road."""
        return self.recording.drone[-1].position_enu_m[2] - self.recording.vehicle[-1].position_enu_m[2]

    def motors_stopped_in_the_air(self) -> bool:
        """Whether the rotors ever stood while the drone was well above the roof and the road."""
        clear_m = SCENARIO.vehicle.roof_height_m + 0.5
        drones = {one.t_ns: one.position_enu_m[2] for one in self.recording.drone}
        stopped = [one.t_ns for one in self.recording.rotors if max(one.speed_rad_s) < STOPPED_RAD_S]
        return any(drones.get(t_ns, 0.0) > clear_m for t_ns in stopped)


def flown_to(phase: Phase) -> Disturbed:
    flight = Disturbed(SCENARIO, 1)
    while flight.phase is not phase:
        flight.step()
        assert flight.recording.elapsed_s < 60.0
    return flight


def command(number: int, *params: float) -> Message:
    return mavlink.MAVLink_command_long_message(1, 1, number, 0, *(*params, *[0.0] * (7 - len(params))))


@pytest.mark.parametrize("phase", [Phase.WAITING, Phase.DESCEND])
def test_pilot_who_changes_the_mode_has_the_drone_and_keeps_it(phase: Phase) -> None:
    flight = flown_to(phase)
    flight.tell(command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, POSITION_MODE))
    flight.fly(0.2)
    assert flight.phase is Phase.PILOT
    sent = flight.setpoints
    flight.fly(4.0)
    assert flight.setpoints == sent
    assert not flight.companion.autopilot.state.view.in_control
    assert not flight.motors_stopped_in_the_air()


def test_vehicle_that_falls_silent_in_the_descent_is_left_upwards() -> None:
    flight = flown_to(Phase.DESCEND)
    flight.vehicle_is_silent = True
    flight.fly(8.0)
    if flight.phase is not Phase.SECURED:
        assert flight.phase in {Phase.ABORT, Phase.HOLD}
        assert flight.height_m > SCENARIO.vehicle.roof_height_m + 2.0
    assert not flight.motors_stopped_in_the_air()


def test_lowered_speed_limit_is_planned_with_at_once() -> None:
    flight = flown_to(Phase.WAITING)
    kind = mavlink.MAV_PARAM_TYPE_REAL32
    flight.tell(mavlink.MAVLink_param_set_message(1, 1, b"MPC_XY_VEL_MAX", 4.0, kind))
    flight.fly(12.0)
    assert flight.phase is Phase.WAITING
    assert "MPC_XY_VEL_MAX" in flight.recording.statuses[-1].reason
    assert np.hypot(*flight.recording.drone[-1].velocity_flu_m_s[:2]) < 0.5


def test_companion_that_is_killed_in_flight_lands_after_a_new_start_and_not_before() -> None:
    flight = flown_to(Phase.WAITING)
    flight.tell(command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, *HOLD_MODE))
    flight.restart_companion()
    sent = flight.setpoints
    flight.fly(2.5)
    assert flight.phase is Phase.IDLE
    assert flight.setpoints == sent
    flight.companion.request(Command.START)
    assert flight.run() == Phase.SECURED.value
    assert not flight.motors_stopped_in_the_air()
