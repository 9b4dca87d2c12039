"""The truth's recording: written as a run goes along; a disk that fails costs samples, and says how many."""

import errno
from pathlib import Path

import pytest

from link.messages import BodyTruth
from link.payloads.decklander_msgs import RosMessage
from link.recording.mcap_writer import McapRecording
from link.zenoh.keys import Keys
from scenarios.catalogue.catalogue import load_scenario
from scenarios.recordings.recording import Recording
from scenarios.recordings.truth_file import TruthFile, read_truth


def truths(count: int) -> list[BodyTruth]:
    return [
        BodyTruth(
            t_ns=1_795_000_000_000_000_000 + 10_000_000 * index,
            position_enu_m=(1.0 + 0.05 * index, 2.0, 3.0),
            orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
            velocity_flu_m_s=(5.0, 0.0, 0.0),
            angular_velocity_flu_rad_s=(0.0, 0.0, 0.1),
        )
        for index in range(count)
    ]


def truth_file(folder: Path) -> TruthFile:
    return TruthFile(folder, load_scenario("straight_5"), 3, Keys())


def test_truth_is_read_as_it_was_written(tmp_path: Path) -> None:
    recording, file = Recording(drone=truths(3), vehicle=truths(2)), truth_file(tmp_path)
    file.take(recording)
    recording.drone = truths(5)
    file.take(recording)
    file.close()
    found = read_truth(tmp_path, Keys())
    assert (found.drone, found.vehicle, file.dropped) == (truths(5), truths(2), 0)


def test_truth_of_a_run_that_is_killed_is_there_up_to_its_last_second(tmp_path: Path) -> None:
    file = truth_file(tmp_path)
    file.take(Recording(drone=truths(1000)))
    found = read_truth(tmp_path, Keys()).drone
    assert 800 < len(found) < 1000
    assert found == truths(len(found))
    file.close()


def test_full_disk_costs_samples_which_are_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: RosMessage) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(McapRecording, "add", refuse)
    file = truth_file(tmp_path)
    file.take(Recording(drone=truths(7)))
    file.close()
    assert file.dropped == 7
