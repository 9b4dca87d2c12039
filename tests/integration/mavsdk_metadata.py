"""What MAVSDK finds out about the companion's parameters: it asks the component, and fetches the files over FTP.

A program of its own, as mavsdk_pilot. `python -m tests.integration.mavsdk_metadata URL` prints the parameters' file.
"""

import sys
import threading

from mavsdk import ComponentType, Configuration, Mavsdk
from mavsdk.plugins.component_metadata import ComponentMetadata, MetadataType, MetadataUpdate

COMPANION = 191
LIMIT_S = 30.0


def main() -> None:
    mavsdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
    mavsdk.add_any_connection(sys.argv[1])
    metadata, is_complete = ComponentMetadata(mavsdk.first_autopilot(LIMIT_S)), threading.Event()

    def hear(update: MetadataUpdate, _: object) -> None:
        if update.type == MetadataType.ALL_COMPLETED:
            is_complete.set()

    metadata.subscribe_metadata_available(hear)
    metadata.request_component(COMPANION)
    if not is_complete.wait(LIMIT_S):
        sys.exit("no metadata in time")
    sys.stdout.write(metadata.get_metadata(COMPANION, MetadataType.PARAMETER).json_metadata + "\n")


if __name__ == "__main__":
    main()
