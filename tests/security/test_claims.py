"""Two companions for one drone, and two drones for one vehicle: who was there first goes on, the other stays out."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack

import pytest

from companion.core.data import Rival
from companion.core.reasons import Cause, Reason
from companion.runtime.claims import Claims
from companion.situation.phases import FLYING_PHASES, Event, Phase
from link.messages import Command
from link.zenoh.keys import Keys
from link.zenoh.session import ZenohOptions, ZenohSession, open_session
from scenarios.processes.programs import free_tcp_endpoint
from tests.companion.facts import changed, decided, progress, situation
from tests.companion.world import PAD_HEIGHT_M, Flight, KnownVehicle
from tests.integration.programs import until

KEYS, OTHER = Keys(), Keys(drone="drone2")
ITSELF = Rival(drone=KEYS.drone, is_this_drone=True)


@pytest.fixture
def sessions() -> Iterator[tuple[ZenohSession, ZenohSession]]:
    """Those of two companions that meet."""
    endpoint = free_tcp_endpoint()
    with ExitStack() as stack:
        first = stack.enter_context(open_session(ZenohOptions(listen=(endpoint,))))
        yield first, stack.enter_context(open_session(ZenohOptions(connect=(endpoint,))))


def soon(session: ZenohSession, condition: Callable[[], bool], what: str) -> None:
    """Wait until what has arrived makes `condition` true."""

    def holds() -> bool:
        session.wake_up.wait(0.05)
        return condition()

    until(holds, what)


def test_second_companion_of_a_drone_knows_of_the_first_until_that_has_ended(
    sessions: tuple[ZenohSession, ZenohSession],
) -> None:
    first, second = Claims(sessions[0], KEYS, 100), Claims(sessions[1], KEYS, 200)
    soon(sessions[1], lambda: second.rival == ITSELF, "the first is seen")
    assert first.rival is None
    sessions[0].close()
    soon(sessions[1], lambda: second.rival is None, "the first has gone")


def test_dry_run_claims_no_vehicle(sessions: tuple[ZenohSession, ZenohSession]) -> None:
    dry, lands = Claims(sessions[0], KEYS, 100, dry_run=True), Claims(sessions[0], OTHER, 200)
    waits = Claims(sessions[1], Keys(drone="drone3"), 300)
    dry.update(Phase.CHASE, armed=True)
    lands.update(Phase.CHASE, armed=True)
    soon(sessions[1], lambda: waits.rival is not None, "the later claim is seen")
    assert waits.rival == Rival(drone=OTHER.drone, is_this_drone=False)


def test_vehicle_is_claimed_while_a_drone_lands_or_stands_there_and_no_longer(
    sessions: tuple[ZenohSession, ZenohSession],
) -> None:
    lands, waits = Claims(sessions[0], KEYS, 200), Claims(sessions[1], OTHER, 100)
    lands.update(Phase.CHASE, armed=True)
    soon(sessions[1], lambda: waits.rival == Rival(drone=KEYS.drone, is_this_drone=False), "the claim is seen")
    lands.update(Phase.SECURED, armed=False)
    assert waits.rival is not None
    lands.update(Phase.SECURED, armed=True)  # flown away by somebody else
    soon(sessions[1], lambda: waits.rival is None, "the claim has gone")


@pytest.mark.parametrize("begun_ns", [(100, 200), (100, 100)])
def test_of_two_drones_that_start_at_the_same_time_one_goes_on(
    sessions: tuple[ZenohSession, ZenohSession], begun_ns: tuple[int, int]
) -> None:
    first, second = Claims(sessions[0], KEYS, begun_ns[0]), Claims(sessions[1], OTHER, begun_ns[1])
    for one in (first, second):
        one.update(Phase.TAKEOFF, armed=True)
    soon(sessions[1], lambda: second.rival == Rival(drone=KEYS.drone, is_this_drone=False), "the first claim is seen")
    assert first.rival is None


@pytest.mark.parametrize("begun_ns", [100, 300])
def test_companion_that_flies_goes_on_whatever_the_clock_of_one_that_comes_then(
    sessions: tuple[ZenohSession, ZenohSession], begun_ns: int
) -> None:
    flies = Claims(sessions[0], KEYS, 200)
    flies.update(Phase.CHASE, armed=True)
    comes = Claims(sessions[1], KEYS, begun_ns)
    companions = sessions[0].watch_alive(KEYS.companion_alive("*"))
    soon(sessions[1], lambda: comes.rival == ITSELF, "the one that flies is seen")
    soon(sessions[0], lambda: len(companions.keys) == 2, "the one that comes is seen")
    assert flies.rival is None
    flies.update(Phase.IDLE, armed=False)
    kept_out = flies if begun_ns < 200 else comes
    soon(sessions[1], lambda: (comes.rival == ITSELF) is (comes is kept_out), "neither flies: who began earlier counts")
    soon(sessions[0], lambda: (flies.rival == ITSELF) is (flies is kept_out), "the one that flew knows it, too")


def test_of_two_companions_that_both_fly_a_drone_when_they_meet_one_goes_on(
    sessions: tuple[ZenohSession, ZenohSession],
) -> None:
    first, second = Claims(sessions[0], KEYS, 100), Claims(sessions[1], KEYS, 200)
    for one in (first, second):
        one.update(Phase.CHASE, armed=True)
    claims = sessions[0].watch_alive(KEYS.landing_claim("*", "*"))
    soon(sessions[1], lambda: second.rival == ITSELF, "the first is seen")
    soon(sessions[0], lambda: len(claims.keys) == 2, "the second is seen")
    assert first.rival is None


@pytest.mark.parametrize("phase", sorted(FLYING_PHASES, key=str))
def test_companion_of_a_drone_that_another_one_flies_is_out_at_once_in_every_phase(phase: Phase) -> None:
    now = changed(situation(), rival=ITSELF)
    assert decided(progress(phase), now) == (Event.PILOT_TOOK_OVER, Cause(Reason.DRONE_TAKEN))


@pytest.mark.parametrize(
    ("rival", "told"),
    [
        (ITSELF, "another companion is there for this drone"),
        (Rival(drone="drone2", is_this_drone=False), "drone2 lands on this vehicle"),
    ],
)
def test_start_beside_another_companion_is_refused_and_nothing_is_sent(rival: Rival, told: str) -> None:
    flight = Flight(vehicle=KnownVehicle((-60.0, 0.4, PAD_HEIGHT_M), (4.2, 0.0, 0.0)))
    flight.rival = rival
    flight.run(0.2)
    reply = flight.step(Command.START).reply
    assert reply is not None
    assert not reply.accepted
    assert reply.reason.startswith(told)
    assert flight.commands == []
