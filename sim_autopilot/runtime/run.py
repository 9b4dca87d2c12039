"""Opens what the wire loop needs, says when it is ready, and closes it again."""

import sys
import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass

import numpy as np
import structlog

from link.payloads import cdr
from link.transports.opening import open_transport
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, open_session
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.runtime.config import SimAutopilotConfig
from sim_autopilot.runtime.loop import Links, WireLoop
from sim_autopilot.runtime.node import STEP_NS, AutopilotNode
from sim_autopilot.runtime.physics import air_model
from sim_autopilot.runtime.vehicle_view import VehicleView


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """How to run.

    Attributes:
        devices: of the MAVLink links.
        speed: simulated seconds a wall second, 0 for as many as it can.
        keys: of the Zenoh contract.
        zenoh: how to meet others.
    """

    devices: Sequence[str]
    speed: float
    keys: Keys
    zenoh: ZenohOptions


def run(settings: SimAutopilotConfig, autopilot: AutopilotConfig, options: RunOptions) -> None:
    """Run the simulated autopilot until interrupted.

    Raises:
        UserError: a device or a Zenoh endpoint cannot be opened.
    """
    log = structlog.wrap_logger(structlog.PrintLogger(sys.stderr))
    with ExitStack() as stack:
        transports = [stack.enter_context(open_transport(device, is_patient=True)) for device in options.devices]
        zenoh = stack.enter_context(open_session(options.zenoh))
        AutopilotNode(autopilot, 0).step(None, np.zeros(3))  # loads the compiled kernels before time starts to count
        cdr.load()
        node = AutopilotNode(autopilot, time.time_ns() // STEP_NS * STEP_NS)
        vehicle = VehicleView(zenoh, options.keys, settings.vehicle)
        links = Links(keys=options.keys, transports=transports, zenoh=zenoh)
        loop = WireLoop(node, links, vehicle, air_model(settings), speed=options.speed)
        log.info("ready", mavlink=" ".join(options.devices), firmware=settings.firmware, speed=options.speed)
        loop.run()
