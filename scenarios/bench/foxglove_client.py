"""A client that reads all that a Foxglove server on this machine sends, and prints how late it came.

It says when it is connected, and the latencies when the server ends. What was recorded before the first channel was
there does not count: a companion keeps that back until it knows UTC.
Source: https://github.com/foxglove/foxglove-sdk, the WebSocket protocol.
"""

import json
import struct
import sys
import time
from typing import Final

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect
from websockets.typing import Subprotocol

from scenarios.lockstep.stopwatch import quantiles_ms

CONNECTED: Final = "connected"

_HEAD: Final = struct.Struct("<BIQ")
"""Of a message: the kind, the subscription, and the log time in ns."""


def main() -> None:
    """Read until the server ends."""
    uri = f"ws://127.0.0.1:{sys.argv[1]}"
    latencies_s: list[float] = []
    with connect(uri, subprotocols=[Subprotocol("foxglove.sdk.v1")], max_size=None) as client:
        sys.stdout.write(f"{CONNECTED}\n")
        sys.stdout.flush()
        subscribed_ns: int | None = None
        while True:
            try:
                frame = client.recv()
            except ConnectionClosed:
                break
            now_ns = time.time_ns()
            if isinstance(frame, bytes):
                _, _, log_ns = _HEAD.unpack_from(frame)
                if subscribed_ns is not None and log_ns >= subscribed_ns:
                    latencies_s.append((now_ns - log_ns) * 1e-9)
                continue
            told = json.loads(frame)
            if told["op"] == "advertise":
                subscribed_ns = subscribed_ns or now_ns
                wanted = [{"id": one["id"], "channelId": one["id"]} for one in told["channels"]]
                client.send(json.dumps({"op": "subscribe", "subscriptions": wanted}))
    sys.stdout.write(json.dumps({"messages": len(latencies_s), "latency_ms": quantiles_ms(latencies_s)}))


if __name__ == "__main__":
    main()
