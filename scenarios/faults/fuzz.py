"""Fuzzing the simulated autopilot over real links, while its drone hovers."""

import math
import os
import pty
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import islice

import numpy as np

from link.errors import UserError
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.transports.opening import open_transport
from link.transports.transport import Transport
from scenarios.faults.fuzz_companion import count_not_finite
from scenarios.faults.fuzz_frames import fuzz_frames
from scenarios.processes.programs import free_tcp_endpoint, free_udp_port
from sim_autopilot.runtime.build import autopilot_config
from sim_autopilot.runtime.config import SimAutopilotConfig
from sim_autopilot.runtime.node import AutopilotNode

LINK_KINDS = ("udpin", "udpout", "tcpin", "serial")
FIRMWARES = ("px4", "ardupilot")

_START_NS = 1_795_000_000_000_000_000
_STILL_AIR = np.zeros(3)
_FRAMES_A_STEP = 100
_CHUNK_BYTES = 1024  # less than any link buffers
_HEIGHT_M = 4.0
_CLIMB_LIMIT_S = 30.0
_GUIDED = 4.0
_PATIENCE_S = 5.0

Send = Callable[[bytes], int]
"""Sends the beginning of some bytes and returns how many were taken."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FuzzResult:
    """What became of one run.

    Attributes:
        link: its kind.
        firmware: that the simulated autopilot stands in for.
        frames: offered.
        received_share: of the bytes offered, what arrived.
        known_messages: among them, with a right checksum.
        drift_m: how far the hovering drone was from its place at most.
        mode_kept: whether it is armed and in its mode at the end.
        not_finite: numbers sent that are none.
        frames_a_second: offered, taken and flown over.
    """

    link: str
    firmware: str
    frames: int
    received_share: float
    known_messages: int
    drift_m: float
    mode_kept: bool
    not_finite: int
    frames_a_second: float

    @property
    def is_good(self) -> bool:
        """Whether everything arrived and nothing was disturbed."""
        return self.received_share == 1.0 and self.drift_m < 0.2 and self.mode_kept and not self.not_finite


def fuzz(link: str, firmware: str, frames: int, seed: int) -> FuzzResult:
    """Offer frames to a simulated autopilot over a real link while its drone hovers.

    Args:
        link: one of `LINK_KINDS`.
        firmware: one of `FIRMWARES`.
        frames: how many.
        seed: of the frames.
    """
    node = _fly_to_hover(firmware)
    place, mode = node.state.position_enu_m.copy(), node.memory.modes.mode
    listener = MavlinkCodec(255, 190)
    drift_m, not_finite, offered_bytes = 0.0, 0, 0
    received_before = node.statistics[0].bytes_received
    began_s = time.perf_counter()
    with open_link(link) as (transport, send):
        for batch in _batches(fuzz_frames(seed), frames):
            data = b"".join(batch)
            offered_bytes += len(data)
            _offer(data, send, transport, node, received_before + offered_bytes)
            output = node.step(None, _STILL_AIR)[0]
            transport.send(output)
            not_finite += count_not_finite(listener.decode(output))
            drift_m = max(drift_m, math.dist(place.tolist(), node.state.position_enu_m.tolist()))
    received = node.statistics[0].bytes_received - received_before
    return FuzzResult(
        link=link,
        firmware=firmware,
        frames=frames,
        received_share=received / max(offered_bytes, 1),
        known_messages=node.statistics[0].messages_received,
        drift_m=round(drift_m, 4),
        mode_kept=node.memory.armed_ns is not None and node.memory.modes.mode is mode,
        not_finite=not_finite,
        frames_a_second=round(frames / (time.perf_counter() - began_s), 1),
    )


@contextmanager
def open_link(kind: str) -> Iterator[tuple[Transport, Send]]:
    """Open the autopilot's end of a link; also give what sends from the other end.

    Args:
        kind: one of `LINK_KINDS`.
    """
    if kind == "serial":
        with _pseudo_terminal() as both:
            yield both
        return
    here, there = _devices(kind)
    with open_transport(here, is_patient=True) as transport, open_transport(there) as client:

        def send(data: bytes) -> int:
            client.receive(0.0)  # what the autopilot sends must not fill the buffers
            if data:
                client.send(data)
            return len(data)

        transport.send(b"\0")
        client.receive(0.1)  # by which a client of udpout knows whom to answer, and one of tcpin is connected
        transport.receive(0.1)
        yield transport, send


def _fly_to_hover(firmware: str) -> AutopilotNode:
    config = SimAutopilotConfig.model_validate({"firmware": firmware, "instant": True, "drone": {"endurance_s": 1e4}})
    node, pilot = AutopilotNode(autopilot_config(config), _START_NS), MavlinkCodec(255, 190)
    orders = [_command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1.0)]
    if firmware == "ardupilot":
        orders.insert(0, _command(mavlink.MAV_CMD_DO_SET_MODE, 1.0, _GUIDED))
    # PX4's is above the sea, or without one its parameter's above the ground.
    height_m = _HEIGHT_M if firmware == "ardupilot" else math.nan
    orders.append(_command(mavlink.MAV_CMD_NAV_TAKEOFF, 0.0, 0.0, 0.0, math.nan, math.nan, math.nan, height_m))
    for order in orders:
        node.receive(pilot.encode(order), node.state.t_ns)
        node.step(None, _STILL_AIR)
    _settle(node)
    return node


def _settle(node: AutopilotNode) -> None:
    """Fly until it has hung still for a second."""
    still_s = 0.0
    while still_s < 1.0:
        node.step(None, _STILL_AIR)
        flown_s = (node.state.t_ns - _START_NS) * 1e-9
        height_m, speed_m_s = node.state.position_enu_m[2], np.linalg.norm(node.state.velocity_enu_m_s)
        still_s = still_s + node.step_ns * 1e-9 if height_m > 2.0 and speed_m_s < 0.02 else 0.0
        if flown_s > _CLIMB_LIMIT_S:
            raise UserError(f"the drone does not hover within {_CLIMB_LIMIT_S:g} s; try scenarios run first")


def _command(number: int, *parameters: float) -> Message:
    seven = (*parameters, *(0.0,) * (7 - len(parameters)))
    return mavlink.MAVLink_command_long_message(1, 1, number, 0, *seven)


def _batches(frames: Iterator[bytes], count: int) -> Iterator[list[bytes]]:
    for start in range(0, count, _FRAMES_A_STEP):
        yield list(islice(frames, min(_FRAMES_A_STEP, count - start)))


def _offer(data: bytes, send: Send, transport: Transport, node: AutopilotNode, total_bytes: int) -> None:
    """Send what the link takes and let the autopilot take that, until it has all of it or patience ends."""
    end_s = time.monotonic() + _PATIENCE_S
    while node.statistics[0].bytes_received < total_bytes and time.monotonic() < end_s:
        data = data[send(data[:_CHUNK_BYTES]) :]
        _take(transport, node, 0.0 if data else 0.01)


def _take(transport: Transport, node: AutopilotNode, timeout_s: float = 0.0) -> None:
    for peer, data in transport.receive_by_peer(timeout_s):
        answer = node.receive(data, node.state.t_ns, peer=peer, is_datagram=transport.is_datagram)[0]
        if answer:
            transport.send(answer)


def _devices(kind: str) -> tuple[str, str]:
    """The devices of the autopilot and of its client."""
    if kind == "tcpin":
        port = int(free_tcp_endpoint().rpartition(":")[2])
        return f"tcpin:127.0.0.1:{port}", f"tcp:127.0.0.1:{port}"
    port = free_udp_port()
    other = "udpin" if kind == "udpout" else "udpout"
    return f"{kind}:127.0.0.1:{port}", f"{other}:127.0.0.1:{port}"


@contextmanager
def _pseudo_terminal() -> Iterator[tuple[Transport, Send]]:
    ours, theirs = pty.openpty()
    tty.setraw(theirs)
    os.set_blocking(ours, False)

    def send(data: bytes) -> int:
        _drain(ours)
        try:
            return os.write(ours, data)
        except BlockingIOError:
            return 0

    try:
        with open_transport(f"{os.ttyname(theirs)},921600") as transport:
            yield transport, send
    finally:
        os.close(ours)
        os.close(theirs)


def _drain(descriptor: int) -> None:
    """Read what the autopilot sent, so that the line does not fill."""
    try:
        while os.read(descriptor, 65536):
            pass
    except BlockingIOError:
        return
