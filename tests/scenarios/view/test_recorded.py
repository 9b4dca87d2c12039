"""A recording as it is played: what is shown is of the time that is shown."""

from pathlib import Path

from companion.config.companion import CompanionConfig
from companion.recording.folder import recording_store
from link.messages import BodyTruth
from link.payloads import cdr
from link.payloads.decklander_msgs import RosMessage
from link.units import NS_PER_S
from link.zenoh.keys import Keys
from scenarios.view.recorded import RecordedSource

KEYS = Keys()
BEGAN_NS = 1_700_000_000 * NS_PER_S
PERIOD_NS = 50_000_000


def record(folder: Path, times_ns: list[int]) -> None:
    """Record the drone at `times_ns`, by the clock that tells them."""
    recording = recording_store(folder, CompanionConfig(), KEYS)
    for t_ns in times_ns:
        own = BodyTruth(
            t_ns=t_ns,
            position_enu_m=(0.0, 0.0, 0.0),
            orientation_wxyz=(1.0, 0.0, 0.0, 0.0),
            velocity_flu_m_s=(0.0, 0.0, 0.0),
            angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
        )
        kind = cdr.ROS_TYPES[BodyTruth]
        message = RosMessage(topic=KEYS.record("own"), type_name=kind, payload=cdr.encode(own))
        recording.add(message, t_ns)
    recording.close()


def shown_ns(source: RecordedSource, position_s: float) -> int:
    """Return the time of the state that is shown there."""
    source.position_s = position_s
    return source.advance(0.0).t_ns


def test_recording_of_more_than_half_an_hour_is_shown_from_its_beginning(tmp_path: Path) -> None:
    record(tmp_path, [BEGAN_NS + number * PERIOD_NS for number in range(36_100)])
    source = RecordedSource(tmp_path)
    assert source.duration_s == 36_099 * PERIOD_NS / NS_PER_S
    for number in (0, 20_000, 36_099):
        assert shown_ns(source, (number + 0.5) * PERIOD_NS / NS_PER_S) == BEGAN_NS + number * PERIOD_NS


def test_recording_whose_clock_was_set_back_is_shown_from_there(tmp_path: Path) -> None:
    set_back_ns = BEGAN_NS - 3600 * NS_PER_S
    before = [BEGAN_NS + number * PERIOD_NS for number in range(100)]
    record(tmp_path, [*before, *(set_back_ns + number * PERIOD_NS for number in range(100))])
    source = RecordedSource(tmp_path)
    assert source.duration_s == 99 * PERIOD_NS / NS_PER_S
    assert shown_ns(source, 2.01) == set_back_ns + 2 * NS_PER_S
