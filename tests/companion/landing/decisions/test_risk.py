"""A descent waits for a moment at which a contact is not risky, and goes back up from what becomes much riskier."""

import math

import numpy as np
import pytest

from companion.core.reasons import Cause, Reason
from companion.landing.decisions.waiting import is_moment_quiet, waits_at_m, why_held_up
from companion.landing.state.memory import StepMemory
from companion.situation.phases import Phase
from companion.situation.situation import Situation
from companion.vehicle.hindsight import Hindsight
from companion.vehicle.shake import PadSwing
from link.records import replace
from tests.companion.facts import CONFIG, changed, forecast_of, pad_at, situation

DESCENT = CONFIG.descent
WAITING_M = DESCENT.wait.height_m
SWINGING = PadSwing(
    slope=np.zeros((5, 2)),
    shake_enu=np.zeros((3, 5, 2)),
    tilt_std_rad=np.zeros((5, 4)),
    above_m=1.5,
    heave_rad_s=0.6,
)
RISK = DESCENT.risk.begins_max
IN_S = 2.0


def _over_swinging_deck(unsafe: float | None, *, has_begun: bool = False) -> tuple[StepMemory, Situation]:
    """At the height of waiting, with that forecast of a contact begun now."""
    contact = None if unsafe is None else forecast_of(unsafe, IN_S)
    memory = changed(
        StepMemory(), phase=Phase.DESCEND, cause=Cause(Reason.ALIGNED), hindsight=Hindsight(speed_std_m_s=0.05)
    )
    known = replace(memory.forecast, contact=contact, risk=unsafe, has_begun=has_begun)
    memory = replace(memory, forecast=known)
    return memory, situation(WAITING_M, pad=replace(pad_at(), swing=SWINGING))


@pytest.mark.parametrize(
    ("unsafe", "has_begun", "waits"),
    [(1.01 * RISK, False, True), (0.99 * RISK, False, False), (1.0, True, False), (None, False, False)],
    ids=["risky", "quiet", "decided", "not forecast"],
)
def test_swinging_deck_s_quiet_moment_is_waited_for(unsafe: float | None, has_begun: bool, waits: bool) -> None:
    memory, here = _over_swinging_deck(unsafe, has_begun=has_begun)
    assert why_held_up(memory, here, CONFIG) == (Cause(Reason.MOMENT_RISKY, (RISK,)) if waits else None)
    assert waits_at_m(memory, here, CONFIG) == (WAITING_M if waits else None)


def test_deck_that_heaves_back_before_the_contact_is_not_waited_for() -> None:
    memory, here = _over_swinging_deck(1.0)
    shaking = replace(SWINGING, heave_rad_s=2.0 * math.pi * 0.5)
    assert why_held_up(memory, replace(here, pad=replace(pad_at(), swing=shaking)), CONFIG) is None


MUCH = DESCENT.risk.turns_back_min


@pytest.mark.parametrize(
    ("unsafe", "has_begun", "waits"),
    [
        (1.01 * RISK, False, RISK),
        (0.99 * RISK, False, None),
        (0.99 * MUCH, True, None),
        (1.01 * MUCH, True, MUCH),
        (None, False, None),
    ],
    ids=["risky", "quiet", "has begun", "has become much riskier", "not forecast"],
)
def test_smaller_risk_is_waited_for_above_a_car(unsafe: float | None, waits: float | None, *, has_begun: bool) -> None:
    memory, here = _over_swinging_deck(unsafe, has_begun=has_begun)
    here = replace(here, pad=pad_at())
    assert why_held_up(memory, here, CONFIG) == (None if waits is None else Cause(Reason.MOMENT_RISKY, (waits,)))
    assert waits_at_m(memory, here, CONFIG) == (None if waits is None else WAITING_M)


def test_a_descent_that_has_begun_waits_for_no_smaller_risk() -> None:
    memory, _ = _over_swinging_deck(1.0)
    assert waits_at_m(memory, situation(0.9 * DESCENT.commit_height_m), CONFIG) is None


@pytest.mark.parametrize(
    ("height_m", "unsafe", "decides"),
    [(WAITING_M, 0.5 * RISK, True), (WAITING_M, 1.5 * RISK, False), (2.0 * WAITING_M, 0.5 * RISK, False)],
    ids=["quiet", "risky", "high"],
)
def test_descent_decides_where_it_would_wait(height_m: float, unsafe: float, decides: bool) -> None:
    assert is_moment_quiet(unsafe, situation(height_m), CONFIG) == decides
