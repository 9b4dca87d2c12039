"""A Zenoh router as a process of its own: a session in router mode, which routes as `zenohd` does.

python -m tests.integration.zenoh_router ENDPOINT
"""

import json
import sys
import threading

import zenoh


def main() -> None:
    """Route until the process is ended."""
    config = zenoh.Config()
    config.insert_json5("mode", '"router"')
    config.insert_json5("listen/endpoints", json.dumps([sys.argv[1]]))
    config.insert_json5("scouting/multicast/enabled", "false")
    config.insert_json5("timestamping/enabled", "true")  # as rmw_zenohd's own configuration has it
    with zenoh.open(config):
        sys.stdout.write("ready\n")
        sys.stdout.flush()
        threading.Event().wait()


if __name__ == "__main__":
    main()
