"""Just above the pad a drone that leans harder than steady flight needs waits until that is over."""

import math

import pytest

from companion.config.companion import CompanionConfig
from companion.core.data import GRAVITY_M_S2, OwnState
from companion.landing.decisions.waiting import waits_at_m, waits_for_calm
from companion.landing.state.memory import StepMemory
from companion.landing.steering.sway import Sway, is_swaying, update_sway
from companion.situation.phases import Phase
from link.records import replace
from tests.companion.facts import NOW_NS, TICK_NS, changed, pad_at, situation

CONFIG = CompanionConfig()
DESCENT = CONFIG.descent
STEADY_RAD = math.radians(17.0)
TOO_MUCH_RAD = math.atan(math.tan(STEADY_RAD) + (DESCENT.sway.acceleration_max_m_s2 + 0.2) / GRAVITY_M_S2)
NOT_YET_RAD = math.atan(math.tan(STEADY_RAD) + (DESCENT.sway.acceleration_max_m_s2 - 0.2) / GRAVITY_M_S2)


def leaning(t_ns: int, tilt_rad: float, towards_rad: float = 0.4) -> OwnState:
    """A drone that leans by `tilt_rad` towards a direction in W."""
    s = math.sin(0.5 * tilt_rad)
    return OwnState(
        t_ns=t_ns,
        position_enu_m=(0.0, 0.0, 3.0),
        velocity_enu_m_s=(0.0, 0.0, 0.0),
        orientation_wxyz=(math.cos(0.5 * tilt_rad), -s * math.sin(towards_rad), s * math.cos(towards_rad), 0.0),
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
    )


def _newest_ns(sway: Sway) -> int:
    assert sway.t_ns is not None
    return sway.t_ns


def after(tilt_rad: float, length_s: float, sway: Sway | None = None, turn_rad_s: float = 0.0) -> Sway:
    sway = Sway() if sway is None else sway
    start_ns = sway.t_ns or NOW_NS
    for i in range(1, round(length_s * 1e9 / TICK_NS) + 1):
        own_ns = start_ns + i * TICK_NS
        own = leaning(own_ns, tilt_rad, 0.4 + turn_rad_s * i * TICK_NS * 1e-9)
        sway = update_sway(sway, own, own_ns, DESCENT.sway)
    return sway


@pytest.mark.parametrize("turn_rad_s", [0.0, 0.4], ids=["wind or speed", "a circle of 20 m at 8 m/s"])
def test_lean_that_lasts_is_no_sway(turn_rad_s: float) -> None:
    assert after(STEADY_RAD, 4.0, turn_rad_s=turn_rad_s).swayed_ns is None


@pytest.mark.parametrize(("tilt_rad", "is_sway"), [(TOO_MUCH_RAD, True), (NOT_YET_RAD, False), (0.0, False)])
def test_lean_far_beyond_that_of_the_last_second_is_sway_at_once(tilt_rad: float, *, is_sway: bool) -> None:
    sway = after(tilt_rad, 0.02, after(STEADY_RAD, 4.0))
    assert is_swaying(sway, _newest_ns(sway), DESCENT.sway) is is_sway


def test_sway_counts_until_the_drone_has_been_calm_for_a_while() -> None:
    sway = after(TOO_MUCH_RAD, 0.02, after(STEADY_RAD, 4.0))
    calm = after(STEADY_RAD, DESCENT.sway.calm_hold_s + 0.1, sway)
    assert is_swaying(calm, _newest_ns(sway) + round(0.9e9 * DESCENT.sway.calm_hold_s), DESCENT.sway)
    assert not is_swaying(calm, _newest_ns(calm), DESCENT.sway)


def test_report_that_is_taken_again_changes_nothing() -> None:
    sway = after(STEADY_RAD, 1.0)
    assert update_sway(sway, leaning(_newest_ns(sway), 0.6), _newest_ns(sway), DESCENT.sway) is sway


@pytest.mark.parametrize(
    ("phase", "height_m", "lean", "waits"),
    [
        (Phase.DESCEND, 1.0, 0.3, True),
        (Phase.DESCEND, DESCENT.sway.height_min_m + 0.07, 0.3, True),
        (Phase.DESCEND, DESCENT.sway.height_min_m + 0.05, 0.3, False),
        (Phase.TOUCHDOWN, 0.3, 0.3, False),
        (Phase.ALIGN, 1.0, 0.3, False),
    ],
    ids=["high", "lowest foot high enough", "lowest foot about to touch", "stands", "aligns"],
)
def test_only_a_descent_that_can_still_be_stopped_waits(
    phase: Phase, height_m: float, lean: float, *, waits: bool
) -> None:
    facts = situation(height_m)
    assert facts.drone is not None
    facts = replace(facts, drone=replace(facts.drone, lean=lean))
    memory = changed(StepMemory(), phase=phase, sway=Sway(t_ns=NOW_NS, swayed_ns=NOW_NS))
    assert waits_for_calm(memory, facts, CONFIG) is waits
    assert not waits_for_calm(changed(memory, sway=Sway(t_ns=NOW_NS)), facts, CONFIG)


@pytest.mark.parametrize(
    ("is_coarse", "waiting_m"), [(False, DESCENT.commit_height_m), (True, DESCENT.wait.height_coarse_m)]
)
def test_drone_that_leans_waits_no_lower_than_the_pad_is_known(waiting_m: float, *, is_coarse: bool) -> None:
    memory = changed(StepMemory(), phase=Phase.DESCEND, sway=Sway(t_ns=NOW_NS, swayed_ns=NOW_NS))
    facts = situation(0.3, pad=replace(pad_at(), is_coarse=is_coarse))
    assert waits_at_m(memory, facts, CONFIG) == waiting_m
