"""The truth of a run beside the companion's recording: `truth_000.mcap`, written as the run goes along."""

from collections.abc import Sequence
from pathlib import Path

from link.errors import UserError
from link.messages import BodyTruth, RotorTruth
from link.payloads import cdr
from link.payloads.decklander_msgs import RosMessage
from link.program.toml_config import dump_toml
from link.recording.mcap_reader import read_messages, recording_files
from link.recording.mcap_writer import McapRecording, RecordingSpec
from link.recording.recorder import DirectRecorder
from link.zenoh.keys import Keys
from scenarios.config import Scenario
from scenarios.recordings.recording import Recording
from scenarios.recordings.versions import versions

STEM = "truth"

Sample = BodyTruth | RotorTruth
_Entry = tuple[int, str, Sample]  # when, on which topic, what


class TruthFile:
    """A run's truth with its scenario, seed and versions; a disk that fails costs samples, which are counted.

    Args:
        folder: of the run.
        scenario: what is flown.
        seed: of everything random.
        keys: of the Zenoh contract.

    Raises:
        UserError: the folder cannot be written.
    """

    def __init__(self, folder: Path, scenario: Scenario, seed: int, keys: Keys) -> None:
        spec = RecordingSpec(
            folder=folder,
            stem=STEM,
            metadata={"seed": str(seed), **versions()},
            attachments={"scenario.toml": dump_toml(scenario)},
        )
        self._recorder = DirectRecorder(_TruthSink(McapRecording(spec)))
        self._keys = (keys.drone_truth, keys.vehicle_truth, keys.drone_rotors)
        self._written = [0, 0, 0]

    @property
    def dropped(self) -> int:
        """How many samples were not written."""
        return self._recorder.dropped

    def take(self, recording: Recording) -> None:
        """Write what `recording` holds beyond what was written before, in the order of time."""
        new: list[_Entry] = []
        kinds: tuple[Sequence[Sample], ...] = (recording.drone, recording.vehicle, recording.rotors)
        for index, (key, samples) in enumerate(zip(self._keys, kinds, strict=True)):
            new += [(sample.t_ns, key, sample) for sample in samples[self._written[index] :]]
            self._written[index] = len(samples)
        for entry in sorted(new, key=lambda entry: entry[:2]):
            self._recorder.put(entry)

    def close(self) -> None:
        """Complete the file."""
        self._recorder.close()


class _TruthSink:
    """Turns samples into messages of a recording."""

    def __init__(self, file: McapRecording) -> None:
        self._file = file
        self.close = file.close

    def write(self, entry: _Entry) -> None:
        t_ns, topic, sample = entry
        message = RosMessage(topic=topic, type_name=cdr.ROS_TYPES[type(sample)], payload=cdr.encode(sample))
        self._file.add(message, t_ns)


def read_truth(folder: Path, keys: Keys) -> Recording:
    """Return the truth of the run in `folder`.

    Raises:
        UserError: there is none, or it is damaged.
    """
    recording = Recording()
    for recorded in read_messages(recording_files(folder, STEM)):
        message = recorded.message
        try:
            if message.topic == keys.drone_rotors:
                recording.add(cdr.decode(RotorTruth, message.payload))
            else:
                recording.add(cdr.decode(BodyTruth, message.payload), is_drone=message.topic == keys.drone_truth)
        except cdr.PayloadError as error:
            raise UserError(f"{folder}: its truth is damaged ({error})") from None
    return recording
