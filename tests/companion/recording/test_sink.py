"""What waits in a companion's recording until UTC is known."""

import pytest

from companion.recording.records import InputKind, InputRecord
from companion.recording.sink import CompanionSink
from link.payloads.decklander_msgs import RosMessage
from link.zenoh.keys import Keys

KEYS = Keys()


class Store:
    """Counts the messages that it is given."""

    def __init__(self) -> None:
        self.count = 0

    def add(self, message: RosMessage, log_ns: int) -> None:
        del message, log_ns
        self.count += 1

    def close(self) -> None:
        """Nothing is open."""


@pytest.mark.parametrize(("size", "waiting_max"), [(0, 2_000), (1_000, 2_000), (1_000_000, 20)])
def test_inputs_that_wait_for_utc_are_bounded_in_number_and_bytes(size: int, waiting_max: int) -> None:
    store = Store()
    sink = CompanionSink(store, KEYS)
    data = bytes(size)
    for sequence in range(1, waiting_max + 1):
        assert store.count == 0
        sink.write(InputRecord(sequence=sequence, kind=InputKind.MAVLINK, local_ns=sequence, data=data))
    assert store.count == waiting_max
