"""Foxglove's server as one of its clients sees it, by the published protocol."""

import json
import socket
import struct
from typing import Any

import pytest
from websockets.sync.client import connect
from websockets.sync.connection import Connection

from link.errors import UserError
from link.payloads.scene import log_message
from link.recording.foxglove_server import FoxgloveServer

T_NS = 1_700_000_000_250_000_000
SUBSCRIPTION = 7
DEADLINE_S = 20.0


def next_json(client: Connection, op: str) -> Any:
    while True:
        frame = client.recv(timeout=DEADLINE_S)
        if isinstance(frame, str) and json.loads(frame)["op"] == op:
            return json.loads(frame)


def test_subscriber_gets_the_schema_and_the_bytes_that_were_added() -> None:
    server = FoxgloveServer(0)
    message = log_message("decklander/drone/companion/log", T_NS, "companion", "chase")
    protocol: Any = "foxglove.sdk.v1"
    with connect(f"ws://127.0.0.1:{server.port}", subprotocols=[protocol], max_size=None) as client:
        server.add(message, T_NS)
        (channel,) = next_json(client, "advertise")["channels"]
        assert (channel["topic"], channel["encoding"]) == ("/decklander/drone/companion/log", "cdr")
        assert (channel["schemaName"], channel["schemaEncoding"]) == ("rcl_interfaces/msg/Log", "ros2msg")
        assert "string msg" in channel["schema"]
        wanted = [{"id": SUBSCRIPTION, "channelId": channel["id"]}]
        client.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
        frame: str | bytes = ""
        while not isinstance(frame, bytes):
            server.add(message, T_NS)  # until the subscription is known to the server
            try:
                frame = client.recv(timeout=0.1)
            except TimeoutError:
                continue
    server.close()
    assert frame[:13] == struct.pack("<BIQ", 1, SUBSCRIPTION, T_NS)
    assert frame[13:] == message.payload


def test_port_in_use_is_a_users_error() -> None:
    server = FoxgloveServer(0)
    with pytest.raises(UserError, match="the port is in use; choose another port"):
        FoxgloveServer(server.port)
    server.close()


def test_who_speaks_another_protocol_is_no_line_on_the_terminal(capfd: pytest.CaptureFixture[str]) -> None:
    server = FoxgloveServer(0)
    with socket.create_connection(("127.0.0.1", server.port), timeout=DEADLINE_S) as stranger:
        stranger.sendall(b"no request\r\n\r\n")
        while stranger.recv(1024):
            pass
    server.close()
    assert capfd.readouterr() == ("", "")
