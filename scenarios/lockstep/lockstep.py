"""A whole run in one process on a simulated clock: the wire run's programs, meeting in the same bytes.

Same scenario and seed: the same bytes, so the same result.
"""

from collections.abc import Sequence

from companion.runtime.build import build_node
from companion.runtime.node import CompanionNode
from companion.situation.phases import Phase
from link.memory_link import MemoryLink
from link.messages import Command, CommandReply
from link.recording.recorder import Recorder
from link.zenoh.keys import Keys
from scenarios.config import Scenario
from scenarios.lockstep.channels import Channels, Way, channels_of
from scenarios.recordings.recording import EndWatch, Recording
from scenarios.scoring.accuracy import PERIOD_NS, PHASES, Nis, antenna_truth, estimate_error
from scenarios.simulation.noise import Seed
from scenarios.simulation.sensors import Mounting
from scenarios.simulation.simulation import Simulation, SimulationOutputs

START_NS = 1_767_225_600_000_000_000
"""UTC at the beginning of every lockstep run: 2026-01-01."""

_COMPANION_LOCAL_NS = 1_700_000_000_000_000_000  # its own clock is no part of any result


class Lockstep:
    """A run that is advanced step by step.

    Args:
        scenario: what is flown.
        seed: of everything random.
        recorder: of the companion, None where nothing is recorded.
        publishes: whether the companion makes what it would put on Zenoh, for `take_publications`.
    """

    def __init__(
        self,
        scenario: Scenario,
        seed: Seed,
        *,
        recorder: Recorder | None = None,
        publishes: bool = False,
    ) -> None:
        keys = Keys()
        self.recording = Recording()
        instant = scenario.run.start == "instant"
        self.simulation = Simulation(scenario, seed, keys, START_NS, instant=instant, publishes_truth=False)
        self.companion = build_node(scenario.system.companion, keys, recorder=recorder, publishes=publishes)
        if not scenario.is_silent:
            self.companion.receive_pad(self.simulation.vehicle.pad)
        self._channels: Channels = channels_of(scenario, seed, START_NS)
        from_vehicle = dict.fromkeys((keys.fix, keys.fix_velocity, keys.imu), self._channels.zenoh)
        self._ways: dict[str, Way] = {**from_vehicle, keys.pad_pose: self._channels.detector}
        self._watch = EndWatch(scenario.run.time_limit_s)
        self._started = False
        height_m = scenario.vehicle.roof_height_m
        point_flu_m = (0.0, 0.0, height_m) if scenario.is_silent else scenario.vehicle.antenna_flu_m
        self._mounting = Mounting(antenna_flu_m=point_flu_m, pad_height_m=height_m)
        self._compared_ns = START_NS

    def run(self) -> str:
        """Run to the end and return why it ended."""
        while (reason := self._watch.reason(self.recording)) is None:
            self.step()
        return reason

    @property
    def local_ns(self) -> int:
        """What the companion's own clock shows."""
        return self.simulation.t_ns - START_NS + _COMPANION_LOCAL_NS

    def step(self) -> None:
        """Advance by one step of the simulation."""
        outputs = self.simulation.step()
        t_ns = self.simulation.t_ns
        self._record(outputs)
        if outputs.mavlink:
            self._channels.down.put(outputs.mavlink, t_ns)
        for publication in outputs.publications:
            way = self._ways.get(publication.key)
            if way is not None:
                way.put(publication.key, publication.payload, t_ns)
        self._advance_companion(t_ns)

    def _advance_companion(self, t_ns: int) -> None:
        node, local_ns = self.companion, self.local_ns
        for data in self._channels.down.take(t_ns):
            self._hear(data)
        for way in (self._channels.zenoh, self._channels.detector):
            for key, payload in way.take(t_ns):
                node.receive_sample(key, payload)
        self._command(node)
        if node.poll(local_ns) and node.outputs is not None:
            self.recording.add(node.outputs.status)
            self._compare(node, t_ns)
        self._take(node.take_replies())
        self._send(node.take_frames(), t_ns)

    def _hear(self, data: bytes) -> None:
        """Give the companion what has come of the autopilot."""
        self.companion.receive_mavlink(data, self.local_ns)

    def _command(self, node: CompanionNode) -> None:
        # As the companion's own start over the wire: again and again, until it is under way.
        if not self._started and node.is_ready_to_start():
            self._started = node.phase is not Phase.IDLE
            if not self._started:
                node.request(Command.START)
        if self._watch.must_break_off(self.recording):
            node.request(Command.ABORT)

    def _take(self, replies: Sequence[CommandReply]) -> None:
        """Take the answers to the commands; that to a landing's start is its phase."""

    def _compare(self, node: CompanionNode, t_ns: int) -> None:
        """Compare the estimate with the truth, from time to time."""
        if node.phase not in PHASES or t_ns - self._compared_ns < PERIOD_NS:
            return
        vehicle, estimate = self.simulation.vehicle.state, node.vehicle_estimate(t_ns)
        if vehicle is None or estimate is None:
            return
        self._compared_ns = t_ns
        truth = antenna_truth(vehicle, self._mounting, self.simulation.autopilot.memory)
        in_descent = node.phase is Phase.DESCEND
        self.recording.estimate_errors.append(estimate_error(estimate, truth, in_descent=in_descent))
        health = node.estimator_health()
        if health.nis_per_dof is not None:
            self.recording.nis = Nis(total=health.nis_per_dof * health.nis_dof, dof=health.nis_dof)

    def _send(self, frames: Sequence[bytes], t_ns: int) -> None:
        up: MemoryLink = self._channels.up
        for frame in frames:
            up.put(frame, t_ns)
        for data in up.take(t_ns):
            answer = self.simulation.receive(data)
            if answer:
                self._channels.down.put(answer, t_ns)

    def _record(self, outputs: SimulationOutputs) -> None:
        self.recording.add(outputs.drone)
        self.recording.add(outputs.vehicle, is_drone=False)
        self.recording.add(outputs.rotors)
