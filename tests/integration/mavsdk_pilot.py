"""A landing by MAVSDK alone: started by one command, watched until its last acknowledgement.

A program of its own, since the library keeps threads and prints. `python -m tests.integration.mavsdk_pilot URL`.
"""

import json
import sys
import threading

from mavsdk import ComponentType, Configuration, Mavsdk
from mavsdk.plugins.mavlink_direct import MavlinkDirect, MavlinkMessage
from mavsdk.plugins.telemetry import StatusText, Telemetry

COMPANION = {"target_system": 1, "target_component": 191}
START, TEMPORARILY_REJECTED, IN_PROGRESS = 31010, 1, 5


class Heard:
    """What came in meanwhile; the library calls from threads of its own."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._percents: set[int] = set()
        self._texts: list[str] = []
        self._pads = 0
        self.beat = threading.Event()

    def heartbeat(self, message: MavlinkMessage, _: object) -> None:
        if message.component_id == COMPANION["target_component"]:
            self.beat.set()

    def text(self, text: StatusText, _: object) -> None:
        with self._lock:
            self._texts.append(text.text)

    def acknowledgement(self, message: MavlinkMessage, _: object) -> None:
        fields = json.loads(message.fields_json)
        with self._lock:
            if fields["command"] == START and fields["result"] == IN_PROGRESS:
                self._percents.add(fields["progress"])

    def pad(self, _: MavlinkMessage, __: object) -> None:
        with self._lock:
            self._pads += 1

    def told(self) -> dict[str, object]:
        with self._lock:
            return {"percents": sorted(self._percents), "texts": list(self._texts), "pads": self._pads}


def main() -> None:
    mavsdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
    mavsdk.add_any_connection(sys.argv[1])
    system = mavsdk.first_autopilot(30.0)
    direct, telemetry, heard = MavlinkDirect(system), Telemetry(system), Heard()
    telemetry.subscribe_status_text(heard.text)
    direct.subscribe_message("COMMAND_ACK", heard.acknowledgement)
    direct.subscribe_message("FOLLOW_TARGET", heard.pad)
    direct.subscribe_message("HEARTBEAT", heard.heartbeat)
    fields = COMPANION | {"command": START, "confirmation": 0} | {f"param{number}": 0.0 for number in range(1, 8)}
    start = MavlinkMessage(
        message_name="COMMAND_LONG", target_system_id=1, target_component_id=191, fields_json=json.dumps(fields)
    )
    result = TEMPORARILY_REJECTED
    while result == TEMPORARILY_REJECTED:  # so it answers until it knows drone and vehicle: asked once a heartbeat
        heard.beat.wait()
        heard.beat.clear()
        result = json.loads(direct.send_command(start).fields_json)["result"]
    sys.stdout.write(json.dumps({"result": result} | heard.told()) + "\n")


if __name__ == "__main__":
    main()
