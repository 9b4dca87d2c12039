"""What a view is told of a companion's inside: some of its records, published from a thread of their own.

The messages are those of the recording, by steps: at 50 steps a second, the default, `own` comes 25 times a second,
`estimate` and `forecast` 10 times, `link` once.
Where nobody subscribes to them nothing is encoded.
"""

from collections.abc import Iterator

from companion.node import CompanionNode
from companion.recording.messages import LONG_EVERY, link_message, own_message, vehicle_messages
from companion.recording.node_records import link_record, step_record
from companion.recording.records import LinkRecord, StepRecord
from link import cdr
from link.keys import Keys
from link.messages import BodyTruth
from link.recorder import BackgroundRecorder
from link.ros_records import RosMessage, typestore
from link.zenoh_session import ZenohSession

_OWN_EVERY = 2  # steps
_LINK_EVERY = 50
_CAPACITY = 100  # records; a view wants the newest only


class LiveState:
    """Tells who looks on, while the loop goes on.

    Args:
        zenoh: an open session.
        keys: of the Zenoh contract.
    """

    def __init__(self, zenoh: ZenohSession, keys: Keys) -> None:
        self._recorder = BackgroundRecorder(_Sink(zenoh, keys), capacity=_CAPACITY)
        self._steps = 0

    def tell(self, node: CompanionNode, local_ns: int) -> None:
        """Tell of the step that `node` made at `local_ns`."""
        self._steps += 1
        if self._steps % _OWN_EVERY == 0 or self._steps % LONG_EVERY == 0:
            self._put(step_record(node, local_ns))
        if self._steps % _LINK_EVERY == 0 and node.inputs is not None:
            self._put(link_record(node, node.inputs.t_ns, self._recorder.dropped))

    def _put(self, record: StepRecord | LinkRecord | None) -> None:
        if record is not None:
            self._recorder.put((record, self._steps))

    def close(self) -> None:
        """Tell the last."""
        self._recorder.close()


class _Sink:
    def __init__(self, zenoh: ZenohSession, keys: Keys) -> None:
        typestore()  # not in flight: it takes a while to load
        self._zenoh = zenoh
        self._keys = keys
        self._own_encoding = cdr.encoding_of(BodyTruth)

    def write(self, record: tuple[StepRecord | LinkRecord, int]) -> None:
        """Publish what a record says, if anybody listens."""
        if not self._zenoh.is_heard(self._keys.record("own"), self._own_encoding):
            return
        for message in self._messages(*record):
            self._zenoh.publish(message.topic, message.payload, f"application/cdr;{message.type_name}")

    def close(self) -> None:
        """Do nothing: the session belongs to the loop."""

    def _messages(self, record: StepRecord | LinkRecord, step: int) -> Iterator[RosMessage]:
        if isinstance(record, LinkRecord):
            yield link_message(record, self._keys)
            return
        if record.inputs.own is not None and step % _OWN_EVERY == 0:
            yield own_message(record.inputs.own, self._keys)
        if step % LONG_EVERY:
            return
        yield from vehicle_messages(record, self._keys)
