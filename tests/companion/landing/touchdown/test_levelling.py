"""A drone is levelled so as not to touch down with one foot."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.autopilots.response import Cascade, ResponseModel
from companion.config.companion import CompanionConfig
from companion.core.data import GRAVITY_M_S2, Array, FlightLimits, OwnState
from companion.landing.state.memory import StepMemory
from companion.landing.state.step_data import LinkDelay, StepInputs
from companion.landing.steering.flown_plan import FlownPlan, state_in_plan
from companion.landing.touchdown.levelling import Levelling, levelled, levelling_now
from companion.planning.guidance import Trajectory
from companion.situation.own_drone import drone_now
from companion.situation.phases import Phase
from companion.situation.situation import Situation
from companion.vehicle.pad import PadPath
from companion.vehicle.shake import PadSwing
from link.records import replace
from tests.companion.facts import NOW_NS, changed, drone_at, pad_at, situation

CONFIG = CompanionConfig()
LIMITS = CONFIG.limits.flight_limits()
INPUTS = StepInputs(t_ns=NOW_NS, monotonic_ns=NOW_NS, limits=LIMITS)
LEVEL_M_S2 = CONFIG.touchdown.level.acceleration_m_s2
DESCENDS = changed(StepMemory(), phase=Phase.DESCEND)


def leans_max(height_m: float, lean: float, memory: StepMemory = DESCENDS) -> float:
    here = situation(height_m)
    assert here.drone is not None
    leaning = replace(here, drone=replace(here.drone, lean=lean))
    return _leans_max_m_s2(levelling_now(memory, leaning, INPUTS, CONFIG))


def _leans_max_m_s2(levelling: Levelling | None) -> float:
    return LIMITS.tilt_acceleration_m_s2 if levelling is None else levelling.leans_max_m_s2


@pytest.mark.parametrize(
    ("height_m", "lean", "levels"),
    [(0.07, 0.0, True), (0.09, 0.0, False), (0.16, 0.5, True), (0.17, 0.5, False), (1.0, 0.9, False)],
)
def test_a_leaning_drone_is_levelled_as_much_higher_as_its_lowest_foot_hangs_down(
    height_m: float, lean: float, *, levels: bool
) -> None:
    assert leans_max(height_m, lean) == (LEVEL_M_S2 if levels else LIMITS.tilt_acceleration_m_s2)


@pytest.mark.parametrize(
    "turns_m_s2", [0.0, 1.25, 2.7], ids=["straight on", "20 m at 5 m/s", "harder than it may lean"]
)
def test_a_drone_that_can_come_upright_in_time_leans_no_more_than_it_may_beyond_steady_flight(
    turns_m_s2: float,
) -> None:
    stiff = replace(LIMITS, jerk_max_m_s3=40.0)
    assert _levelled_m_s2(situation(0.05, pad=_turning(turns_m_s2)), stiff) == pytest.approx(LEVEL_M_S2)


@pytest.mark.parametrize(
    ("air_enu_m_s2", "leans_m_s2"),
    [((0.0, 0.0), 3.5), ((1.6, 1.2), math.hypot(2.0, 3.5)), ((1.2, -1.6), 5.5), ((-1.2, 1.6), 1.5)],
    ids=["no air", "a turn across the air", "along it", "against it"],
)
def test_a_drone_comes_upright_from_the_lean_that_turn_and_air_take_together(
    air_enu_m_s2: tuple[float, float], leans_m_s2: float
) -> None:
    air, facts = np.array(air_enu_m_s2), situation(0.05, pad=_turning(3.5))
    less_m_s2 = 1.606  # x of x^2 / 2j + x t = 0.35 m/s, in the t of 0.08 m at 0.45 m/s, at a jerk j of 20 m/s^3
    levelled_m_s2 = _levelled_m_s2(facts, memory=_holding(air, air))
    steady_m_s2 = math.hypot(*air_enu_m_s2)
    assert levelled_m_s2 == pytest.approx(max(steady_m_s2 + LEVEL_M_S2, leans_m_s2 - less_m_s2), abs=0.001)


@given(turns_m_s2=st.floats(0.0, 9.0), jerk_m_s3=st.floats(2.0, 40.0))
def test_a_drone_that_is_levelled_gains_no_more_speed_against_the_pad_than_it_may(
    turns_m_s2: float, jerk_m_s3: float
) -> None:
    limits = replace(LIMITS, jerk_max_m_s3=jerk_m_s3, acceleration_max_m_s2=100.0)
    less_m_s2 = max(turns_m_s2 - _levelled_m_s2(situation(0.05, pad=_turning(turns_m_s2)), limits), 0.0)
    left_s = CONFIG.touchdown.level.height_m / CONFIG.descent.sink.contact_rate_m_s
    changes_s = less_m_s2 / jerk_m_s3
    assert less_m_s2 * (0.5 * changes_s + left_s) <= CONFIG.touchdown.level.speed_max_m_s + 1e-9


@pytest.mark.parametrize(("jerk_m_s3", "levels"), [(2.0, True), (20.0, False)])
def test_a_drone_that_turns_slower_is_levelled_earlier(jerk_m_s3: float, *, levels: bool) -> None:
    height_m, pad = CONFIG.touchdown.level.height_m + 0.1, _turning(2.5)
    facts = replace(situation(height_m, pad=pad), drone=drone_at(height_m, 0.0, (0.0, 0.0, -0.4), pad=pad))
    limits = replace(LIMITS, jerk_max_m_s3=jerk_m_s3)
    turns = _holding(pad.acceleration_enu_m_s2[0, :2])
    assert (_levelled_m_s2(facts, limits, turns) < LIMITS.tilt_acceleration_m_s2) is levels


def _turning(turns_m_s2: float) -> PadPath:
    pad = pad_at()
    turn = np.tile([0.6 * turns_m_s2, -0.8 * turns_m_s2, 0.0], (len(pad.offset_s), 1))
    return replace(pad, acceleration_enu_m_s2=turn)


def _levelled_m_s2(facts: Situation, limits: FlightLimits = LIMITS, memory: StepMemory = DESCENDS) -> float:
    return _leans_max_m_s2(levelling_now(memory, facts, replace(INPUTS, limits=limits), CONFIG))


def _holding(holds_enu_m_s2: Array, air_enu_m_s2: Array | None = None) -> StepMemory:
    air = np.zeros(2) if air_enu_m_s2 is None else air_enu_m_s2
    tracking = replace(DESCENDS.model.tracking, holds_enu_m_s2=holds_enu_m_s2, air_enu_m_s2=air)
    return replace(DESCENDS, model=replace(DESCENDS.model, tracking=tracking))


def _tilting(slope: Array) -> PadSwing:
    n = len(slope)
    return PadSwing(
        slope=slope,
        shake_enu=np.zeros((3, n, 2)),
        tilt_std_rad=np.zeros((n, 4)),
        above_m=1.5,
        heave_rad_s=6.0,
    )


def _sinking(height_m: float, sink_m_s: float) -> Situation:
    here = situation(height_m)
    return replace(here, drone=drone_at(height_m, 0.0, (0.0, 0.0, -sink_m_s), pad=pad_at()))


@pytest.mark.parametrize(("sink_m_s", "late_s", "levels"), [(0.4, 0.08, True), (0.4, 0.0, False), (0.2, 0.08, False)])
def test_a_drone_is_levelled_earlier_by_what_its_setpoints_may_be_late(
    sink_m_s: float, late_s: float, *, levels: bool
) -> None:
    facts = _sinking(CONFIG.touchdown.level.height_m + 0.025, sink_m_s)  # 0.4 m/s for 0.08 s are 32 mm
    inputs = replace(INPUTS, link_delay=LinkDelay(std_s=late_s / CONFIG.touchdown.level.late_stds))
    limit_m_s2 = _leans_max_m_s2(levelling_now(DESCENDS, facts, inputs, CONFIG))
    assert limit_m_s2 == (LEVEL_M_S2 if levels else LIMITS.tilt_acceleration_m_s2)


@pytest.mark.parametrize(("lag_s", "is_led", "levels"), [(0.1, False, False), (0.25, False, True), (0.25, True, False)])
def test_a_drone_whose_lean_lags_is_levelled_earlier_by_that(lag_s: float, *, is_led: bool, levels: bool) -> None:
    facts = _sinking(CONFIG.touchdown.level.height_m + 0.05, 0.4)
    cascade = Cascade(
        position_per_s=1.0, velocity_per_s=2.0, integral_per_s2=1.0, lead_s=0.0, attitude_lag_s=lag_s, is_led=is_led
    )
    inputs = replace(INPUTS, response=ResponseModel(cascade, np.array([0.0, 0.1])))
    assert (levelling_now(DESCENDS, facts, inputs, CONFIG) is not None) is levels


@pytest.mark.parametrize(
    ("estimated_m", "seen_m", "beside_m", "levels"),
    [
        (0.3, 0.05, 0.0, True),
        (0.05, 0.3, 0.0, False),
        (0.05, None, 0.0, True),
        (0.05, 1.6, 0.0, True),
        (0.05, 0.3, 0.7, True),
    ],
    ids=["nearer than estimated", "farther", "nothing seen", "the road is seen", "not above the pad"],
)
def test_the_height_to_be_levelled_at_is_what_a_range_finder_has_just_seen_of_the_pad(
    estimated_m: float, seen_m: float | None, beside_m: float, *, levels: bool
) -> None:
    facts = changed(situation(estimated_m, beside_m), range_height_m=seen_m, range_carried_m=seen_m)
    limit_m_s2 = _leans_max_m_s2(levelling_now(DESCENDS, facts, INPUTS, CONFIG))
    assert limit_m_s2 == (LEVEL_M_S2 if levels else LIMITS.tilt_acceleration_m_s2)


@pytest.mark.parametrize(("leans_m_s2", "levels"), [(2.0, False), (5.0, True)])
def test_a_drone_that_leans_more_than_the_pad_turns_is_levelled_earlier(leans_m_s2: float, *, levels: bool) -> None:
    facts = _sinking(CONFIG.touchdown.level.height_m + 0.05, 0.4)
    limits = replace(LIMITS, jerk_max_m_s3=20.0)
    limit_m_s2 = _levelled_m_s2(facts, limits, _holding(np.array([0.0, leans_m_s2])))
    assert limit_m_s2 == (LEVEL_M_S2 if levels else LIMITS.tilt_acceleration_m_s2)


@pytest.mark.parametrize(("slope", "levels"), [(0.0, False), (0.5, True)])
def test_a_drone_over_a_deck_that_tilts_away_from_it_is_levelled_earlier(slope: float, *, levels: bool) -> None:
    facts = _sinking(CONFIG.touchdown.level.height_m + 0.05, 0.4)
    pad = facts.pad
    assert pad is not None
    north = _tilting(np.tile([0.0, slope], (len(pad.offset_s), 1)))
    limits = replace(LIMITS, jerk_max_m_s3=20.0)
    flies = _holding(np.array([0.0, 2.0]), np.array([0.0, 2.0]))
    levelling = levelling_now(
        flies, replace(facts, pad=replace(pad, swing=north)), replace(INPUTS, limits=limits), CONFIG
    )
    assert (levelling is not None) is levels
    if levelling is not None:
        assert levelling.beside_enu_m_s2.tolist() == pytest.approx([0.0, 2.0 + slope * GRAVITY_M_S2])


@pytest.mark.parametrize(("phase", "height_m", "slope"), [(Phase.DESCEND, 0.045, 0.05), (Phase.ABORT, 0.2, 0.0)])
def test_a_drone_levels_with_the_deck_at_its_contact_and_with_that_of_now_as_it_climbs_away(
    phase: Phase, height_m: float, slope: float
) -> None:
    facts = _sinking(height_m, CONFIG.descent.sink.contact_rate_m_s)  # the lower one touches in 0.1 s
    pad = facts.pad
    assert pad is not None
    tilts = _tilting(0.5 * np.column_stack([pad.offset_s, np.zeros(len(pad.offset_s))]))
    levelling = levelling_now(
        changed(DESCENDS, phase=phase), replace(facts, pad=replace(pad, swing=tilts)), INPUTS, CONFIG
    )
    assert levelling is not None
    assert levelling.beside_enu_m_s2.tolist() == pytest.approx([slope * GRAVITY_M_S2, 0.0])


def test_a_drone_that_leans_against_the_wind_of_its_way_may_lean_to_either_side_as_much() -> None:
    levelling = levelling_now(_holding(np.array([3.0, 0.0]), np.array([3.0, 0.0])), situation(0.05), INPUTS, CONFIG)
    assert levelling is not None
    assert levelling.leans_max_m_s2 == pytest.approx(3.0 + LEVEL_M_S2)


directions = st.tuples(st.floats(-9.0, 9.0), st.floats(-9.0, 9.0)).map(np.array)


@given(asked=directions, beside=directions, most_m_s2=st.floats(0.5, 6.0))
def test_a_levelled_plan_leans_by_no_more_than_it_may_once_its_lean_has_changed(
    asked: Array, beside: Array, most_m_s2: float
) -> None:
    jerk_m_s3, offset_s = 20.0, np.array([0.0, 0.02, 0.05, 0.1, 0.2, 2.0])
    still = np.zeros((len(offset_s), 3))
    path = Trajectory(
        offset_s=offset_s,
        position_enu_m=still,
        velocity_enu_m_s=still,
        acceleration_enu_m_s2=still + np.array([*asked, 1.0]),
    )
    flown = FlownPlan(starts_ns=0, trajectory=path, lowest_enu_m=0.0, shaping=None, limits=LIMITS)
    plan = levelled(flown, Levelling(leans_max_m_s2=most_m_s2, beside_enu_m_s2=beside, jerk_max_m_s3=jerk_m_s3))
    acceleration = plan.trajectory.acceleration_enu_m_s2
    leans = np.linalg.norm(acceleration[:, :2] + beside, axis=1)
    changes = np.linalg.norm(np.diff(acceleration[:, :2], axis=0), axis=1)
    assert (changes <= jerk_m_s3 * np.diff(offset_s) + 1e-9).all()
    assert leans[-1] <= most_m_s2 + 1e-9
    assert (leans <= max(leans[0], most_m_s2) + 1e-9).all()
    assert (acceleration[:, 2] == 1.0).all()
    within = state_in_plan(plan.trajectory, 0.05 - 1e-9)
    assert within.velocity_enu_m_s[:2] == pytest.approx(plan.trajectory.velocity_enu_m_s[2, :2], abs=1e-6)
    assert within.position_enu_m[:2] == pytest.approx(plan.trajectory.position_enu_m[2, :2], abs=1e-6)


def test_nothing_but_a_descent_and_its_abort_is_levelled() -> None:
    assert leans_max(0.05, 0.0, changed(DESCENDS, phase=Phase.ALIGN)) == LIMITS.tilt_acceleration_m_s2


@pytest.mark.parametrize(("height_m", "lean", "levels"), [(0.4, 0.0, True), (0.44, 0.0, False), (0.5, 0.5, True)])
def test_a_drone_that_breaks_off_climbs_before_it_leans(height_m: float, lean: float, *, levels: bool) -> None:
    limit_m_s2 = leans_max(height_m, lean, changed(DESCENDS, phase=Phase.ABORT))
    assert limit_m_s2 == (LEVEL_M_S2 if levels else LIMITS.tilt_acceleration_m_s2)


@pytest.mark.parametrize(
    ("orientation_wxyz", "lean"),
    [((1.0, 0.0, 0.0, 0.0), 0.0), ((0.9659258, 0.2588190, 0.0, 0.0), 0.5), ((0.7071068, 0.0, 0.0, 0.7071068), 0.0)],
    ids=["level", "rolled by 30 degrees", "turned"],
)
def test_lean_is_the_sine_of_the_tilt(orientation_wxyz: tuple[float, float, float, float], lean: float) -> None:
    own = OwnState(
        t_ns=NOW_NS,
        position_enu_m=(0.0, 0.0, 5.0),
        velocity_enu_m_s=(0.0, 0.0, 0.0),
        orientation_wxyz=orientation_wxyz,
        angular_velocity_flu_rad_s=(0.0, 0.0, 0.0),
    )
    drone = drone_now(own, NOW_NS, 0.0, 1.0)
    assert drone is not None
    assert drone.lean == pytest.approx(lean, abs=1e-6)
