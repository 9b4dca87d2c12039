"""Publishes some of the companion's records for views, from a thread of its own.

The messages are those of the recording, by steps: at 50 steps a second, the default, `own` comes 25 times a second,
`estimate` and `forecast` 10 times, `link` once.
A topic that nobody subscribes to is not encoded.
"""

import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from functools import partial
from typing import Protocol

from companion.recording.messages import (
    LONG_EVERY,
    estimate_message,
    estimate_of,
    forecast_message,
    forecast_of,
    link_message,
    own_message,
)
from companion.recording.records import LinkRecord, StepRecord
from companion.runtime.node import CompanionNode
from companion.runtime.recorded_node import link_record, step_record
from link.messages import BodyTruth
from link.payloads import cdr
from link.payloads.decklander_msgs import PACKAGE, RosMessage, typestore
from link.recording.recorder import BackgroundRecorder
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohSession

_OWN_EVERY = 2  # steps
_LINK_EVERY = 50
_CAPACITY = 100  # records; a view wants the newest only
_TYPES = {
    "own": cdr.ROS_TYPES[BodyTruth],
    "estimate": f"{PACKAGE}/VehicleEstimate",
    "forecast": f"{PACKAGE}/Forecast",
    "link": f"{PACKAGE}/LinkStatistics",
}
_Make = Callable[[], RosMessage | None]


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

    def write(self, record: tuple[StepRecord | LinkRecord, int]) -> None:
        """Publish what a record says, each topic if anybody listens to it."""
        for name, make in self._due(*record):
            encoding = f"application/cdr;{_TYPES[name]}"
            if not self._zenoh.is_heard(self._keys.record(name), encoding):
                continue
            message = make()
            if message is not None:
                self._zenoh.publish(message.topic, message.payload, encoding)

    def close(self) -> None:
        """Do nothing: the session belongs to the loop."""

    def _due(self, record: StepRecord | LinkRecord, step: int) -> Iterator[tuple[str, _Make]]:
        """Return the topics that a record is for, each with what makes its message."""
        if isinstance(record, LinkRecord):
            yield "link", partial(link_message, record, self._keys)
            return
        if step % _OWN_EVERY == 0:
            yield "own", partial(_own, record, self._keys)
        if step % LONG_EVERY == 0:
            yield "estimate", partial(_estimate, record, self._keys)
            yield "forecast", partial(_forecast, record, self._keys)


def _own(record: StepRecord, keys: Keys) -> RosMessage | None:
    own = record.inputs.own
    return None if own is None else own_message(own, keys)


def _estimate(record: StepRecord, keys: Keys) -> RosMessage | None:
    estimate = estimate_of(record)
    return None if estimate is None else estimate_message(estimate, keys)


def _forecast(record: StepRecord, keys: Keys) -> RosMessage | None:
    forecast = forecast_of(record)
    return None if forecast is None else forecast_message(forecast, keys)


class Onlooker(Protocol):
    """Somebody who is told of each step; telling returns at once."""

    def tell(self, node: CompanionNode, local_ns: int) -> None:
        """Tell of the step that `node` made at `local_ns`."""

    def close(self) -> None:
        """End it."""


def onlookers(stack: ExitStack, zenoh: ZenohSession, keys: Keys, device: str) -> list[Onlooker]:
    """Return who looks on, to be closed with `stack`."""
    found: list[Onlooker] = [LiveState(zenoh, keys)]
    if sys.stdout.isatty():
        from companion.runtime.terminal import Terminal  # noqa: PLC0415 (its library takes memory that a flight need not)

        found.append(Terminal(device))
    for one in found:
        stack.callback(one.close)
    return found
