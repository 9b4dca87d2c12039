"""What a person at the companion's terminal sees: a panel, drawn from a thread of its own beside the loop."""

from rich.console import Console

from companion.recording.records import LinkRecord
from companion.runtime.node import CompanionNode
from companion.runtime.recorded_node import link_record
from link.messages import LandingStatus, LinkStatus
from link.program.screen import Screen
from link.program.status_rows import link_rows, number
from link.recording.recorder import BackgroundRecorder
from link.records import replace

_EVERY = 25  # steps: twice a second
_CAPACITY = 2  # a terminal that is stopped gets nothing, and holds nobody up
View = tuple[LandingStatus, float | None, LinkRecord]


class Terminal:
    """Shows the phase, what it waits for, where the drone is against the pad, and how the links do.

    Args:
        device: of the MAVLink link, for the title.
        console: to draw on, stdout's by default.
    """

    def __init__(self, device: str, console: Console | None = None) -> None:
        self._recorder = BackgroundRecorder(_Sink(Screen(f"companion on {device}", console)), capacity=_CAPACITY)
        self._steps = 0

    def tell(self, node: CompanionNode, _: int) -> None:
        """Tell of the step that `node` has made."""
        self._steps += 1
        if self._steps % _EVERY and (node.outputs is None or node.outputs.text is None):
            return
        if node.outputs is not None and node.inputs is not None:
            model = node.memory.model
            error_m = None if model.reference is None else model.tracking.error_m
            record = link_record(node, node.inputs.t_ns, self._recorder.dropped)
            status = replace(node.outputs.status, links=LinkStatus(refused=node.vehicle.refused_lately()))
            self._recorder.put((status, error_m, record))

    def close(self) -> None:
        """Leave the last panel where it is."""
        self._recorder.close()


class _Sink:
    def __init__(self, screen: Screen) -> None:
        self._screen = screen
        screen.start()

    def write(self, record: View) -> None:
        """Draw."""
        status, error_m, link = record
        codec = link.session.codec
        rows = link_rows(
            codec.messages_received, codec.messages_sent, codec.lost_messages, codec.bad_bytes, link.zenoh_bad_payloads
        )
        self._screen.show(status, [("behind its setpoint", number(error_m, "m")), *rows])

    def close(self) -> None:
        """Give the terminal back."""
        self._screen.stop()
