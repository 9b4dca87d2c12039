"""A companion node that records its inputs and its steps' outputs."""

from companion.core.data import Rival
from companion.landing.state.step_data import System
from companion.recording.records import InputKind, InputRecord, LinkRecord, StepRecord, StepTimeRecord
from companion.runtime.node import CompanionNode
from link.mavlink.session import MavlinkSession
from link.messages import Command, Order, PadGeometry, Station
from link.payloads import json_messages as json_payloads
from link.recording.recorder import Recorder
from link.zenoh.keys import Keys


def step_record(node: CompanionNode, local_ns: int) -> StepRecord | None:
    """Return the step that was made at `local_ns`, None before the first one."""
    if node.inputs is None or node.outputs is None:
        return None
    clock = node.autopilot.session.clock
    return StepRecord(
        local_ns=local_ns,
        utc_known=clock.is_utc_known and clock.local_to_boot is not None,
        inputs=node.inputs,
        outputs=node.outputs,
        estimator=node.system.estimator,
        estimator_memory=node.memory.vehicle.estimator,
    )


def link_record(node: CompanionNode, t_ns: int, records_dropped: int) -> LinkRecord:
    """Return the counters of both links at `t_ns`."""
    return LinkRecord(
        t_ns=t_ns,
        session=node.autopilot.session.statistics,
        zenoh_bad_payloads=node.bad_payloads,
        records_dropped=records_dropped,
    )


_LINK_NS = 1_000_000_000  # between two records of the counters


class RecordingNode(CompanionNode):
    """A `CompanionNode` with a recorder; what it does is the same.

    Args:
        system: configuration, estimator and guidance law.
        keys: of the Zenoh contract.
        session: to the autopilot.
        recorder: takes the records.
        dry_run: send neither setpoints nor commands.
        publishes: put status and plan on Zenoh.
        is_component: hear ground stations.
    """

    def __init__(
        self,
        system: System,
        keys: Keys,
        session: MavlinkSession,
        recorder: Recorder,
        *,
        dry_run: bool = False,
        publishes: bool = True,
        is_component: bool = False,
    ) -> None:
        super().__init__(system, keys, session, dry_run=dry_run, publishes=publishes, is_component=is_component)
        self._recorder = recorder
        self._sequence = 0
        self._local_ns = 0
        self._link_ns: int | None = None
        self._recorded_alive: bool | None = None
        self._recorded_rival: Rival | None = None

    @property
    def records_lost(self) -> int:
        """How many could not be written."""
        return self._recorder.dropped

    @property
    def why_lost(self) -> str:
        """Why the first of them could not be; empty while there is none."""
        return self._recorder.why_dropped

    def receive_mavlink(self, data: bytes, local_ns: int, *, is_datagram: bool = False) -> None:
        """Take bytes of the autopilot's link.

        Raises:
            UserError: the autopilot is of a kind that cannot be flown.
        """
        self._local_ns = local_ns
        self._record(InputKind.DATAGRAM if is_datagram else InputKind.MAVLINK, data)
        super().receive_mavlink(data, local_ns, is_datagram=is_datagram)

    def receive_sample(self, key: str, payload: bytes) -> None:
        """Take a Zenoh sample."""
        self._record(InputKind.SAMPLE, payload, key)
        super().receive_sample(key, payload)

    def receive_pad(self, pad: PadGeometry) -> None:
        """Take the vehicle's description of its pad."""
        self._record(InputKind.PAD, json_payloads.encode(pad))
        super().receive_pad(pad)

    def doubt_pad(self) -> None:
        """Take that the vehicle describes another pad now; only its change is recorded."""
        if not self.vehicle.is_pad_doubted:
            self._record(InputKind.PAD_DOUBTED, b"")
        super().doubt_pad()

    def receive_liveliness(self, *, alive: bool) -> None:
        """Take the state of the vehicle's liveliness token; only its changes are recorded."""
        if alive is not self._recorded_alive:
            self._recorded_alive = alive
            self._record(InputKind.ALIVE, bytes([alive]))
        super().receive_liveliness(alive=alive)

    def receive_rival(self, rival: Rival | None) -> None:
        """Take who else was there first; only its changes are recorded."""
        if rival != self._recorded_rival:
            self._recorded_rival = rival
            self._record(InputKind.RIVAL, b"" if rival is None else rival.drone.encode() + bytes([rival.is_this_drone]))
        super().receive_rival(rival)

    def request(self, command: Command, station: Station | None = None) -> None:
        """Take an operator's command."""
        self._record(InputKind.COMMAND, json_payloads.encode(Order(command=command, station=station)))
        super().request(command, station)

    def leave(self) -> None:
        """Ask the autopilot, from the next step on, to hover by itself."""
        self._record(InputKind.LEAVE, b"")
        super().leave()

    def poll(self, local_ns: int) -> bool:
        """Do what is due; return whether a step was made."""
        self._local_ns = local_ns
        self._record(InputKind.POLL, b"")
        stepped = super().poll(local_ns)
        record = step_record(self, local_ns) if stepped else None
        if record is not None:
            self._recorder.put(record)
            self._record_link(record.inputs.t_ns)
        return stepped

    def record_step_time(self, state_to_setpoint_s: float) -> None:
        """Take how long the loop needed for the last step."""
        if self.inputs is not None:
            self._recorder.put(StepTimeRecord(t_ns=self.inputs.t_ns, state_to_setpoint_s=state_to_setpoint_s))

    def _record(self, kind: InputKind, data: bytes, key: str = "") -> None:
        self._recorder.put(InputRecord(sequence=self._sequence, kind=kind, local_ns=self._local_ns, key=key, data=data))
        self._sequence += 1

    def _record_link(self, t_ns: int) -> None:
        if self._link_ns is not None and abs(t_ns - self._link_ns) < _LINK_NS:
            return
        self._link_ns = t_ns
        self._recorder.put(link_record(self, t_ns, self._recorder.dropped))
