"""The pad as the map describes it, its place from static transforms where the map leaves that to them."""

from link.messages import PadGeometry
from link.payloads.checks import PayloadError
from link.ros2 import foreign
from link.ros2.topic_map import PadTopics
from link.zenoh.inbox import Inbox

_FRAMES_MAX = 1000  # of a robot; what is told beyond them is no robot's


class PadSource:
    """Tells the pad once it is known.

    Args:
        pad: of the map.
        transforms: into which static transforms come; None where the map says the place.
    """

    def __init__(self, pad: PadTopics, transforms: Inbox | None) -> None:
        self._pad = pad
        self._transforms = transforms
        self._known: foreign.Transforms = {}

    def geometry(self) -> PadGeometry | None:
        """Return the pad, None while the transforms do not say where it is."""
        pad, lever = self._pad, self._pad.antenna_to_pad_m
        if self._transforms is not None:
            for sample in self._transforms.take():
                self._learn(sample.payload)
            lever = foreign.lever(self._known, pad.vehicle_frame, pad.antenna_frame, pad.frame)
        if lever is None:
            return None
        return PadGeometry(size_m=pad.size_m, height_m=pad.height_m, antenna_to_pad_m=lever)

    def _learn(self, payload: bytes) -> None:
        try:
            told = foreign.transforms_of(payload)
        except PayloadError:
            return
        if len(self._known | told) <= _FRAMES_MAX:
            self._known |= told
