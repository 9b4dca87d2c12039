"""A descent says what it waits for and its time stands still meanwhile; neither waiting nor straying is without end."""

import pytest

from companion.core.reasons import Cause, Reason
from companion.landing.decisions.waiting import waits_at_m
from companion.landing.outputs import landing_status
from companion.landing.state.memory import StepMemory
from companion.landing.transitions import take_events
from companion.situation.phases import Event, Phase
from companion.situation.situation import Situation
from link.messages import ContactForecast
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
    forecast_of,
    later,
    pad_at,
    progress,
    situation,
)
from tests.companion.world import PAD_HEIGHT_M, Flight, reached

DESCENT = CONFIG.descent
WAITING_M = DESCENT.wait.height_m
FLIGHT_LIMITS = CONFIG.limits.flight_limits()
NEAR_M_S = CONFIG.abort.near_speed_max_m_s
RISKY = forecast_of(0.5, in_s=1.5)
RISK = DESCENT.risk
STRAYING = situation(DESCENT.alignment.height_m, 2.0)


def _moving(height_m: float, speed_m_s: float) -> Situation:
    return replace(situation(), drone=drone_at(height_m, 0.0, (0.0, speed_m_s, 0.0), pad=pad_at()))


@pytest.mark.parametrize(
    ("facts", "contact", "reason"),
    [
        (situation(WAITING_M), None, Reason.ALIGNED),
        (situation(WAITING_M), RISKY, Reason.MOMENT_RISKY),
        (situation(WAITING_M, 0.8), None, Reason.NOT_OVER_PAD),
        (situation(WAITING_M, pad=braking_pad(2.0)), None, Reason.ALIGNED),
        (_moving(WAITING_M, 0.9 * NEAR_M_S), None, Reason.ALIGNED),
        (_moving(WAITING_M, 1.1 * NEAR_M_S), None, Reason.NOT_OVER_PAD),
        (situation(DESCENT.alignment.height_m), RISKY, Reason.ALIGNED),
        (situation(0.9 * DESCENT.commit_height_m), RISKY, Reason.ALIGNED),
    ],
    ids=["goes on", "risky", "beside", "brakes", "moves", "fast", "still sinking", "committed"],
)
def test_status_says_what_a_descent_waits_for(
    facts: Situation, contact: ContactForecast | None, reason: Reason
) -> None:
    memory = changed(StepMemory(), phase=Phase.DESCEND, cause=Cause(Reason.ALIGNED))
    memory = changed(memory, contact=contact, risk=None if contact is None else contact.unsafe)
    assert landing_status(memory, facts, CONFIG).reason_code == reason.name


def _kept_risky(flight: Flight, duration_s: float) -> None:
    """Fly on above a vehicle over which every forecast says a great risk."""
    for _ in range(round(duration_s * 1e9 / TICK_NS)):
        flight.memory = changed(flight.memory, contact=RISKY, risk=1.0, made_ns=flight.monotonic_ns, has_begun=False)
        flight.step()
        if flight.phase is not Phase.DESCEND:
            return


def _impatient() -> Flight:
    """A flight in its descent, with less time for it and for waiting in it than by default."""
    flight = reached(Phase.DESCEND)
    risk = RISK.model_copy(update={"wait_max_s": 8.0})
    descent = DESCENT.model_copy(update={"time_limit_s": 10.0, "risk": risk})
    flight.config = flight.config.model_copy(update={"descent": descent})
    return flight


@pytest.mark.slow
def test_descent_that_waits_comes_to_rest_at_its_height() -> None:
    flight = reached(Phase.DESCEND)
    _kept_risky(flight, 5.0)
    for _ in range(10):
        _kept_risky(flight, 0.5)
        feet_m = flight.own.position_enu_m[2] - GEAR_M - PAD_HEIGHT_M
        assert feet_m == pytest.approx(WAITING_M, abs=0.03)


@pytest.mark.slow
def test_descent_outlasts_its_time_limit_while_the_risk_is_too_great_and_then_lands() -> None:
    flight = _impatient()
    descent = flight.config.descent
    _kept_risky(flight, descent.time_limit_s + 0.25 * descent.risk.wait_max_s)
    assert flight.phase is Phase.DESCEND
    flight.run_until(Phase.SECURED, limit_s=10.0)
    assert Phase.ABORT not in flight.history
    assert flight.memory.progress.waited_s == 0.0


@pytest.mark.slow
def test_descent_over_a_risk_that_never_ends_is_broken_off() -> None:
    flight = _impatient()
    limit_s = flight.config.descent.time_limit_s + flight.config.descent.risk.wait_max_s
    _kept_risky(flight, limit_s - 1.0)
    assert flight.phase is Phase.DESCEND
    _kept_risky(flight, 2.0)
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


def test_approach_that_loses_the_heading_of_a_vehicle_that_drives_aligns_again_and_costs_no_retry() -> None:
    memory, facts = changed(StepMemory(), phase=Phase.DESCEND, since_ns=NOW_NS), situation()
    vague = situation(pad=pad_at(placed=False))
    for _ in range(DESCENT.unseen.anew_max):
        memory, facts = _after(memory, at_time(vague, facts.t_ns), 0.1)
        assert (memory.progress.phase, memory.progress.cause.reason) == (Phase.ALIGN, Reason.HEADING_LOST)
        memory, facts = _after(memory, at_time(situation(), facts.t_ns), 1.0)
        assert memory.progress.phase is Phase.DESCEND
    assert memory.progress.retries == 0
    memory, facts = _after(memory, at_time(vague, facts.t_ns), 0.1)
    assert (memory.progress.phase, memory.progress.cause.reason) == (Phase.ABORT, Reason.HEADING_LOST)


@pytest.mark.parametrize(
    ("strays", "event"), [(DESCENT.strays_max - 1, Event.OUT_OF_ALIGNMENT), (DESCENT.strays_max, Event.UNSAFE)]
)
def test_straying_is_unsafe_once_it_has_been_aligned_again_for_so_often(strays: int, event: Event) -> None:
    held = {Reason.STRAYS: NOW_NS - 10**10}
    decision = decided(replace(progress(Phase.DESCEND), begun_anew={Reason.STRAYS: strays}), STRAYING, held)
    assert decision == (event, Cause(Reason.STRAYS))


@pytest.mark.parametrize(
    ("beside_m", "height_m", "is_coarse", "waits"),
    [
        (DESCENT.wait.centred_distance_m + 0.01, 0.9, True, True),
        (DESCENT.wait.centred_distance_m - 0.01, 0.9, True, False),
        (DESCENT.wait.centred_distance_m + 0.01, 0.9, False, False),
        (DESCENT.wait.centred_distance_m + 0.01, 0.95 * DESCENT.wait.centred_height_m, True, False),
    ],
    ids=["beside", "centred", "placed by fixes", "already below"],
)
def test_descent_onto_a_pad_that_only_the_detector_places_is_centred_while_it_is_seen(
    beside_m: float, height_m: float, *, is_coarse: bool, waits: bool
) -> None:
    memory = changed(StepMemory(), phase=Phase.DESCEND)
    here = situation(height_m, beside_m, replace(pad_at(), is_coarse=is_coarse))
    assert waits_at_m(memory, here, CONFIG) == (DESCENT.wait.height_coarse_m if waits else None)
