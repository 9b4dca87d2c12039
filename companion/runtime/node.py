"""The companion without I/O, on any clock: bytes and payloads in and out. Flights, campaigns and tests run this one."""

from companion.autopilots.link import AutopilotLink
from companion.autopilots.messages import may_turn
from companion.component.component import MavlinkComponent
from companion.component.identity import ComputerLoad
from companion.config.companion import CompanionConfig
from companion.core.data import Rival, VehicleEstimate
from companion.landing.guiding import guiding_message
from companion.landing.state.memory import StepMemory
from companion.landing.state.step_data import StepInputs, StepOutputs, System
from companion.landing.steering.virtual_model import response_to
from companion.runtime.link_delay import link_delay
from companion.runtime.publishing import StatusPublisher, with_links
from companion.runtime.step_clock import StepClock
from companion.runtime.step_commands import StepCommands, refuse_motors_off
from companion.runtime.vehicle_link import VehicleLink
from companion.situation.phases import FLYING_PHASES, LANDING_PHASES, STATION_PHASES, Phase
from companion.step import companion_step
from companion.vehicle.estimator import BufferHealth
from companion.vehicle.factory import make_estimator
from companion.vehicle.imm_numbers import deck_of
from link.mavlink.session import MavlinkSession
from link.messages import Command, CommandReply, PadGeometry, Station
from link.records import replace
from link.zenoh.keys import Keys, Publication

_MOTION_RATE_MIN_HZ = 50.0
# A drone that sinks, or lifts off, cannot keep to a smaller jerk from one instant to the next.
_KEEPS_LIMITS = frozenset({Phase.DESCEND, Phase.TOUCHDOWN, Phase.LIFT_OFF})


class CompanionNode:
    """A companion.

    Args:
        system: configuration, estimator and guidance law.
        keys: of the Zenoh contract.
        session: to the autopilot.
        dry_run: send neither setpoints nor commands.
        publishes: put status and plan on Zenoh; where nobody listens, leaving them out saves a hundredth of the time.
        is_component: hear ground stations and tell them more than texts; where there are none, that saves as much.
    """

    def __init__(
        self,
        system: System,
        keys: Keys,
        session: MavlinkSession,
        *,
        dry_run: bool = False,
        publishes: bool = True,
        is_component: bool = False,
    ) -> None:
        motion_rate_hz = max(system.config.setpoints.rate_hz, _MOTION_RATE_MIN_HZ)
        self.autopilot = AutopilotLink(session, system.config.autopilot, motion_rate_hz)
        self._dry_run = dry_run
        self._component = MavlinkComponent(session, is_open=is_component, dry_run=dry_run)
        self.commands = StepCommands(self._component)
        self.publisher = StatusPublisher(keys, system.config, is_on=publishes)
        self._limits_wanted = system.config.limits.flight_limits()
        self.memory = StepMemory()
        self.inputs: StepInputs | None = None
        self.outputs: StepOutputs | None = None
        self.open_to_strangers: tuple[str, ...] = ()  # which links are, for the status
        self.system = system
        self._rival: Rival | None = None
        self._other_companion = Rival(drone=keys.drone, is_this_drone=True)
        self._leaving = False
        self._clock = StepClock(system.config.setpoints.rate_hz)
        self.vehicle = VehicleLink(keys, self._clock, system.config.silent_vehicle)

    @property
    def phase(self) -> Phase:
        """Of the landing."""
        return self.memory.progress.phase

    def vehicle_estimate(self, t_ns: int) -> VehicleEstimate | None:
        """Return the vehicle at `t_ns` (UTC) as the last step knew it, None before the first fix."""
        return self.system.estimator.estimate(self.memory.vehicle.estimator, t_ns)

    def estimator_health(self) -> BufferHealth:
        """Return what became of the measurements, and whether they agree with the estimator."""
        return self.system.estimator.health(self.memory.vehicle.estimator)

    def receive_mavlink(self, data: bytes, local_ns: int, *, is_datagram: bool = False) -> None:
        """Take bytes of the autopilot's link: whole frames if `is_datagram`, else a piece of a stream.

        Raises:
            UserError: the autopilot is of a kind that cannot be flown.
        """
        self.autopilot.receive(data, local_ns, is_datagram=is_datagram)

    def receive_sample(self, key: str, payload: bytes) -> None:
        """Take a Zenoh sample; see `VehicleLink.receive`."""
        self.vehicle.receive(key, payload, self.autopilot.state)

    @property
    def bad_payloads(self) -> int:
        """How many samples and answers were refused."""
        return self.vehicle.refusals.total

    @property
    def vehicle_heard(self) -> bool:
        """Whether a fix of the vehicle has come that could be used, or none is to come."""
        return self.vehicle.tells_nothing or (self.outputs is not None and self.outputs.status.fix_age_s is not None)

    def receive_pad(self, pad: PadGeometry) -> None:
        """Take the vehicle's description of its pad; the estimator needs the lever arm for sightings of the pad."""
        was_afloat = self.vehicle.pad is not None and self.vehicle.pad.is_afloat
        if self.vehicle.receive_pad(pad):
            estimator = make_estimator(self.system.config.estimator, deck_of(pad))
            if pad.is_afloat is not was_afloat:  # what has been learnt of a ship as of a car is wrong, and believed
                self.memory = replace(self.memory, vehicle=replace(self.memory.vehicle, estimator=None))
            self.system = replace(self.system, estimator=estimator)

    def doubt_pad(self) -> None:
        """Take that the vehicle describes another pad now; it is received once nothing is flown."""
        self.vehicle.is_pad_doubted = True

    def is_ready_to_start(self) -> bool:
        """Return whether a start that nobody commands may be made: whoever else flies the drone would be known."""
        return self.autopilot.state.places_drone and self._component.would_know_of_flight

    def start_refusal(self) -> CommandReply | None:
        """Return the answer to a start for a vehicle that was never heard; None where a step is to judge it."""
        if self.vehicle_heard or not self.autopilot.state.places_drone:
            return None
        return self.vehicle.refuse_start()

    def receive_liveliness(self, *, alive: bool) -> None:
        """Take the state of the vehicle's liveliness token."""
        self.vehicle.receive_liveliness(alive=alive)

    def receive_rival(self, rival: Rival | None) -> None:
        """Take who else is there for this drone or on this vehicle, and was there first."""
        self._rival = rival

    def request(self, command: Command, station: Station | None = None) -> None:
        """Take an operator's command, a follow with its station; its reply follows the next step."""
        self.commands.request(command, station)

    def leave(self) -> None:
        """Ask the autopilot, from the next step on, to hover by itself; on the pad it switches its motors off first."""
        self._leaving = True

    @property
    def flies(self) -> bool:
        """Whether motors turn at this companion's command, or may."""
        view = self.autopilot.state.view
        steers = not self._dry_run and self.phase in FLYING_PHASES
        turns = may_turn(view, self.memory.control.driver, self._clock.monotonic_ns)
        return steers and view.link_up and turns and view.in_control

    def poll(self, local_ns: int) -> bool:
        """Do what is due; return whether a step was made."""
        self.autopilot.poll(local_ns)
        requests = self.autopilot.session.take_requests()
        self._apply(self._component.take(requests, self.system.config, self.phase, local_ns))
        if not self.is_due(local_ns):
            return False
        self._step(local_ns)
        return True

    def take_frames(self) -> list[bytes]:
        """Return the MAVLink frames to be sent, once."""
        return self.autopilot.session.take_output()

    def take_publications(self) -> list[Publication]:
        """Return what is to be put on Zenoh, once."""
        return self.publisher.take()

    def tell_load(self, load: ComputerLoad, local_ns: int) -> None:
        """Tell ground stations what the computer does."""
        self._component.tell_load(load, local_ns)

    def warn(self, of_what: str) -> None:
        """Tell ground stations what is not as it should be."""
        self._component.warn(of_what)

    def take_replies(self) -> list[CommandReply]:
        """Return the replies to operators' commands, once, in their order."""
        return self.commands.take_replies()

    def is_due(self, local_ns: int) -> bool:
        """Return whether it is time for a step: one follows each new state of the drone, and waits no longer than that.

        What is asked for by `request` while this is true is in the step of the next `poll`.
        """
        own = self.autopilot.state.own
        return self._clock.is_due(local_ns, None if own is None else own.t_ns)

    def _step(self, local_ns: int) -> None:
        state, way, cascade = self.autopilot.state, self.autopilot.session.clock, self.autopilot.cascade
        own_ns = None if state.own is None else state.own.t_ns
        self._clock.advance(way.local_to_utc_ns(local_ns), local_ns, own_ns, self.autopilot.utc_set_ns)
        switched = self.autopilot.pilot_switch.take()
        command, station = self.commands.next(switched, lambda: self._start_refusal(switched), local_ns)
        kept = self.inputs if self.phase in _KEEPS_LIMITS else None
        is_flown = self._component.is_drone_flown(self.memory, state.view, local_ns)
        inputs = StepInputs(
            t_ns=self._clock.t_ns,
            monotonic_ns=self._clock.monotonic_ns,
            limits=self.autopilot.limits(self._limits_wanted) if kept is None else kept.limits,
            response=None if cascade is None else response_to(cascade),
            own=state.own,
            autopilot=state.view,
            driver=self.autopilot.driver,
            acknowledgements=self.autopilot.take_acknowledgements(),
            vehicle=self.vehicle.take(is_utc_known=way.is_utc_known),
            rival=self._other_companion if is_flown else self._rival,
            command=command,
            station=station,
            leaving=self._leaving,
            shaping=self.autopilot.shaping if kept is None else kept.shaping,
            link_delay=link_delay(self.autopilot.session.clock_sync, self.autopilot.setpoints.answers, local_ns),
        )
        self.inputs = inputs
        self.memory, self.outputs = companion_step(self.memory, inputs, self.system)
        self.autopilot.ask_often(is_steered=self.phase in LANDING_PHASES | STATION_PHASES | {Phase.ABORT})
        self._send(inputs, self.outputs, local_ns)

    def _start_refusal(self, switched: Command | None) -> CommandReply | None:
        """Return the answer to a pilot's or a ground station's start; None where a step is to judge it."""
        may_arm = switched is None or self.system.config.autopilot.pilot_switch.arms
        return self.start_refusal() if may_arm or self.autopilot.state.view.armed else refuse_motors_off()

    def _apply(self, config: CompanionConfig) -> None:
        """Take a configuration that a ground station has changed, between two flights."""
        if config is not self.system.config:
            self.system = replace(self.system, config=config)
            self._limits_wanted = config.limits.flight_limits()

    def _send(self, inputs: StepInputs, outputs: StepOutputs, local_ns: int) -> None:
        if outputs.reply is not None:
            self.commands.answer(outputs.reply, local_ns)
        if not self._dry_run:
            if outputs.setpoint is not None:
                self.autopilot.send_setpoint(outputs.setpoint, local_ns)
            self.autopilot.send_commands(outputs.commands, local_ns)
            if (target := guiding_message(outputs, inputs, self.system.config, local_ns)) is not None:
                self.autopilot.session.send(target)
        self._component.tell(outputs, self.phase, self.autopilot.state, self.system.config, local_ns)
        if self.publisher.is_due(outputs, self._clock.monotonic_ns):
            yaw_rad = self.memory.model.yaw_setpoint_rad
            status = with_links(outputs.status, self.autopilot.session, self.vehicle, self.open_to_strangers)
            self.publisher.publish(status, outputs.way_from(self._clock.t_ns), self._clock, yaw_rad)
