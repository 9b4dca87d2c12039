"""Fuzzing the companion while it lands again and again, in lockstep: frames on its link and payloads on its keys.

Strangers' frames must not disturb a landing. Forged ones, which say that they are the autopilot's or the vehicle's, may
end it, as unsigned links cannot tell them; but whatever comes, nothing raises and nothing that is no number is sent.
"""

import math
import random
import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice

from companion.situation.phases import Phase
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.messages import Order, PadGeometry
from link.payloads import json_messages
from link.payloads.checks import PayloadError
from link.zenoh.keys import Keys
from scenarios.catalogue.catalogue import load_scenario
from scenarios.catalogue.firmware_option import with_firmware
from scenarios.faults.fuzz_frames import fuzz_frames
from scenarios.faults.fuzz_payloads import forged_json, forged_samples, noise_payload
from scenarios.lockstep.lockstep import Lockstep
from scenarios.simulation.vehicle_node import datum_of

_NAN_IS_UNKNOWN = frozenset({"COMMAND_LONG", "COMMAND_INT"})  # there it stands for a parameter that is not given


def count_not_finite(messages: Iterable[Message]) -> int:
    """Count numbers that are none; in PX4's PARAM_VALUE the bits of an integer may look like one."""
    count = 0
    for message in messages:
        if message.get_type() == "PARAM_VALUE" and message.param_type != mavlink.MAV_PARAM_TYPE_REAL32:
            continue
        if message.get_type() in _NAN_IS_UNKNOWN:
            continue
        for value in message.to_dict().values():
            numbers = value if isinstance(value, list) else (value,)
            count += sum(isinstance(one, float) and not math.isfinite(one) for one in numbers)
    return count


KINDS = ("datagram", "stream")

_SCENARIO = "straight_5"
_FRAMES_A_STEP = 100
_FORGED_PHASES = (Phase.TAKEOFF, Phase.WAITING, Phase.CHASE, Phase.ALIGN, Phase.DESCEND)
_FORGED_STEPS = 1000  # 10 s
_LATE_MAX_S = 0.3
_TIME_LIMIT_S = 120.0


@dataclass(frozen=True, slots=True, kw_only=True)
class CompanionFuzzResult:
    """What became of one run.

    Attributes:
        link: its kind.
        firmware: of the autopilot.
        forges: whether frames said to be the autopilot's, and payloads the vehicle's.
        frames: how many were offered.
        payloads: how many were offered, on the keys that the companion hears.
        flights: how many were flown.
        landed: how many of the flights landed.
        not_finite: numbers sent that are none.
        latest_s: how old the newest that the companion knew of the drone was, at most.
        frames_a_second: offered, taken and flown over.
    """

    link: str
    firmware: str
    forges: bool
    frames: int
    payloads: int
    flights: int
    landed: int
    not_finite: int
    latest_s: float
    frames_a_second: float

    @property
    def is_good(self) -> bool:
        """Whether nothing absurd was sent and, of strangers, no landing was disturbed."""
        undisturbed = self.landed == self.flights and self.latest_s <= _LATE_MAX_S
        return not self.not_finite and (self.forges or undisturbed)


def fuzz_companion(link: str, firmware: str, frames: int, seed: int, *, forges: bool) -> CompanionFuzzResult:
    """Offer frames and payloads to a companion while it lands.

    Args:
        link: one of `KINDS`: whether the frames come one by one, or in the stream of the autopilot's own.
        firmware: of the autopilot.
        frames: how many at least; the last landing is flown to its end.
        seed: of everything.
        forges: whether they say that they are the autopilot's and the vehicle's.
    """
    source, rng = fuzz_frames(seed, forges=forges), random.Random(seed)  # noqa: S311 (reproducible, not secret)
    began_s = time.perf_counter()
    offered = payloads = flights = landed = not_finite = 0
    latest_s = 0.0
    while offered < frames:
        flight = _Flight(firmware, seed + flights, rng, is_datagram=link == "datagram", forges=forges)
        flight.fly(source, frames - offered if forges else frames)
        flights += 1
        landed += flight.companion.phase is Phase.SECURED
        offered += flight.offered
        payloads += flight.payloads
        not_finite += flight.not_finite
        latest_s = max(latest_s, flight.latest_s)
    return CompanionFuzzResult(
        link=link,
        firmware=firmware,
        forges=forges,
        frames=offered,
        payloads=payloads,
        flights=flights,
        landed=landed,
        not_finite=not_finite,
        latest_s=round(latest_s, 4),
        frames_a_second=round(offered / (time.perf_counter() - began_s), 1),
    )


class _Flight(Lockstep):
    """A landing into whose links somebody else speaks."""

    def __init__(self, firmware: str, seed: int, rng: random.Random, *, is_datagram: bool, forges: bool) -> None:
        scenario = load_scenario(with_firmware(_SCENARIO, firmware))
        super().__init__(scenario, seed, publishes=True)
        self.offered = self.payloads = self.not_finite = 0
        self.latest_s = 0.0
        self._rng = rng
        self._keys = Keys()
        self._datum = datum_of(scenario.run.datum)
        self._is_datagram = is_datagram
        self._forges = forges
        self._listener = MavlinkCodec(255, 190)

    def fly(self, source: Iterator[bytes], frames: int) -> None:
        """Fly to the end; what is forged comes from some phase on, for a while or until there were `frames` of it."""
        if self._forges:
            begins = self._rng.choice(_FORGED_PHASES)
            while self.companion.phase is not begins and not self._is_over:
                self._advance()
            for _ in range(min(_FORGED_STEPS, -(-frames // _FRAMES_A_STEP))):
                self._offer(source)
                self._advance()
            return
        while not self._is_over:
            self._offer(source)
            self._advance()

    @property
    def _is_over(self) -> bool:
        flown_s = self.recording.elapsed_s
        return self.companion.phase in {Phase.SECURED, Phase.HOLD, Phase.PILOT} or flown_s > _TIME_LIMIT_S

    def _advance(self) -> None:
        self.step()
        node = self.companion
        node.take_publications()
        node.autopilot.take_texts()
        if node.inputs is not None and node.inputs.own is not None and not self._forges:
            self.latest_s = max(self.latest_s, (node.inputs.t_ns - node.inputs.own.t_ns) * 1e-9)

    def _offer(self, source: Iterator[bytes]) -> None:
        node, local_ns = self.companion, self.local_ns
        frames = list(islice(source, _FRAMES_A_STEP))
        for data in frames if self._is_datagram else [b"".join(frames)]:
            node.receive_mavlink(data, local_ns, is_datagram=self._is_datagram)
        self.offered += len(frames)
        for key, payload in self._samples():
            node.receive_sample(key, payload)
            self.payloads += 1
        for kind in (Order, PadGeometry):
            with suppress(PayloadError):
                json_messages.decode(kind, forged_json(self._rng))
            self.payloads += 1

    def _samples(self) -> Iterator[tuple[str, bytes]]:
        keys, datum = self._keys, self._datum
        if self._forges:
            place = (datum.latitude_rad, datum.longitude_rad, datum.altitude_m)
            yield from forged_samples(self._rng, keys, self.simulation.t_ns, place)
            return
        for key in (keys.fix, keys.fix_velocity, keys.imu, keys.pad_pose):
            yield key, noise_payload(self._rng)

    def _send(self, frames: Sequence[bytes], t_ns: int) -> None:
        self.not_finite += count_not_finite(self._listener.decode(b"".join(frames)))
        super()._send(frames, t_ns)
