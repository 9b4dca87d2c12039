"""Recordings that cannot be replayed, since they are damaged or somebody else's, are told in one line."""

from pathlib import Path

import pytest

from companion.config.companion import CompanionConfig
from companion.recording.folder import recording_store
from companion.recording.records import InputKind
from link.errors import UserError
from link.payloads.decklander_msgs import RosMessage, bytes_array, ros_message
from link.zenoh.keys import Keys
from scenarios.recordings import replay as replay_module
from scenarios.recordings.replay import read_flights, replay

KEYS = Keys()
NOW_NS = 1_700_000_000_000_000_000


def given(kind: InputKind, data: bytes) -> RosMessage:
    """Return an input as a recording has it."""
    topic = KEYS.record("input")
    return ros_message(topic, "NodeInput", None, sequence=0, kind=int(kind), local_ns=1, key="", data=bytes_array(data))


def replay_of(folder: Path, message: RosMessage) -> None:
    """Record a message and replay that."""
    store = recording_store(folder, CompanionConfig(), KEYS)
    store.add(given(InputKind.POLL, b""), NOW_NS)
    store.add(message, NOW_NS)
    store.close()
    for _, flight in read_flights(folder):
        replay(flight)


@pytest.mark.parametrize(
    ("kind", "data"),
    [
        (InputKind.ALIVE, b""),
        (InputKind.PAD, b"{}"),
        (InputKind.COMMAND, b"\xff"),
        (InputKind.RIVAL, b"\xff\xff\x01"),
    ],
)
def test_input_that_no_companion_has_written_is_told(tmp_path: Path, kind: InputKind, data: bytes) -> None:
    with pytest.raises(UserError, match="holds an input that is none"):
        replay_of(tmp_path, given(kind, data))


@pytest.mark.parametrize("type_name", ["decklander_msgs/msg/StepTime", "decklander_msgs/msg/OfAnotherVersion"])
def test_output_that_is_damaged_or_of_no_known_kind_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, type_name: str
) -> None:
    recording_store(tmp_path, CompanionConfig(), KEYS).close()
    ((_, flight),) = read_flights(tmp_path)
    topic = KEYS.record("step")
    flight.outputs[topic] = [RosMessage(topic=topic, type_name=type_name, payload=b"\x00\x01")]
    monkeypatch.setattr(replay_module, "outputs_of", lambda *_: {topic: [given(InputKind.POLL, b"")]})
    with pytest.raises(UserError, match=r"is damaged .*; it cannot be compared"):
        replay(flight)
