"""A network that delivers datagrams of the autopilot again, long after they were sent: nothing is believed twice."""

import random

import pytest

from companion.situation.phases import Phase
from scenarios.catalogue.catalogue import load_scenario
from scenarios.catalogue.firmware_option import with_firmware
from scenarios.config import Scenario
from scenarios.lockstep.lockstep import Lockstep

SHARE = 0.3  # of the datagrams


class Repeating(Lockstep):
    """A landing over a link that repeats datagrams `later` others later, give or take `spread`.

    Of those that it repeats it loses `first_lost` at first; of the others it loses and reorders some.
    """

    def __init__(self, scenario: Scenario, seed: int, later: int, spread: int) -> None:
        super().__init__(scenario, seed)
        self._rng = random.Random(seed)
        self._later, self._spread = later, spread
        self._count = 0
        self._due: list[tuple[int, bytes]] = []
        self.loss = self.reordered = self.first_lost = 0.0

    def _hear(self, data: bytes) -> None:
        self._count += 1
        due = [one for count, one in self._due if count <= self._count]
        self._due = [(count, one) for count, one in self._due if count > self._count]
        is_repeated = self._rng.random() < SHARE
        if is_repeated:
            self._put_off(data, self._later + self._rng.randint(-self._spread, self._spread))
        if self._rng.random() >= (self.first_lost if is_repeated else self.loss):
            if self._rng.random() < self.reordered:
                self._put_off(data, self._rng.randint(1, 4))
            else:
                due.insert(0, data)
        for one in due:
            self.companion.receive_mavlink(one, self.local_ns, is_datagram=True)

    def _put_off(self, data: bytes, later: int) -> None:
        self._due.append((self._count + later, data))


def flight(firmware: str, seed: int, later: int, spread: int) -> Repeating:
    return Repeating(load_scenario(with_firmware("straight_5", firmware)), seed, later, spread)


@pytest.mark.slow
@pytest.mark.parametrize("firmware", ["px4", "ardupilot"])
@pytest.mark.parametrize("later", [100, 600])
def test_drone_lands_though_old_datagrams_come_again(firmware: str, later: int) -> None:
    flown = flight(firmware, 1, later, 10)
    flown.run()
    assert flown.companion.phase is Phase.SECURED
    assert flown.companion.autopilot.session.statistics.codec.repeated_messages > 500


@pytest.mark.slow
@pytest.mark.parametrize("firmware", ["px4", "ardupilot"])
def test_drone_lands_though_old_datagrams_come_that_were_lost_at_first(firmware: str) -> None:
    flown = flight(firmware, 5, 200, 100)
    flown.loss, flown.reordered, flown.first_lost = 0.2, 0.05, 0.5
    flown.run()
    assert flown.companion.phase is Phase.SECURED
