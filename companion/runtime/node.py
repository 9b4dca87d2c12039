"""The companion without I/O: bytes and payloads in, bytes and payloads out, on any clock.

The wire loop, the lockstep campaigns and the tests all run this one.
"""

import math
from functools import lru_cache

from companion.autopilots.link import AutopilotLink
from companion.autopilots.response import Cascade, ResponseModel
from companion.core.data import Measurement, Rival, VehicleEstimate
from companion.landing.memory import StepMemory
from companion.landing.outputs import plan_publication, status_publication
from companion.landing.step_data import LinkDelay, StepInputs, StepOutputs, System
from companion.landing.targets import HORIZON_OFFSETS_S
from companion.runtime.step_clock import StepClock
from companion.situation.phases import FLYING_PHASES, Phase
from companion.step import companion_step
from companion.vehicle.estimator import BufferHealth
from companion.vehicle.factory import make_estimator
from companion.vehicle.inputs import measurements_of
from link.mavlink.session import MavlinkSession
from link.messages import Command, CommandReply, PadGeometry
from link.payloads.checks import PayloadError
from link.payloads.json_messages import is_possible
from link.records import replace
from link.zenoh.keys import Keys, Publication

_MOTION_RATE_MIN_HZ = 50.0
_EARLY = 0.75  # of a period: a new state of the drone starts the next step from here on
_LATE = 2.0  # periods without a new state after which the step is made without one
_FUTURE_MAX_NS = 500_000_000  # a stamp farther ahead comes from a clock that is wrong
_LINK_DELAY_MAX_S = 0.3  # a longer way is not led for: the model is too uncertain so far ahead
_PLAN_EVERY = 2  # statuses


class CompanionNode:
    """A companion.

    Args:
        system: configuration, estimator and guidance law.
        keys: of the Zenoh contract.
        session: to the autopilot.
        dry_run: send neither setpoints nor commands.
        publishes: put status and plan on Zenoh; where nobody listens, leaving them out saves a hundredth of the time.
    """

    def __init__(
        self, system: System, keys: Keys, session: MavlinkSession, *, dry_run: bool = False, publishes: bool = True
    ) -> None:
        self.autopilot = AutopilotLink(
            session,
            motion_rate_hz=max(system.config.step_rate_hz, _MOTION_RATE_MIN_HZ),
            stops_unused_streams=system.config.stops_unused_streams,
            kind=system.config.autopilot,
            geoid_height_m=system.config.geoid_height_m,
        )
        self._dry_run = dry_run
        self._publishes = publishes
        self._response: ResponseModel | None = None
        self._limits_wanted = system.config.limits.flight_limits()
        self.memory = StepMemory()
        self.inputs: StepInputs | None = None
        self.outputs: StepOutputs | None = None
        self.bad_payloads = 0
        self.open_to_strangers: tuple[str, ...] = ()  # which links are, for the status
        self.unpublished = 0  # statuses and plans that hold what no message has room for
        self.system = system
        self._keys = keys
        self._measurements: list[Measurement] = []
        silent = system.config.silent_vehicle
        self._pad: PadGeometry | None = None if silent is None else silent.pad
        self._vehicle_alive: bool | None = None
        self._rival: Rival | None = None
        self._command: Command | None = None
        self._leaving = False
        self._replies: list[CommandReply] = []
        self._publications: list[Publication] = []
        self._stepped_ns: int | None = None
        self._stepped_own_ns: int | None = None
        self._clock = StepClock()
        self._status_ns: int | None = None
        self._statuses = 0

    @property
    def phase(self) -> Phase:
        """Of the landing."""
        return self.memory.progress.phase

    @property
    def pad_known(self) -> bool:
        """Whether the vehicle has described its pad."""
        return self._pad is not None

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
        """Take a Zenoh sample; what cannot be decoded, is absurd or comes from the future is counted and dropped.

        So is what somebody says of a vehicle that tells nothing.
        """
        if self.system.config.silent_vehicle is not None and key != self._keys.pad_pose:
            self.bad_payloads += 1
            return
        try:
            measurements = measurements_of(key, payload, self._keys, self.autopilot.state)
        except PayloadError:
            self.bad_payloads += 1
            return
        newest_ns = self._clock.t_ns + _FUTURE_MAX_NS
        self._measurements += [measurement for measurement in measurements if measurement.t_ns <= newest_ns]
        # Before UTC is known a stamp ahead of the companion's own clock says nothing about who is wrong.
        if self.autopilot.session.clock.is_utc_known and any(one.t_ns > newest_ns for one in measurements):
            self.bad_payloads += 1

    def receive_pad(self, pad: PadGeometry) -> None:
        """Take the vehicle's description of its pad; the estimator needs the lever arm for sightings of the pad."""
        if not is_possible(pad) or self.system.config.silent_vehicle is not None:
            self.bad_payloads += 1
            return
        self._pad = pad
        estimator = make_estimator(self.system.config.estimator, pad.antenna_to_pad_m)
        self.system = replace(self.system, estimator=estimator)

    def is_ready_to_start(self) -> bool:
        """Return whether a start would be accepted now."""
        state = self.autopilot.state
        placed = state.view.frame is not None and state.view.geoid_known
        return state.view.link_up and placed and state.own is not None

    def receive_liveliness(self, *, alive: bool) -> None:
        """Take the state of the vehicle's liveliness token; one that never was is not lost."""
        if alive or self._vehicle_alive is not None:
            self._vehicle_alive = alive

    def receive_rival(self, rival: Rival | None) -> None:
        """Take who else is there for this drone or on this vehicle, and was there first."""
        self._rival = rival

    def request(self, command: Command) -> None:
        """Take an operator's command; its reply follows the next step."""
        self._command = command

    def leave(self) -> None:
        """Ask the autopilot, from the next step on, to hover by itself; on the pad it switches its motors off first."""
        self._leaving = True

    @property
    def flies(self) -> bool:
        """Whether motors turn at this companion's command."""
        view = self.autopilot.state.view
        steers = not self._dry_run and self.phase in FLYING_PHASES
        return steers and view.link_up and view.armed and view.in_control

    def poll(self, local_ns: int) -> bool:
        """Do what is due; return whether a step was made."""
        self.autopilot.poll(local_ns)
        if not self.is_due(local_ns):
            return False
        self._step(local_ns)
        return True

    def take_frames(self) -> list[bytes]:
        """Return the MAVLink frames to be sent, once."""
        return self.autopilot.session.take_output()

    def take_publications(self) -> list[Publication]:
        """Return what is to be put on Zenoh, once."""
        taken, self._publications = self._publications, []
        return taken

    def take_replies(self) -> list[CommandReply]:
        """Return the replies to operators' commands, once, in their order."""
        taken, self._replies = self._replies, []
        return taken

    def is_due(self, local_ns: int) -> bool:
        """Return whether it is time for a step: one follows each new state of the drone, and waits no longer than that.

        What is asked for by `request` while this is true is in the step of the next `poll`.
        """
        if self._stepped_ns is None:
            return True
        own = self.autopilot.state.own
        periods = (local_ns - self._stepped_ns) * 1e-9 * self.system.config.step_rate_hz
        is_new = own is not None and own.t_ns != self._stepped_own_ns
        return periods >= (_EARLY if is_new else _LATE)

    def _step(self, local_ns: int) -> None:
        state, way = self.autopilot.state, self.autopilot.session.clock
        self._clock.advance(way.local_to_utc_ns(local_ns), local_ns)
        inputs = StepInputs(
            t_ns=self._clock.t_ns,
            monotonic_ns=self._clock.monotonic_ns,
            limits=self.autopilot.limits(self._limits_wanted),
            response=self._present_response(),
            own=state.own,
            autopilot=state.view,
            driver=self.autopilot.driver,
            acknowledgements=self.autopilot.take_acknowledgements(),
            measurements=tuple(self._measurements),
            vehicle_alive=self._vehicle_alive,
            rival=self._rival,
            pad=self._pad,
            command=self._command,
            leaving=self._leaving,
            timeout_s=self.autopilot.timeout_s,
            link_delay=LinkDelay(mean_s=min(way.one_way_s, _LINK_DELAY_MAX_S), std_s=way.one_way_std_s),
        )
        self._measurements, self._command = [], None
        self._stepped_ns, self._stepped_own_ns = local_ns, None if state.own is None else state.own.t_ns
        self.inputs = inputs
        self.memory, self.outputs = companion_step(self.memory, inputs, self.system)
        self._send(self.outputs, local_ns)

    def _present_response(self) -> ResponseModel | None:
        """Return the model of how the autopilot follows setpoints, made anew when its gains have changed."""
        cascade = self.autopilot.cascade
        if cascade is not None and (self._response is None or self._response.cascade != cascade):
            self._response = _response_to(cascade)
        return self._response

    def _send(self, outputs: StepOutputs, local_ns: int) -> None:
        if not self._dry_run:
            if outputs.setpoint is not None:
                self.autopilot.send_setpoint(outputs.setpoint, local_ns)
            self.autopilot.send_commands(outputs.commands, local_ns)
        if outputs.text is not None:
            self.autopilot.send_text(outputs.text)
        if outputs.reply is not None:
            self._replies.append(outputs.reply)
        since_ns = math.inf if self._status_ns is None else self._clock.monotonic_ns - self._status_ns
        is_due = since_ns >= 1e9 / self.system.config.status_rate_hz
        if self._publishes and (outputs.text is not None or is_due):
            self._publish(outputs)

    def _publish(self, outputs: StepOutputs) -> None:
        self._status_ns = self._clock.monotonic_ns
        self._statuses += 1
        status = replace(
            outputs.status,
            mavlink_bad_bytes=self.autopilot.session.statistics.codec.bad_bytes,
            zenoh_bad_payloads=self.bad_payloads,
            open_to_strangers=self.open_to_strangers,
        )
        try:
            self._publications.append(status_publication(self._keys, status))
            if outputs.plan is not None and self._statuses % _PLAN_EVERY == 0:
                plan = plan_publication(self._keys, outputs.plan, self._clock.t_ns, self.memory.model.yaw_setpoint_rad)
                self._publications.append(plan)
        except PayloadError:  # a flight goes on without being seen
            self.unpublished += 1


@lru_cache(maxsize=16)  # the gains of some landings; nothing that a link tells fills the memory
def _response_to(cascade: Cascade) -> ResponseModel:
    """Return the model of a cascade; 2 ms, and the gains of an autopilot come one by one in each of many landings."""
    return ResponseModel(cascade, HORIZON_OFFSETS_S)
