"""Whether the drone stands on the vehicle, and what its lift-off tells about the receivers' frames."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import pytest

from companion.config.integrity import ReceiverFrames
from companion.core.data import Array, Measurement, Quantity
from companion.core.reasons import Cause, Reason, sentence
from companion.landing.sortie.over_vehicle import is_deck_quiet, stands_on_deck, tell_restless
from companion.situation.phases import Phase
from companion.situation.situation import Situation
from link.messages import Command, Vector3
from link.records import replace
from tests.companion.facts import TICK_NS, pad_at, situation
from tests.companion.world import CONFIG, DISARM, GEAR_M, STEP_NS, Flight, KnownVehicle, configured, on_deck, reached

NEAR_M, HEIGHT_M = 3.0, 0.5
COARSE_M = 1.5


def stands(
    beside_m: float, pad_velocity_enu_m_s: Vector3, slower_m_s: float = 0.0, *, std_m: float = COARSE_M
) -> Situation:
    """A drone that its autopilot says stands, seen so far beside the pad and so much slower than it."""
    pad = pad_at(pad_velocity_enu_m_s, std_m=std_m)
    facts = situation(1.2, beside_m, pad)
    assert facts.drone is not None
    drone = replace(facts.drone, velocity_enu_m_s=pad.velocity_enu_m_s[0] - np.array([slower_m_s, 0.0, 0.0]))
    return replace(facts, drone=drone, autopilot=replace(facts.autopilot, landed=True))


@pytest.mark.parametrize(
    ("facts", "is_on"),
    [
        (stands(4.0, (8.0, 0.0, 0.0)), True),
        (stands(4.0, (8.0, 0.0, 0.0), slower_m_s=1.0), True),
        (stands(4.0, (8.0, 0.0, 0.0), slower_m_s=8.0), False),  # stands on the road that the vehicle drives on
        (stands(4.0, (2.0, 0.0, 0.0)), False),  # may be carried beside it
        (stands(4.0, (0.0, 0.0, 0.0)), False),
        (stands(4.0, (8.0, 0.0, 0.0), std_m=0.05), False),  # both places are known: it drives ahead of the vehicle
        (stands(9.0, (8.0, 0.0, 0.0)), False),
    ],
)
def test_drone_that_is_carried_along_stands_on_the_vehicle(facts: Situation, *, is_on: bool) -> None:
    assert stands_on_deck(facts, NEAR_M, HEIGHT_M) is is_on


def test_drone_that_flies_with_the_vehicle_does_not_stand_on_it() -> None:
    facts = stands(4.0, (8.0, 0.0, 0.0))
    assert not stands_on_deck(replace(facts, autopilot=replace(facts.autopilot, landed=False)), NEAR_M, HEIGHT_M)


@dataclass(frozen=True)
class Teachable(KnownVehicle):
    """An estimator that has its vehicle `off_m` beside where it is until a sighting of its pad tells."""

    off_m: float = 0.0
    told: list[Measurement] = field(default_factory=list)

    def fuse(self, memory: int | None, measurements: Sequence[Measurement]) -> int:
        self.told.extend(one for one in measurements if one.quantity is Quantity.PAD)
        return super().fuse(memory, measurements)

    def at(self, t_ns: int) -> Array:
        return np.asarray(super().at(t_ns) + np.array([0.0 if self.told else self.off_m, 0.0, 0.0]))


def launched(frames: ReceiverFrames, off_m: float = 0.0) -> tuple[Flight, Teachable, Array, int]:
    """A flight at the end of its lift-off, with its estimator; where the drone stood, and when that was so last."""
    flight = on_deck()
    integrity = CONFIG.integrity.model_copy(update={"receiver_frames": frames})
    flight.config = CONFIG.model_copy(update={"integrity": integrity})
    known = flight.vehicle
    flight.vehicle = vehicle = Teachable(known.start_enu_m, known.velocity_enu_m_s, apart_std_m=0.1, off_m=off_m)
    flight.step(Command.LAUNCH)
    flight.run_until(Phase.LIFT_OFF)
    stood_enu_m, stood_ns = np.array(flight.own.position_enu_m), flight.own.t_ns
    flight.run_until(Phase.FOLLOW)
    return flight, vehicle, stood_enu_m, stood_ns


@pytest.mark.parametrize(("frames", "looks"), [(ReceiverFrames.APART, 1), (ReceiverFrames.ONE, 0)])
def test_lift_off_tells_once_that_the_pad_is_under_the_drone_where_frames_are_apart(
    frames: ReceiverFrames, looks: int
) -> None:
    flight, vehicle, stood_enu_m, stood_ns = launched(frames)
    assert len(vehicle.told) == looks
    for look in vehicle.told:
        assert abs(look.t_ns - stood_ns) <= TICK_NS
        assert look.value == pytest.approx(stood_enu_m - np.array([0.0, 0.0, GEAR_M]), abs=0.05)
    sightings = flight.memory.vehicle.sightings
    assert (sightings.is_confirmed, sightings.was_confirmed) == (bool(looks), False)


def test_drone_rises_where_it_stood_however_far_off_the_pad_was_taken_to_be() -> None:
    flight, _, stood_enu_m, _ = launched(ReceiverFrames.APART, off_m=1.5)
    assert flight.own.position_enu_m[:2] == pytest.approx(stood_enu_m[:2], abs=0.05)
    flight.run(6.0)
    assert flight.own.position_enu_m[:2] == pytest.approx(flight.vehicle.at(flight.t_ns)[:2], abs=0.05)


def wait(flight: Flight, time_s: float, tilt_rad: float = 0.0) -> None:
    """Stand for a while on a deck that leans so."""
    for _ in range(round(time_s * 1e9 / STEP_NS)):
        rolled = (math.cos(0.5 * tilt_rad), math.sin(0.5 * tilt_rad), 0.0, 0.0)
        flight.own = replace(flight.own, orientation_wxyz=rolled)
        flight.step()


def armed_on_deck() -> Flight:
    """A launch whose motors turn since this step."""
    flight = on_deck()
    flight.step(Command.LAUNCH)
    while not flight.view.armed:
        flight.step()
    return flight


def test_drone_that_was_disarmed_on_the_deck_starts_its_motors_by_a_new_order_only() -> None:
    flight = armed_on_deck()
    wait(flight, 0.4, tilt_rad=0.2)  # the deck is restless again
    assert flight.history[-1:] == [Phase.ON_DECK]
    flight.view = replace(flight.view, armed=False)  # a switch, a ground station, or the autopilot's own time-out
    wait(flight, 0.4, tilt_rad=0.2)
    wait(flight, 4.0)
    assert not flight.view.armed
    assert flight.history[-2:] == [Phase.ON_DECK, Phase.PILOT]


def test_motors_that_idle_on_a_restless_deck_are_stopped_and_start_again_at_its_next_quiet_moment() -> None:
    flight = armed_on_deck()
    flight.refuses_plain_disarm = False
    idle_max_s = CONFIG.sortie.launch.idle_max_s
    wait(flight, idle_max_s - 0.1, tilt_rad=0.2)
    assert flight.view.armed
    wait(flight, 5.0, tilt_rad=0.2)
    assert (flight.view.armed, flight.phase) == (False, Phase.ON_DECK)
    flight.own = replace(flight.own, orientation_wxyz=(1.0, 0.0, 0.0, 0.0))
    flight.run_until(Phase.LIFT_OFF, limit_s=3.0)
    assert flight.view.armed


def test_no_lift_off_begins_while_the_motors_are_being_stopped() -> None:
    flight = armed_on_deck()
    flight.refuses_plain_disarm = True  # they turn on
    wait(flight, CONFIG.sortie.launch.idle_max_s + 0.1, tilt_rad=0.2)
    wait(flight, 3.0)
    assert (flight.view.armed, flight.phase) == (True, Phase.ON_DECK)


@pytest.mark.parametrize(
    ("lean_rad", "climb_m_s", "acceleration_m_s2", "told"),
    [
        (0.119, 0.0, 0.0, "leans by 0.12 rad, quiet_tilt_max_rad is 0.09"),
        (0.0, -0.54, 0.0, "rises or sinks at 0.5 m/s"),
        (0.0, 0.0, 3.2, "turns with 3.2 m/s^2"),
        (0.0, 0.0, 0.0, "for a moment only"),
    ],
)
def test_launch_that_is_given_up_says_what_the_deck_does(
    lean_rad: float, climb_m_s: float, acceleration_m_s2: float, told: str
) -> None:
    facts = situation(0.0)
    assert facts.drone is not None
    assert facts.pad is not None
    velocity = facts.pad.velocity_enu_m_s[0] + np.array([0.0, 0.0, climb_m_s])
    acceleration = facts.pad.acceleration_enu_m_s2 + np.array([0.0, acceleration_m_s2, 0.0])
    drone = replace(facts.drone, lean=math.sin(lean_rad), velocity_enu_m_s=velocity)
    restless = replace(facts, drone=drone, pad=replace(facts.pad, acceleration_enu_m_s2=acceleration))
    assert is_deck_quiet(restless, CONFIG.sortie.launch) is ("moment" in told)
    assert told in sentence(tell_restless(restless, CONFIG.sortie.launch))


SOON_GIVEN_UP = configured({"sortie": {"launch": {"time_limit_s": 8.0}}})
LAUNCH = SOON_GIVEN_UP.sortie.launch


@pytest.mark.parametrize(("holds", "reason"), [(0.6, Reason.DECK_RESTLESS), (4.0, Reason.ARMING_REFUSED)])
def test_autopilot_is_said_to_refuse_arming_only_where_it_was_ordered_to(holds: float, reason: Reason) -> None:
    flight = on_deck()
    flight.config = SOON_GIVEN_UP
    flight.refuses = frozenset({DISARM})  # it is the command that arms
    flight.step(Command.LAUNCH)
    wait(flight, LAUNCH.time_limit_s - holds * LAUNCH.quiet_hold_s, tilt_rad=0.2)
    wait(flight, 0.04)
    flight.run_until(Phase.IDLE, Phase.TOUCHDOWN, limit_s=5.0)
    assert flight.reason is reason
    assert bool(flight.told(DISARM)) is (reason is Reason.ARMING_REFUSED)


@pytest.mark.parametrize("reason", [Reason.OWN_POSITION_OLD, Reason.OWN_ATTITUDE_OLD])
def test_launch_of_a_drone_whose_place_is_not_known_ends_at_once_and_says_so(reason: Reason) -> None:
    flight = on_deck()
    flight.refuses_plain_disarm = False
    flight.step(Command.LAUNCH)
    flight.own_is_silent = reason is Reason.OWN_POSITION_OLD
    if reason is Reason.OWN_ATTITUDE_OLD:
        flight.own = replace(flight.own, attitude_age_s=2.0)
    said = [out.text for out in flight.run(CONFIG.abort.own_age_max_s + 0.2) if out.text]
    assert said[0] == f"{Phase.TOUCHDOWN.value}: {sentence(Cause(reason))}"
    assert not flight.view.armed


@pytest.mark.parametrize(
    ("lifts", "phases"), [(False, [Phase.TOUCHDOWN, Phase.SECURED]), (True, [Phase.LIFT_OFF, Phase.ABORT])]
)
def test_lift_off_that_an_outage_has_broken_off_stops_the_motors_of_a_drone_that_still_stands(
    *, lifts: bool, phases: list[Phase]
) -> None:
    flight = reached(Phase.LIFT_OFF)
    flight.refuses_plain_disarm = False
    stood = flight.own.position_enu_m

    def wait_for(time_s: float, *, landed: bool) -> None:
        for _ in range(round(time_s * 1e9 / STEP_NS)):
            flight.step()
            flight.view = replace(flight.view, landed=landed)
            flight.own = replace(flight.own, position_enu_m=stood, velocity_enu_m_s=(0.0, 0.0, 0.0))

    flight.own_is_silent = True
    wait_for(1.0, landed=True)
    assert flight.phase is Phase.ABORT
    flight.own_is_silent = False
    wait_for(CONFIG.abort.heard_hold_s - 0.1, landed=True)
    assert flight.phase is Phase.ABORT
    wait_for(0.2, landed=not lifts)
    assert flight.history[-2:] == phases
    assert flight.view.armed is lifts


@pytest.mark.parametrize(("grade", "is_quiet"), [(0.1, True), (0.0, False)])
def test_deck_that_heaves_is_not_quiet_and_one_that_climbs_a_road_is(grade: float, *, is_quiet: bool) -> None:
    climbs = replace(pad_at((5.0, 0.0, 0.5)), yaw_rad=0.0, grade=grade)
    assert is_deck_quiet(situation(0.0, pad=climbs), CONFIG.sortie.launch) is is_quiet
