"""Status and plan on their way out, by a thread of their own: a viewer that takes nothing holds up no setpoint.

Zenoh sends to one peer after the other, and waits for each whose queue is full until it gives it up: a computer out of
radio range costs 0.2 s, five of them a second, after which an autopilot counts its setpoints as lost.
"""

from typing import Protocol

from link.recording.recorder import BackgroundRecorder, Recorder
from link.zenoh.keys import Publication

_CAPACITY = 64  # publications: some seconds of statuses and plans


class Publishes(Protocol):
    """What publications go out by, such as a Zenoh session."""

    def publish(self, key: str, payload: bytes, encoding: str) -> None:
        """Send `payload` to whoever subscribes to `key`; may wait."""


def outbox(session: Publishes) -> Recorder:
    """Return what publishes each `Publication` that is put into it by the session, in order.

    Where too many wait it drops the oldest: who looks again wants to know what is now.
    """
    return BackgroundRecorder(_Sink(session), capacity=_CAPACITY, keeps_newest=True)


class _Sink:
    def __init__(self, session: Publishes) -> None:
        self._session = session

    def write(self, publication: Publication) -> None:
        """Publish one."""
        self._session.publish(publication.key, publication.payload, publication.encoding)

    def close(self) -> None:
        """Do nothing: the session belongs to the loop."""
