"""The simulated autopilot as a box without input and output of its own: bytes and the deck in, bytes out.

The wire loop, the one-process world and campaigns in lockstep all drive this same box.
"""

from link.mavlink.codec import MavlinkCodec
from link.mavlink.dialect import Message, mavlink
from link.mavlink.statistics import CodecStatistics
from sim_autopilot.data import Array, Deck, PlantState
from sim_autopilot.memory import AutopilotConfig, AutopilotInputs, AutopilotMemory, initial_memory
from sim_autopilot.step import autopilot_step
from sim_autopilot.telemetry_status import timesync_answer

STEP_NS = 10_000_000
"""What a step advances."""


class AutopilotNode:
    """An autopilot with its codec.

    Args:
        config: of the autopilot.
        start_ns: UTC of its boot.

    Raises:
        ValueError: a parameter of `config` does not exist or is out of range.
    """

    def __init__(self, config: AutopilotConfig, start_ns: int) -> None:
        self._config = config
        self._codec = MavlinkCodec(config.system_id, mavlink.MAV_COMP_ID_AUTOPILOT1)
        self._memory = initial_memory(config, start_ns)
        self._received: list[Message] = []

    @property
    def memory(self) -> AutopilotMemory:
        """Everything that the autopilot knows."""
        return self._memory

    @property
    def state(self) -> PlantState:
        """The drone as it truly is."""
        return self._memory.plant.state

    @property
    def next_ns(self) -> int:
        """The time to which the next step leads."""
        return self.state.t_ns + STEP_NS

    @property
    def statistics(self) -> CodecStatistics:
        """What went over the link, and what of it was bad."""
        return self._codec.statistics

    def receive(self, data: bytes, t_ns: int) -> bytes:
        """Take bytes as they come, for the next step; only a question for the time is answered at once.

        Args:
            data: any bytes; what is no message is counted and dropped.
            t_ns: UTC now, between the last step and the next.

        Returns:
            What is to be sent.
        """
        answers = b""
        for message in self._codec.decode(data):
            if message.get_msgId() != mavlink.MAVLINK_MSG_ID_TIMESYNC:
                self._received.append(message)
            elif message.tc1 == 0:
                answers += self._codec.encode(timesync_answer(message, t_ns - self._memory.start_ns))
        return answers

    def step(self, deck: Deck | None, wind_enu_m_s: Array) -> bytes:
        """Advance by 10 ms and return what is to be sent.

        Args:
            deck: the vehicle, None without one.
            wind_enu_m_s: (3,) air over ground.
        """
        inputs = AutopilotInputs(
            t_ns=self.next_ns, messages=tuple(self._received), deck=deck, wind_enu_m_s=wind_enu_m_s
        )
        self._received.clear()
        self._memory, outputs = autopilot_step(self._memory, inputs, self._config)
        return b"".join(map(self._codec.encode, outputs.messages))
