"""A drone whose system id another one has, too, is not armed: the order would reach both."""

from dataclasses import dataclass, field

from companion.situation.phases import Phase
from link.messages import Command
from tests.companion.peer import FakePx4, Setup
from tests.companion.world import PAD
from tests.link.mavlink.fake_autopilot import S


@dataclass
class TwoPx4(FakePx4):
    """A drone, and another one of its system id on the same link."""

    other: FakePx4 = field(default_factory=FakePx4)

    def tick(self, t_ns: int) -> None:
        super().tick(t_ns)
        self.other.tick(t_ns)

    def take_output(self) -> list[bytes]:
        return [*super().take_output(), *self.other.take_output()]

    def receive(self, data: bytes, t_ns: int) -> None:
        super().receive(data, t_ns)
        self.other.receive(data, t_ns)


def test_start_with_two_drones_under_one_system_id_arms_neither_and_says_why() -> None:
    both = TwoPx4()
    both.other.boot_at_ns -= 90 * S
    setup = Setup(autopilot=both)
    setup.node.receive_pad(PAD)
    setup.run(3.0, setup.fixes)
    setup.node.request(Command.START)
    setup.run(3.0, setup.fixes)
    (reply,) = setup.node.take_replies()
    assert not reply.accepted
    assert "system id" in reply.reason
    assert (both.armed, both.other.armed) == (False, False)
    assert setup.node.phase is Phase.IDLE
    assert setup.node.outputs is not None
    assert setup.node.outputs.status.reason_code == "SYSTEM_ID_SHARED"
