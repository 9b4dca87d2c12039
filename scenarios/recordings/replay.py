"""Replay: what a recorded companion was given, given to one of now, and what both made of it compared."""

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from companion.config.companion import CompanionConfig
from companion.core.data import Rival
from companion.recording.folder import CONFIG_NAME, STEM
from companion.recording.records import InputKind, InputRecord
from companion.recording.sink import CompanionSink
from companion.runtime.build import build_node
from companion.runtime.node import CompanionNode
from link.errors import UserError
from link.messages import Order, PadGeometry
from link.payloads import json_messages
from link.payloads.checks import PayloadError
from link.payloads.decklander_msgs import RosMessage, fields_of
from link.program.toml_config import parse_toml, validate
from link.recording.mcap_reader import RecordingHead, read_head, read_messages, recordings
from link.recording.recorder import DirectRecorder
from link.zenoh.keys import Keys
from scenarios.recordings.comparison import Comparison, FieldDifference

_SHOWN = 20  # differences of a recording
OUTPUTS = ("own", "step", "setpoint", "estimate", "forecast", "plan")
"""The topics that are compared; what else is recorded goes in, or is of the clocks and links of its time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Replay:
    """What came of a replay.

    Attributes:
        steps: that were recorded.
        fields: values compared.
        differences: largest first; empty when all are equal.
        missing_inputs: that the recording has lost, so that no replay of it can be exact.
    """

    steps: int
    fields: int
    differences: tuple[FieldDifference, ...]
    missing_inputs: int

    def to_json(self) -> dict[str, Any]:
        """Return the result as a table of plain values; `largest` is null where it is no number."""
        rows = [
            {**asdict(one), "largest": one.largest if math.isfinite(one.largest) else None} for one in self.differences
        ]
        return {**asdict(self), "equal": not self.differences, "differences": rows}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Flight:
    """A companion's recording, read: its inputs in order, and its output messages by topic."""

    head: RecordingHead
    keys: Keys
    inputs: tuple[InputRecord, ...]
    outputs: dict[str, list[RosMessage]]

    @property
    def config(self) -> CompanionConfig:
        """The companion's configuration."""
        source = f"{CONFIG_NAME} of {self.head.path}"
        return validate(CompanionConfig, parse_toml(self.head.attachment(CONFIG_NAME), source), source=source)


class _MessageLists:
    """A store of messages in memory, by topic."""

    def __init__(self) -> None:
        self.by_topic: dict[str, list[RosMessage]] = defaultdict(list)

    def add(self, message: RosMessage, _: int) -> None:
        """Keep a message."""
        self.by_topic[message.topic].append(message)

    def close(self) -> None:
        """Do nothing: it is complete at any time."""


def read_flights(folder: Path) -> Iterator[tuple[str, Flight]]:
    """Return the companion's recordings in `folder` with their names: one for each time that it was started.

    Raises:
        UserError: there is none.
    """
    found = recordings(folder, STEM)
    for files in found:
        yield folder.name if len(found) == 1 else f"{folder.name}/{files[0].name}", _read(files)


def _read(files: list[Path]) -> Flight:
    head = read_head(files[0])
    if CONFIG_NAME not in head.attachments:
        raise UserError(f"{files[0]}: holds no configuration; it is no recording of a companion's")
    keys = head.keys
    wanted = {keys.record(name) for name in OUTPUTS}
    outputs: dict[str, list[RosMessage]] = defaultdict(list)
    inputs: list[InputRecord] = []
    for recorded in read_messages(files):
        message = recorded.message
        if message.topic in wanted:
            outputs[message.topic].append(message)
        elif message.topic == keys.record("input"):
            inputs.append(_input(message, head.path))
    return Flight(head=head, keys=keys, inputs=tuple(inputs), outputs=dict(outputs))


def replay(flight: Flight, config: CompanionConfig | None = None) -> Replay:
    """Give the inputs of `flight` to a companion of now and compare.

    Args:
        flight: as recorded.
        config: in place of the recorded one.

    Raises:
        UserError: a recorded output is none.
    """
    flown = outputs_of(flight, flight.config if config is None else config)
    comparison = Comparison()
    for name in OUTPUTS:
        topic = flight.keys.record(name)
        try:
            comparison.compare(name, flight.outputs.get(topic, []), flown.get(topic, []))
        except PayloadError as error:
            raise UserError(f"{flight.head.path}: is damaged ({error}); it cannot be compared") from None
    sequences = [record.sequence for record in flight.inputs]
    expected = sequences[-1] + 1 if sequences else 0
    return Replay(
        steps=len(flight.outputs.get(flight.keys.record("step"), [])),
        fields=comparison.fields,
        differences=comparison.differences(),
        missing_inputs=expected - len(sequences),
    )


def outputs_of(flight: Flight, config: CompanionConfig) -> dict[str, list[RosMessage]]:
    """Return the messages that a companion of now records when it gets the inputs of `flight`."""
    store = _MessageLists()
    recorder = DirectRecorder(CompanionSink(store, flight.keys))
    node = build_node(
        config,
        flight.keys,
        system_id=flight.head.number("system_id", 1, 255),
        dry_run=flight.head.value("dry_run") == "true",
        is_component=True,  # where ground stations were not heard, none has said anything
        recorder=recorder,
    )
    for record in flight.inputs:
        give(node, record)
    recorder.close()
    return store.by_topic


def give(node: CompanionNode, record: InputRecord) -> None:
    """Give a recorded input to a node, and take what a poll brings, as the loop would."""
    match record.kind:
        case InputKind.MAVLINK | InputKind.DATAGRAM:
            is_datagram = record.kind is InputKind.DATAGRAM
            node.receive_mavlink(record.data, record.local_ns, is_datagram=is_datagram)
        case InputKind.SAMPLE:
            node.receive_sample(record.key, record.data)
        case InputKind.PAD:
            node.receive_pad(json_messages.decode(PadGeometry, record.data))
        case InputKind.PAD_DOUBTED:
            node.doubt_pad()
        case InputKind.ALIVE:
            node.receive_liveliness(alive=bool(record.data[0]))
        case InputKind.RIVAL:
            name, is_own = record.data[:-1].decode(), bool(record.data[-1:] == b"\x01")
            node.receive_rival(Rival(drone=name, is_this_drone=is_own) if record.data else None)
        case InputKind.COMMAND:
            order = json_messages.decode(Order, record.data)
            node.request(order.command, order.station)
        case InputKind.LEAVE:
            node.leave()
        case InputKind.POLL:
            node.poll(record.local_ns)
            node.take_frames()
            node.take_publications()
            node.take_replies()
            node.autopilot.take_texts()


def _input(message: RosMessage, path: Path) -> InputRecord:
    try:
        fields = fields_of(message.payload, message.type_name)
        record = InputRecord(
            sequence=int(fields["sequence"]),
            kind=InputKind(fields["kind"]),
            local_ns=int(fields["local_ns"]),
            key=fields["key"],
            data=bytes(fields["data"]),
        )
        _check(record)
    except (KeyError, TypeError, ValueError) as error:
        raise UserError(f"{path}: holds an input that is none ({error}); it cannot be replayed") from error
    return record


def _check(record: InputRecord) -> None:
    """Check what a node takes as it is: all else goes through a door that strangers knock at, too.

    Raises:
        ValueError: no companion has written this.
    """
    match record.kind:
        case InputKind.PAD:
            json_messages.decode(PadGeometry, record.data)
        case InputKind.ALIVE if not record.data:
            raise ValueError("whether the vehicle is there is not said")
        case InputKind.RIVAL:
            record.data[:-1].decode()
        case InputKind.COMMAND:
            json_messages.decode(Order, record.data)
        case _:
            pass


def text_lines(results: Iterable[tuple[str, Replay]]) -> list[str]:
    """Return the results as lines for people."""
    lines: list[str] = []
    for name, result in results:
        verdict = "equal" if not result.differences else f"{len(result.differences)} fields differ"
        lines.append(f"{name}: {result.steps} steps, {result.fields} values: {verdict}")
        if result.missing_inputs:
            lines.append(
                f"  {result.missing_inputs} inputs are missing in the recording: it cannot be replayed exactly"
            )
        lines += [
            f"  {one.field:44}{one.largest:12.4g}  in {one.count} messages, first in {one.first}"
            for one in result.differences[:_SHOWN]
        ]
    return lines
