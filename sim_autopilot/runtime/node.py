"""The simulated autopilot as a box without input and output of its own: bytes and the deck in, bytes out.

The wire loop, the one-process world and campaigns in lockstep all drive this same box.
"""

from collections.abc import Iterable, Sequence

from link.frames.geodesy import Datum, geodetic_from_enu
from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.signing import Signing, Streams
from link.mavlink.statistics import CodecStatistics
from link.messages import Vector3
from link.records import replace
from sim_autopilot.boot import initial_memory, restart_in_place
from sim_autopilot.commands.origin import move_origin
from sim_autopilot.core.data import Array, Deck, PlantState
from sim_autopilot.core.range_finder import RangeErrors
from sim_autopilot.core.streams import shortest_interval_ns
from sim_autopilot.interfaces import AutopilotConfig
from sim_autopilot.memory import AutopilotInputs, AutopilotMemory
from sim_autopilot.plant.own_state import NO_ERROR, OwnStateError
from sim_autopilot.runtime.routing import Routes, target_of
from sim_autopilot.step import autopilot_step
from sim_autopilot.telemetry.status import ping_answer, timesync_answer

STEP_NS = 10_000_000
"""What a step advances, unless a stream is faster."""
_FAST_STEP_NS = 5_000_000  # one period of the flight controller
_COMPONENT = mavlink.MAV_COMP_ID_AUTOPILOT1


class AutopilotNode:
    """An autopilot with its codecs, one for each of the links that its configuration has.

    Args:
        config: of the autopilot.
        start_ns: UTC of its boot.

    Raises:
        ValueError: a parameter of `config` does not exist or is out of range.
    """

    def __init__(self, config: AutopilotConfig, start_ns: int) -> None:
        self._config = config
        self._rules = config.firmware.links
        self._codecs = [MavlinkCodec(config.system_id, _COMPONENT, answers_version1=True) for _ in config.links]
        self._routes = Routes(config.system_id, _COMPONENT, len(config.links))
        self._memory = initial_memory(config, start_ns)
        self._own_error = OwnStateError(config.own_state, STEP_NS * 1e-9)
        self._error = NO_ERROR
        self._range_errors = RangeErrors(config.range_finder)
        self._received: list[tuple[Message, int]] = []
        self._step_ns = self._next_step_ns()

    @property
    def memory(self) -> AutopilotMemory:
        """Everything that the autopilot knows."""
        return self._memory

    @property
    def state(self) -> PlantState:
        """The drone as it truly is."""
        return self._memory.plant.state

    @property
    def step_ns(self) -> int:
        """What the next step advances."""
        return self._step_ns

    @property
    def next_ns(self) -> int:
        """The time to which the next step leads."""
        return self.state.t_ns + self._step_ns

    @property
    def statistics(self) -> tuple[CodecStatistics, ...]:
        """What went over each link, and what of it was bad."""
        return tuple(codec.statistics for codec in self._codecs)

    def restart(self) -> None:
        """Reboot where the drone is: nothing is remembered, and the motors stand still until they are armed."""
        self._memory = restart_in_place(self._memory, self._config)
        self._received.clear()
        self._step_ns = self._next_step_ns()

    def reset_estimator(self, by_enu_m: Vector3) -> None:
        """Let the origin of the local frame jump under the drone, which only those learn who ask for it."""
        x, y, z = (old + by for old, by in zip(self._memory.places.origin.position_enu_m, by_enu_m, strict=True))
        latitude_rad, longitude_rad, altitude_m = geodetic_from_enu(self._config.datum, (x, y, z))
        datum = Datum(latitude_rad=latitude_rad, longitude_rad=longitude_rad, altitude_m=altitude_m)
        self._memory, _ = move_origin(self._memory, datum, (x, y, z), self._config)

    def set_charge(self, share: float) -> None:
        """Let the battery have `share` left, as after a longer flight; the motors run."""
        ran_ns = round((1.0 - share) * self._config.endurance_s * 1e9)
        self._memory = replace(self._memory, armed_ns=self._memory.now.boot_ns - ran_ns)

    def receive(
        self, data: bytes, t_ns: int, link: int = 0, peer: int = 0, *, is_datagram: bool = False
    ) -> tuple[bytes, ...]:
        """Take bytes as they come, for the next step; what is not for us alone is passed on.

        Only questions for the time and pings are answered at once.

        Args:
            data: any bytes; what is no message is counted and dropped.
            t_ns: UTC now, between the last step and the next.
            link: on which they came.
            peer: of the link, from whom they came.
            is_datagram: they are whole frames, not a piece of a stream.

        Returns:
            What is to be sent on each link.
        """
        output = self._no_output()
        for message in self._codecs[link].decode(data, peer, t_ns=t_ns, is_datagram=is_datagram):
            self._take(message, t_ns, link, output)
        return tuple(map(bytes, output))

    def step(self, deck: Deck | None, wind_enu_m_s: Array) -> tuple[bytes, ...]:
        """Advance by `step_ns` and return what is to be sent on each link.

        Args:
            deck: the vehicle, None without one.
            wind_enu_m_s: (3,) air over ground.
        """
        output = self._no_output()
        for link, codec in enumerate(self._codecs):
            for _, message in codec.flush(self.state.t_ns):
                self._take(message, self.state.t_ns, link, output)
        received, self._received = self._received, []
        if (self.state.t_ns - self._memory.boot.start_ns) % STEP_NS == 0:
            self._error = self._own_error.advance()
        inputs = AutopilotInputs(
            t_ns=self.next_ns,
            messages=tuple(message for message, _ in received),
            links=tuple(link for _, link in received),
            deck=deck,
            wind_enu_m_s=wind_enu_m_s,
            own_error=self._error,
            range_error_m=self._range_errors.advance(),
        )
        self._setup_signing(inputs.messages)
        self._memory, outputs = autopilot_step(self._memory, inputs, self._config)
        self._step_ns = self._next_step_ns()
        self._encode(outputs.messages, outputs.links, output)
        return tuple(map(bytes, output))

    def _take(self, message: Message, t_ns: int, link: int, output: list[bytearray]) -> None:
        """Keep a message for the next step, unless it is answered at once, and pass on what is not for us alone."""
        self._routes.learn(message, link)
        for other in self._routes.onward(message, link):
            output[other] += message.get_msgbuf()
        answer = self._answer_at_once(message, t_ns)
        if answer is None:
            self._received.append((message, link))
        else:
            output[link] += self._codecs[link].encode(answer)

    def _encode(self, messages: Sequence[Message], links: Sequence[int | None], output: list[bytearray]) -> None:
        for codec in self._codecs:
            if codec.signing is not None:
                codec.signing.advance(self.state.t_ns)
        for message, link in zip(messages, links, strict=True):
            for one in self._routes.towards(message) or range(len(output)) if link is None else (link,):
                output[one] += self._codecs[one].encode(message)

    def _no_output(self) -> list[bytearray]:
        return [bytearray() for _ in self._codecs]

    def _answer_at_once(self, message: Message, t_ns: int) -> Message | None:
        message_id = message.get_msgId()
        if message_id == mavlink.MAVLINK_MSG_ID_TIMESYNC and message.tc1 == 0:
            return timesync_answer(message, t_ns - self._memory.boot.start_ns)
        if message_id == mavlink.MAVLINK_MSG_ID_PING and self._rules.answers_ping and target_of(message) == (0, 0):
            return ping_answer(message)
        return None

    def _setup_signing(self, messages: Iterable[Message]) -> None:
        if not self._rules.takes_signing or self._memory.armed_ns is not None:
            return
        setup = last_setup(messages, self._config.system_id)
        if setup is not None:
            for codec, signing in zip(self._codecs, link_signings(setup, len(self._codecs)), strict=True):
                codec.signing = signing

    def _next_step_ns(self) -> int:
        intervals_ns = [shortest_interval_ns(link.streams) for link in self._memory.links.each]
        return _FAST_STEP_NS if any(one is not None and one < STEP_NS for one in intervals_ns) else STEP_NS


_TRUSTED_LINK = 0  # a cable, by which a lost key can be replaced
_TIMESTAMP_MAX = (1 << 48) - 1


def last_setup(messages: Iterable[Message], system_id: int) -> Message | None:
    """Return the last SETUP_SIGNING for us among `messages`."""
    found = None
    for message in messages:
        if message.get_msgId() == mavlink.MAVLINK_MSG_ID_SETUP_SIGNING and message.target_system in {0, system_id}:
            found = message
    return found


def link_signings(setup: Message, links: int) -> list[Signing | None]:
    """Return how each link signs and checks after `setup`; a key of zeros ends it."""
    key = bytes(setup.secret_key)
    if not any(key):
        return [None] * links
    timestamp, streams = min(setup.initial_timestamp, _TIMESTAMP_MAX), Streams()
    return [
        Signing(key, link, timestamp, takes_unsigned=link == _TRUSTED_LINK, streams=streams) for link in range(links)
    ]
