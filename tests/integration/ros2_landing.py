"""A landing on a vehicle that speaks ROS 2, through a router, each a process of its own.

python -m tests.integration.ros2_landing SEEDS    prints a line of JSON for each
"""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from link.ros2.options import Ros2Options
from link.ros2.session import open_ros2_session
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from scenarios.scoring.score import Score
from sim_autopilot.runtime.config import DatumConfig
from tests.integration.observer import PASSES_SOON, Observer
from tests.integration.programs import Programs
from tests.integration.ros_vehicle import DOMAIN

MAP = """
[vehicle]
odometry = "/localization/kinematic_state"
odometry_origin = [{latitude_deg}, {longitude_deg}, {altitude_m}]
[pad]
size_m = [1.5, 1.5]
height_m = 1.5
"""


def land(folder: Path, seed: int, look: Callable[[Programs, tuple[str, ...]], None] = lambda *_: None) -> Score:
    """Land once.

    Args:
        folder: for the map of the topics.
        seed: of the vehicle's errors, of wind and gusts.
        look: called in flight, with what starts programs and the options that connect them.
    """
    port, endpoint = free_udp_port(), free_tcp_endpoint()
    topics = folder / "topics.toml"
    topics.write_text(MAP.format(**DatumConfig().model_dump()), encoding="utf-8")
    client = ("-m", "client", "-e", endpoint)
    ros2 = ("--ros2", str(DOMAIN), "--ros2-map", str(topics))
    by_router = ZenohOptions(mode="client", connect=(endpoint,))
    with Programs() as programs:
        programs.start("tests.integration.zenoh_router", endpoint).out.wait_for("ready")
        with open_ros2_session(by_router, Ros2Options(domain=DOMAIN), Keys(), ("/tests", "bystander")) as zenoh:
            programs.start("tests.integration.ros_vehicle", endpoint, str(seed)).out.wait_for("ready")
            bystander = Observer(zenoh, Keys())
            listening = ("--mavlink", f"udpin:127.0.0.1:{port}", "--start", "--use-sim-time")
            programs.start("companion", *listening, *ros2, *client)
            speaking = ("--mavlink", f"udpout:127.0.0.1:{port}", "--seed", str(seed))
            programs.start("scenarios", "world", f"{PASSES_SOON}+wind=nominal", *speaking, *client)
            bystander.wait_for_relative_position()
            look(programs, client)
            return bystander.wait_for_end()


def main() -> None:
    """Land with each seed."""
    for seed in range(1, 1 + int(sys.argv[1])):
        with TemporaryDirectory() as name:
            score = land(Path(name), seed)
        contact = score.touchdown
        error_m = None if contact is None else round(contact.horizontal_error_m, 3)
        row = {"seed": seed, "tier": score.tier.value, "reason": score.reason, "error_m": error_m}
        sys.stdout.write(json.dumps(row) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
