"""The manoeuvres with an autopilot at an endpoint, in real time, and with the stand-in, in lockstep."""

import time
from collections.abc import Callable
from contextlib import suppress

import numpy as np

from link.errors import UserError
from link.transports.opening import open_transport
from scenarios.firmware.truth import AIRFRAMES
from scenarios.identify.pilot import Flight, Pilot, Stage
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.runtime.build import autopilot_config
from sim_autopilot.runtime.config import DroneConfig, SimAutopilotConfig
from sim_autopilot.runtime.node import AutopilotNode

_POLL_S = 0.002
_LOCAL_NS = 1_700_000_000_000_000_000  # the clock of a flight in lockstep, which is no part of any result
_AIR = np.zeros(3)


def fly_endpoint(device: str, told: Callable[[Stage], None]) -> Flight:
    """Return the flight of the autopilot that is met at `device`.

    Args:
        device: as every `--mavlink` takes it.
        told: is called with each new stage.

    Raises:
        UserError: the device cannot be opened, or the flight came to no end.
    """
    pilot, stage = Pilot(device), None
    with open_transport(device) as transport:
        while not pilot.is_done:
            data = transport.receive(_POLL_S)
            now_ns = time.monotonic_ns()
            if data:
                pilot.receive(data, now_ns, is_datagram=transport.is_datagram)
            for frame in pilot.poll(now_ns):
                transport.send(frame)
            if pilot.stage is not stage:
                stage = pilot.stage
                told(stage)
    return pilot.flight()


def fly_stand_in(firmware: str, parameters: dict[str, float]) -> Flight:
    """Return the flight of the simulated autopilot, as heavy and as draggy as the firmware's own simulation.

    Raises:
        UserError: a parameter does not exist or is out of range.
    """
    node, pilot = AutopilotNode(_stand_in(firmware, parameters), _LOCAL_NS), Pilot(f"stand-in of {firmware}")
    while not pilot.is_done:
        (sent,) = node.step(None, _AIR)
        now_ns = node.state.t_ns
        pilot.receive(sent, now_ns)
        for frame in pilot.poll(now_ns):
            for answer in node.receive(frame, now_ns):
                pilot.receive(answer, now_ns)
    return pilot.flight()


def check_stand_in(firmware: str | None, parameters: dict[str, float]) -> None:
    """Find out before a flight whether there can be a stand-in.

    Args:
        firmware: that is flown, None for the autopilot's, which is not known yet.
        parameters: by name.

    Raises:
        UserError: there is no such firmware, or none that is meant has these parameters.
    """
    *others, last = AIRFRAMES if firmware is None else (firmware,)
    for one in others:
        with suppress(UserError):
            _stand_in(one, parameters)
            return
    _stand_in(last, parameters)


def _stand_in(firmware: str, parameters: dict[str, float]) -> AutopilotConfig:
    if firmware not in AIRFRAMES:
        raise UserError(f"there is no stand-in for '{firmware}': give one of {', '.join(AIRFRAMES)}")
    config = SimAutopilotConfig.model_validate(
        {
            "firmware": firmware,
            "instant": True,
            "core": True,
            "drone": DroneConfig.model_validate({"airframe": AIRFRAMES[firmware]}),
            "parameters": parameters,
        }
    )
    return autopilot_config(config)
