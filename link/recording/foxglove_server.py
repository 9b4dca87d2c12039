"""Messages live to Foxglove: the only place that knows its library. Its own threads serve the connections."""

from typing import Any

from link.errors import UserError
from link.payloads.decklander_msgs import RosMessage, definition
from link.program.extras import require

DEFAULT_PORT = 8765
"""Foxglove's own."""

_BACKLOG = 1000  # messages that wait for a slow reader; then it misses the oldest
_HOST = "127.0.0.1"
_QUIET = "CRITICAL"  # of whoever speaks another protocol to the port it would write on the terminal


class FoxgloveServer:
    """Serves each topic that is added, with its ROS 2 schema, to whoever subscribes to it.

    Args:
        port: on this machine only; 0 is any free one.

    Raises:
        UserError: the library is not installed, or the port is in use.
    """

    def __init__(self, port: int) -> None:
        require("foxglove", "--foxglove")
        import foxglove  # noqa: PLC0415 (it is of an extra)

        foxglove.set_log_level(_QUIET)
        self._library = foxglove
        self._context = foxglove.Context()
        self._channels: dict[str, Any] = {}
        try:
            self._server = foxglove.start_server(
                name="decklander", host=_HOST, port=port, context=self._context, message_backlog_size=_BACKLOG
            )
        except RuntimeError as error:  # the library's own, and its only one
            why = "the port is in use" if "in use" in str(error) else str(error)
            raise UserError(f"--foxglove {port}: {why}; choose another port") from None

    @property
    def port(self) -> int:
        """That is listened on."""
        return int(self._server.port)

    def add(self, message: RosMessage, log_ns: int) -> None:
        """Send a message of `log_ns` to who listens to its topic; nobody is waited for."""
        channel = self._channels.get(message.topic)
        if channel is None:
            schema = self._library.Schema(
                name=message.type_name, encoding="ros2msg", data=definition(message.type_name).encode()
            )
            channel = self._library.Channel(
                f"/{message.topic}", schema=schema, message_encoding="cdr", context=self._context
            )
            self._channels[message.topic] = channel
        channel.log(message.payload, log_time=log_ns)

    def close(self) -> None:
        """End all connections."""
        self._server.stop()
