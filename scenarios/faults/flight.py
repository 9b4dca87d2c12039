"""A lockstep run in which things can be made to fail: links, the autopilot, the companion, what they believe."""

from collections.abc import Mapping, Sequence
from math import degrees, inf

from companion.core.data import Rival
from companion.runtime.build import build_node
from companion.runtime.node import CompanionNode
from companion.situation.phases import Phase
from link.frames.geodesy import geodetic_from_enu
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.messages import Command, Vector3
from link.records import replace
from link.zenoh.keys import Keys
from scenarios.config import Scenario
from scenarios.faults.held_way import HeldWay
from scenarios.lockstep.lockstep import Lockstep
from scenarios.simulation.simulation import STEP_NS

_STEP_S = STEP_NS * 1e-9
_REACHED_MAX_S = 60.0
_FOREVER_NS = 2**62
_SETPOINT = "SET_POSITION_TARGET_LOCAL_NED"
_ORDERS = frozenset({mavlink.MAV_CMD_COMPONENT_ARM_DISARM, mavlink.MAV_CMD_DO_SET_MODE})
COMMANDED: Mapping[Phase, tuple[Phase, Command]] = {
    Phase.ABORT: (Phase.CHASE, Command.ABORT),
    Phase.HOLD: (Phase.WAITING, Command.HOLD),
}
"""The phases that an operator leads to, from which and by what."""


class FaultFlight(Lockstep):
    """A lockstep run to be disturbed.

    Args:
        scenario: what is flown.
        seed: of everything random.
    """

    def __init__(self, scenario: Scenario, seed: int) -> None:
        super().__init__(scenario, seed)
        self.setpoints = 0
        self.uninvited = 0
        """Setpoints, arming and changes of mode by a second companion."""
        self.vehicle_is_silent = False
        self.vehicle_is_alive = True
        self.scenario = scenario
        self._cut_until_s = 0.0
        self._unheard_until_s = 0.0
        self._unsteered_until_s = 0.0
        self._stopped_until_s = 0.0
        self._vehicle_held_until_s = 0.0
        self._vehicle_cut_until_s = 0.0
        self._vehicle_slew = 0.0
        self._second: CompanionNode | None = None
        self._way = HeldWay(self._channels.zenoh)
        self._ways = {key: self._way if way is self._channels.zenoh else way for key, way in self._ways.items()}
        self._ground_station = MavlinkCodec(255, mavlink.MAV_COMP_ID_MISSIONPLANNER)

    @property
    def phase(self) -> Phase:
        """The companion's."""
        return self.companion.phase

    @property
    def follows_setpoints(self) -> bool:
        """Whether the autopilot's true mode is the one in which it flies setpoints."""
        return self.simulation.autopilot.memory.modes.mode.value == "offboard"

    @property
    def height_m(self) -> float:
        """Of the drone above the road, on truth."""
        return self.recording.drone[-1].position_enu_m[2] if self.recording.drone else 0.0

    def fly(self, duration_s: float) -> None:
        """Go on for `duration_s`."""
        for _ in range(round(duration_s / _STEP_S)):
            self.step()

    def fly_to(self, phase: Phase) -> None:
        """Go on to the first step of `phase`.

        Raises:
            ValueError: it is not reached.
        """
        before, command = COMMANDED.get(phase, (phase, None))
        while self.phase is not before:
            self.step()
            if self.recording.elapsed_s > _REACHED_MAX_S:
                raise ValueError(f"phase {before.value} is not reached in {_REACHED_MAX_S:g} s")
        if command is not None:
            self._order(command, phase)

    def _order(self, command: Command, phase: Phase) -> None:
        """Let the operator give a command, and go on to the phase that it leads to."""
        self.companion.request(command)
        while self.phase is not phase:
            self.step()

    def break_off_at(self, height_m: float) -> bool:
        """Go on until the feet are so high over the pad in a descent, and break it off; another approach follows.

        An operator's abort is followed by none. That this one is, is all that it differs by. Return whether a descent
        came so low before the run was over.
        """
        while self.phase is not Phase.DESCEND or not self.is_below(height_m):
            if self._watch.reason(self.recording) is not None:
                return False
            self.step()
        self._order(Command.ABORT, Phase.ABORT)
        memory = self.companion.memory
        self.companion.memory = replace(memory, progress=replace(memory.progress, may_retry=True))
        return True

    def is_below(self, height_m: float) -> bool:
        """Return whether the companion tells that the feet are lower over the pad."""
        status = self.recording.status
        told_m = None if status is None else status.height_above_pad_m
        return told_m is not None and told_m < height_m

    def tell(self, message: Message) -> None:
        """Let a ground station send a message to the autopilot."""
        self.simulation.receive(self._ground_station.encode(message))

    def cut_link(self, duration_s: float = inf) -> None:
        """Let nothing through between companion and autopilot."""
        self._cut_until_s = self.recording.elapsed_s + duration_s

    def cut_way_up(self, duration_s: float) -> None:
        """Let nothing of the companion's through to the autopilot; it hears on."""
        self._unheard_until_s = self.recording.elapsed_s + duration_s

    def lose_setpoints(self, duration_s: float) -> None:
        """Let none of the companion's setpoints through; all else comes to the autopilot."""
        self._unsteered_until_s = self.recording.elapsed_s + duration_s

    def stop_companion(self, duration_s: float) -> None:
        """Let the companion's process stand still, as by SIGSTOP; what is sent to it waits for it."""
        self._stopped_until_s = self.recording.elapsed_s + duration_s

    @property
    def companion_is_stopped(self) -> bool:
        """Whether its process stands still."""
        return self.recording.elapsed_s < self._stopped_until_s

    def hold_vehicle(self, duration_s: float) -> None:
        """Let the vehicle's program stand still; what its receiver tells meanwhile comes at once, afterwards."""
        self._vehicle_held_until_s = self.recording.elapsed_s + duration_s

    def cut_vehicle(self, duration_s: float) -> None:
        """Let nothing of the vehicle through, as without a router: neither its data nor that it lives."""
        self._vehicle_cut_until_s = self.recording.elapsed_s + duration_s

    def set_vehicle_clock(self, ahead_s: float, slew: float) -> None:
        """Set the vehicle's clock ahead, and let it gain `slew` seconds a second."""
        self.simulation.vehicle.set_clock(ahead_s)
        self._vehicle_slew = slew

    def spoil_links(self, share: float) -> None:
        """Flip a bit in `share` of what goes over the autopilot's link, and cut as much short."""
        for link in (self._channels.down, self._channels.up):
            link.spoil(corruption=share, truncation=share)

    def set_origin(self, by_enu_m: Vector3) -> None:
        """Let a ground station move the autopilot's local frame under the drone."""
        origin = self.simulation.autopilot.memory.places.origin
        latitude_rad, longitude_rad, altitude_m = geodetic_from_enu(origin.frame.origin, by_enu_m)
        latitude, longitude = (round(degrees(angle_rad) * 1e7) for angle_rad in (latitude_rad, longitude_rad))
        self.tell(mavlink.MAVLink_set_gps_global_origin_message(1, latitude, longitude, round(altitude_m * 1e3)))

    def restart_companion(self) -> None:
        """Kill the companion and start another one, that knows nothing."""
        self.companion = build_node(self.scenario.system.companion, Keys())
        self.companion.receive_pad(self.simulation.vehicle.pad)

    def add_companion(self) -> None:
        """Start a second companion for the drone, on the same link, by an operator who does not know of the first."""
        self._second = build_node(self.scenario.system.companion, Keys())
        self._second.receive_pad(self.simulation.vehicle.pad)
        self._second.receive_rival(Rival(drone=Keys().drone, is_this_drone=True))

    def add_drone(self) -> None:
        """Let another drone be found to land on the vehicle, that was there first, as where two networks meet."""
        self.companion.receive_rival(Rival(drone="drone2", is_this_drone=False))

    def step(self) -> None:
        """Advance by one step of the simulation."""
        now_s = self.recording.elapsed_s
        self._way.holds = now_s < self._vehicle_held_until_s
        self._way.loses = now_s < self._vehicle_cut_until_s
        if self._vehicle_slew:
            self.simulation.vehicle.set_clock(self._vehicle_slew * _STEP_S)
        super().step()

    def _advance_companion(self, t_ns: int) -> None:
        if self.companion_is_stopped:
            self._send([], t_ns)
            return
        self.companion.receive_liveliness(alive=self.vehicle_is_alive and not self._way.loses)
        if self._link_is_cut:
            self._channels.down.take(_FOREVER_NS)
        if self.vehicle_is_silent:
            self._channels.zenoh.take(_FOREVER_NS)
        super()._advance_companion(t_ns)
        if self._second is not None:
            self._advance_second(self._second, t_ns)

    def _advance_second(self, node: CompanionNode, t_ns: int) -> None:
        if node.is_ready_to_start():
            node.request(Command.START)
        node.poll(self.local_ns)
        frames = node.take_frames()
        self.uninvited += sum(_flies(one) for one in _messages(frames))
        for frame in frames:
            self._channels.up.put(frame, t_ns)

    def _hear(self, data: bytes) -> None:
        super()._hear(data)
        if self._second is not None:
            self._second.receive_mavlink(data, self.local_ns)

    def _send(self, frames: Sequence[bytes], t_ns: int) -> None:
        self.setpoints += sum(one.get_type() == _SETPOINT for one in _messages(frames))
        now_s = self.recording.elapsed_s
        if self._link_is_cut or now_s < self._unheard_until_s:
            frames = []
        elif now_s < self._unsteered_until_s:
            frames = [frame for frame in frames if not any(one.get_type() == _SETPOINT for one in _messages([frame]))]
        super()._send(frames, t_ns)

    @property
    def _link_is_cut(self) -> bool:
        return self.recording.elapsed_s < self._cut_until_s


def _flies(message: Message) -> bool:
    """Return whether a companion flies by it."""
    return message.get_type() == _SETPOINT or getattr(message, "command", None) in _ORDERS


def _messages(frames: Sequence[bytes]) -> list[Message]:
    reader = MavlinkCodec(1, 1)
    return [message for frame in frames for message in reader.decode(frame)]
