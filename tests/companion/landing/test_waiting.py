"""A descent says what it waits for and its time stands still meanwhile; neither waiting nor straying is without end."""

import pytest

from companion.core.reasons import Cause, Reason
from companion.landing.memory import StepMemory
from companion.landing.outputs import landing_status
from companion.landing.transitions import take_events
from companion.landing.waiting import waits_at_m, why_held_up
from companion.situation.phases import Event, Phase
from companion.situation.situation import Situation
from companion.vehicle.driving import Driving
from companion.vehicle.surprise import Surprise
from link.messages import Vector3
from link.records import replace
from tests.companion.facts import (
    CONFIG,
    GEAR_M,
    NOW_NS,
    TICK_NS,
    at_time,
    braking_pad,
    changed,
    decided,
    drone_at,
    later,
    pad_at,
    progress,
    situation,
)
from tests.companion.world import PAD_HEIGHT_M, Flight, reached

DESCENT = CONFIG.descent
WAITING_M = DESCENT.wait.height_m
SURPRISED = Surprise(surprised_ns=NOW_NS)
KNOWN = Surprise(speed_std_m_s=0.05)
UNEVEN = replace(KNOWN, driving=Driving(unevenness_m_s2=2.0 * DESCENT.uneven.acceleration_m_s2))
WINDING = replace(KNOWN, driving=Driving(winding_m_s2=2.0 * DESCENT.uneven.winding_acceleration_m_s2))
TURNING = replace(KNOWN, driving=Driving(changes=((0.0, -1.5 * DESCENT.uneven.turning_acceleration_m_s2),)))
STRAYING = situation(DESCENT.alignment.height_m, 2.0)


def _moving(height_m: float, speed_m_s: float) -> Situation:
    return replace(situation(), drone=drone_at(height_m, 0.0, (0.0, speed_m_s, 0.0), pad=pad_at()))


@pytest.mark.parametrize(
    ("facts", "surprise", "reason"),
    [
        (situation(WAITING_M), KNOWN, Reason.ALIGNED),
        (situation(WAITING_M), SURPRISED, Reason.SPEED_SURPRISED),
        (situation(WAITING_M, 0.8), KNOWN, Reason.NOT_OVER_PAD),
        (situation(WAITING_M, pad=braking_pad(2.0)), KNOWN, Reason.SPEED_CHANGES),
        (_moving(WAITING_M, 0.5), KNOWN, Reason.UNSETTLED),
        (situation(DESCENT.alignment.height_m), SURPRISED, Reason.ALIGNED),
        (situation(0.9 * DESCENT.commit_height_m), SURPRISED, Reason.ALIGNED),
    ],
    ids=["goes on", "surprised", "beside", "brakes", "unsettled", "still sinking", "committed"],
)
def test_status_says_what_a_descent_waits_for(facts: Situation, surprise: Surprise, reason: Reason) -> None:
    memory = changed(StepMemory(), phase=Phase.DESCEND, cause=Cause(Reason.ALIGNED), surprise=surprise)
    assert landing_status(memory, facts, CONFIG).reason_code == reason.name


@pytest.mark.parametrize(
    ("surprise", "reason"),
    [
        (UNEVEN, Reason.SPEED_UNEVEN),
        (WINDING, Reason.ROAD_WINDS),
        (TURNING, Reason.ROAD_TURNS_HARD),
    ],
    ids=["uneven", "winding", "turning"],
)
def test_only_over_late_data_a_descent_waits_for_another_road_or_driver(surprise: Surprise, reason: Reason) -> None:
    driving, late_s = situation(WAITING_M), 2.0 * DESCENT.uneven.age_s
    for lateness_s, told in ((late_s, Cause(reason)), (0.5 * DESCENT.uneven.age_s, None)):
        late = replace(surprise, lateness_s=lateness_s)
        memory = changed(StepMemory(), phase=Phase.DESCEND, cause=Cause(Reason.ALIGNED), surprise=late)
        assert why_held_up(memory, driving, CONFIG) == told


def _kept_surprised(flight: Flight, duration_s: float) -> None:
    """Fly on above a vehicle that surprises in every step."""
    for _ in range(round(duration_s * 1e9 / TICK_NS)):
        surprise = Surprise(surprised_ns=flight.monotonic_ns)
        flight.memory = changed(flight.memory, surprise=surprise)
        flight.step()
        if flight.phase is not Phase.DESCEND:
            return


def _impatient() -> Flight:
    """A flight in its descent, with less time for it and for waiting in it than by default."""
    flight = reached(Phase.DESCEND)
    uneven = DESCENT.uneven.model_copy(update={"wait_max_s": 8.0, "hold_s": 4.0})
    descent = DESCENT.model_copy(update={"time_limit_s": 10.0, "uneven": uneven})
    flight.config = flight.config.model_copy(update={"descent": descent})
    return flight


@pytest.mark.slow
def test_descent_that_waits_comes_to_rest_at_its_height() -> None:
    flight = reached(Phase.DESCEND)
    _kept_surprised(flight, 5.0)
    for _ in range(10):
        _kept_surprised(flight, 0.5)
        feet_m = flight.own.position_enu_m[2] - GEAR_M - PAD_HEIGHT_M
        assert feet_m == pytest.approx(WAITING_M, abs=0.03)


@pytest.mark.slow
def test_descent_outlasts_its_time_limit_above_a_vehicle_that_surprises_and_then_lands() -> None:
    flight = _impatient()
    descent = flight.config.descent
    _kept_surprised(flight, descent.time_limit_s + 0.25 * descent.uneven.wait_max_s)
    assert flight.phase is Phase.DESCEND
    flight.run_until(Phase.SECURED, limit_s=descent.uneven.hold_s + 10.0)
    assert Phase.ABORT not in flight.history
    assert flight.memory.progress.waited_s == 0.0


@pytest.mark.slow
def test_descent_above_a_vehicle_that_surprises_for_ever_is_broken_off() -> None:
    flight = _impatient()
    limit_s = flight.config.descent.time_limit_s + flight.config.descent.uneven.wait_max_s
    _kept_surprised(flight, limit_s - 1.0)
    assert flight.phase is Phase.DESCEND
    _kept_surprised(flight, 2.0)
    assert (flight.phase, flight.sentence) == (Phase.ABORT, "descend took longer than 10 s")


def _after(memory: StepMemory, facts: Situation, limit_s: float) -> tuple[StepMemory, Situation]:
    """Decide on facts that stay as they are until the phase changes."""
    inputs, phase = Flight().inputs(), memory.progress.phase
    for _ in range(round(limit_s * 1e9 / TICK_NS)):
        facts = later(facts, TICK_NS)
        memory, _ = take_events(
            memory, facts, replace(inputs, t_ns=facts.t_ns, monotonic_ns=facts.monotonic_ns), CONFIG
        )
        if memory.progress.phase is not phase:
            return memory, facts
    raise AssertionError(f"still in {phase.value} after {limit_s} s")


def test_approach_that_strays_again_and_again_is_broken_off() -> None:
    memory, facts = changed(StepMemory(), phase=Phase.DESCEND, since_ns=NOW_NS), situation()
    for _ in range(DESCENT.strays_max):
        memory, facts = _after(memory, at_time(STRAYING, facts.t_ns), DESCENT.stray_hold_s + 0.1)
        assert memory.progress.phase is Phase.ALIGN
        memory, facts = _after(memory, at_time(situation(), facts.t_ns), 1.0)
        assert memory.progress.phase is Phase.DESCEND
    memory, facts = _after(memory, at_time(STRAYING, facts.t_ns), DESCENT.stray_hold_s + 0.1)
    assert (memory.progress.phase, memory.progress.cause.reason) == (Phase.ABORT, Reason.STRAYS)
    assert not memory.progress.begun_anew


def test_approach_that_loses_its_alignment_again_and_again_is_broken_off() -> None:
    memory, facts = changed(StepMemory(), phase=Phase.ALIGN, since_ns=NOW_NS), situation()
    far = situation(2.0, 2.0 * DESCENT.alignment.begin_distance_m + 0.1)
    for _ in range(DESCENT.strays_max):
        memory, facts = _after(memory, at_time(far, facts.t_ns), 1.0)
        assert (memory.progress.phase, memory.progress.cause.reason) == (Phase.CHASE, Reason.ALIGNMENT_LOST)
        memory, facts = _after(memory, at_time(situation(2.0, 1.0), facts.t_ns), 1.0)
        assert memory.progress.phase is Phase.ALIGN
    memory, facts = _after(memory, at_time(far, facts.t_ns), 1.0)
    assert (memory.progress.phase, memory.progress.cause.reason) == (Phase.ABORT, Reason.ALIGNMENT_LOST)
    assert not memory.progress.begun_anew


@pytest.mark.slow
def test_approach_to_a_pad_that_is_lost_from_sight_again_and_again_is_broken_off() -> None:
    memory, facts = changed(StepMemory(), phase=Phase.DESCEND, since_ns=NOW_NS), situation()
    unseen = replace(pad_at(std_m=0.5), is_coarse=True)
    for _ in range(DESCENT.unseen.anew_max):
        memory, facts = _after(memory, at_time(situation(pad=unseen), facts.t_ns), 0.1)
        assert (memory.progress.phase, memory.progress.cause.reason) == (Phase.ALIGN, Reason.PAD_TO_BE_SEEN)
        memory, facts = _after(memory, at_time(situation(pad=unseen), facts.t_ns), DESCENT.unseen.hold_s + 0.1)
        assert (memory.progress.phase, memory.progress.cause.reason) == (Phase.CHASE, Reason.PAD_NOT_SEEN)
        memory, facts = _after(memory, at_time(situation(), facts.t_ns), 0.1)
        memory, facts = _after(memory, at_time(situation(), facts.t_ns), 1.0)
        assert memory.progress.phase is Phase.DESCEND
    memory, facts = _after(memory, at_time(situation(pad=unseen), facts.t_ns), 0.1)
    assert (memory.progress.phase, memory.progress.cause.reason) == (Phase.ABORT, Reason.PAD_TO_BE_SEEN)
    assert not memory.progress.begun_anew


@pytest.mark.parametrize(
    ("strays", "event"), [(DESCENT.strays_max - 1, Event.OUT_OF_ALIGNMENT), (DESCENT.strays_max, Event.UNSAFE)]
)
def test_straying_is_unsafe_once_it_has_been_aligned_again_for_so_often(strays: int, event: Event) -> None:
    held = {Reason.STRAYS: NOW_NS - 10**10}
    decision = decided(replace(progress(Phase.DESCEND), begun_anew={Reason.STRAYS: strays}), STRAYING, held)
    assert decision == (event, Cause(Reason.STRAYS))


@pytest.mark.parametrize(
    ("age_s", "velocity", "waits"),
    [(0.5, (5.0, 1.0, 0.0), True), (0.1, (5.0, 1.0, 0.0), False), (0.5, (0.1, 0.1, 0.0), False)],
    ids=["late data", "fresh data", "stands"],
)
def test_descent_waits_above_an_uneven_driver_of_whom_is_told_late(
    age_s: float, velocity: Vector3, *, waits: bool
) -> None:
    surprise = Surprise(driving=Driving(unevenness_m_s2=0.7), lateness_s=age_s)
    memory = changed(StepMemory(), phase=Phase.DESCEND, surprise=surprise)
    here = situation(WAITING_M + 0.05, pad=pad_at(velocity))
    assert waits_at_m(memory, here, CONFIG) == (WAITING_M if waits else None)
    assert why_held_up(memory, here, CONFIG) == (Cause(Reason.SPEED_UNEVEN) if waits else None)


@pytest.mark.parametrize(
    ("beside_m", "height_m", "is_coarse", "waits"),
    [
        (DESCENT.alignment.distance_m + 0.01, 0.9, True, True),
        (DESCENT.alignment.distance_m - 0.01, 0.9, True, False),
        (DESCENT.alignment.distance_m + 0.01, 0.9, False, False),
        (DESCENT.alignment.distance_m + 0.01, 0.95 * DESCENT.wait.centred_height_m, True, False),
    ],
    ids=["beside", "centred", "placed by fixes", "already below"],
)
def test_descent_onto_a_pad_that_only_the_detector_places_is_centred_while_it_is_seen(
    beside_m: float, height_m: float, *, is_coarse: bool, waits: bool
) -> None:
    memory = changed(StepMemory(), phase=Phase.DESCEND, surprise=Surprise(speed_std_m_s=0.05))
    here = situation(height_m, beside_m, replace(pad_at(), is_coarse=is_coarse))
    assert waits_at_m(memory, here, CONFIG) == (DESCENT.wait.height_coarse_m if waits else None)
