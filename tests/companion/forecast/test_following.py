"""Rollouts come over the pad as the planner itself does, which flies the same autopilot in closed loop."""

import numpy as np
import pytest

from companion.autopilots.response import STATES, Cascade, ResponseModel
from companion.config.planning import MpcConfig
from companion.core.data import GRAVITY_M_S2, Array, FlightLimits
from companion.forecast import steering
from companion.forecast.samples import DT_S, Follower
from companion.landing.steering.ahead import make_up
from companion.landing.steering.targets import HORIZON_OFFSETS_S
from companion.landing.steering.virtual_model import Tracking, response_to
from companion.landing.touchdown.rollout_inputs import way_time_s
from companion.planning.guidance import PlanRequest, ReferenceState, Target
from companion.planning.mpc import Mpc
from link.records import replace
from tests.companion.forecast.descents import DRONE
from tests.companion.planning.cases import LIMITS

LASTS_S, PERIOD_S, HEIGHT_M = 1.8, 0.02, 5.0
MPC = Mpc(MpcConfig())
ARDUPILOT = Cascade(
    position_per_s=1.0,
    velocity_per_s=2.0,
    integral_per_s2=1.0,
    lead_s=0.05,
    derivative=0.5,
    derives_error=True,
    attitude_lag_s=0.2,
)
PX4 = Cascade(
    position_per_s=0.95,
    velocity_per_s=1.8,
    integral_per_s2=0.4,
    lead_s=0.05,
    derivative=0.2,
    attitude_lag_s=0.12,
    is_led=True,
)


def starts(count: int) -> list[tuple[Array, Array]]:
    """Models (3,) and cascades (4,) of drones that come low over a pad: off by decimetres, and pushed."""
    generator = np.random.default_rng(7)
    std = np.array([0.2, 0.25, 0.5, 0.15, 0.1, 0.4])
    drawn = std * generator.standard_normal((count, 6))
    return [(np.array([p - d, v - r, a]), np.array([d, r, -0.5 * u, u])) for p, v, a, d, r, u in drawn]


def flown(model: Array, deviation: Array, response: ResponseModel, limits: FlightLimits) -> Array:
    """Return place and velocity (n, 2) of a drone that the planner leads over a pad at rest, knowing its deviation."""
    count, one_step = len(HORIZON_OFFSETS_S), ResponseModel(response.cascade, np.array([0.0, PERIOD_S]))
    p, v, a = ([one, 0.0, 0.0] for one in model)
    state = ReferenceState(
        position_enu_m=np.array([p[0], 0.0, HEIGHT_M]), velocity_enu_m_s=np.array(v), acceleration_enu_m_s2=np.array(a)
    )
    off, found = np.column_stack((deviation, np.zeros(STATES))), []
    for _ in range(round(LASTS_S / PERIOD_S)):
        found.append((state.position_enu_m[0] + off[0, 0], state.velocity_enu_m_s[0] + off[1, 0]))
        place, still = np.zeros((count, 3)), np.zeros((count, 3))
        place[:, 2] = HEIGHT_M
        pad = Target(
            offset_s=HORIZON_OFFSETS_S, position_enu_m=place, velocity_enu_m_s=still, acceleration_enu_m_s2=still
        )
        request = PlanRequest(
            state=state,
            target=make_up(pad, state, Tracking(deviation=off, compared_ns=0), response, late_s=0.0, ahead_s=0.0),
            limits=limits,
            floor_enu_m=np.full(count, -1e3),
            dt_s=PERIOD_S,
            following=response.following,
        )
        _, result = MPC.plan(None, request)
        mean = 0.5 * (state.acceleration_enu_m_s2[0] + result.next_state.acceleration_enu_m_s2[0])
        off, state = one_step.predict(off, np.array([[mean, 0.0], [0.0, 0.0]]))[1], result.next_state
    return np.array(found)


def rolled_out(model: Array, deviation: Array, drone: Follower, lasts_s: float = LASTS_S) -> Array:
    """Return the same by the rollouts' own steps."""
    path, state = np.column_stack((model, np.zeros(3))), np.column_stack((deviation, np.zeros(STATES)))
    known, still, found = np.zeros((3, 2)), np.zeros(2), []
    for _ in range(round(lasts_s / DT_S)):
        off, before = path[:2] + state[:2], path[2].copy()
        found.append(off[:, 0])
        jerk = steering.steer(path, state, off, known, drone)
        steering.plan(path, jerk, still, still, (drone.jerk_max_m_s3, drone.acceleration_max_m_s2, GRAVITY_M_S2))
        steering.follow(state, before, path[2], still, drone)
    return np.array(found)


def follower(cascade: Cascade, jerk_max_m_s3: float) -> Follower:
    return DRONE._replace(
        stiffness_per_s2=cascade.stiffness_per_s2,
        damping_per_s=cascade.damping_per_s,
        path_share=1.0 if cascade.is_led else cascade.path_share,
        led_share=float(cascade.is_led),
        turns_hz=cascade.turns_hz,
        forgets_hz=cascade.forgets_hz,
        way_s=way_time_s(cascade, DRONE.way_s),
        jerk_max_m_s3=jerk_max_m_s3,
    )


@pytest.mark.parametrize(
    ("cascade", "jerk_max_m_s3"),
    [(ARDUPILOT, 8.0), (ARDUPILOT, 3.0), (PX4, 20.0), (PX4, 3.0)],
    ids=["ardupilot", "ardupilot, hardly any jerk", "px4", "px4, hardly any jerk"],
)
def test_rollouts_come_over_the_pad_as_the_planner_does(cascade: Cascade, jerk_max_m_s3: float) -> None:
    limits = replace(LIMITS, jerk_max_m_s3=jerk_max_m_s3, acceleration_max_m_s2=DRONE.acceleration_max_m_s2)
    drone, errors = follower(cascade, jerk_max_m_s3), []
    for model, deviation in starts(12):
        true = flown(model, deviation, response_to(cascade), limits)
        told = rolled_out(model, deviation, drone)
        at = np.rint(DT_S * np.arange(len(told)) / PERIOD_S).astype(int)
        same = at < len(true)
        errors.append(told[same] - true[at[same]])
    place_m, rate_m_s = np.sqrt(np.mean(np.concatenate(errors) ** 2, axis=0))
    assert place_m < 0.05  # of 0.14 m that they move by, root mean square
    assert rate_m_s < 0.1  # what a report's velocity errs by (`response.VELOCITY_STD_M_S`)


@pytest.mark.parametrize("attitude_lag_s", [0.2, 0.45, 0.6])
def test_a_drone_that_leans_late_does_not_swing_ever_wider(attitude_lag_s: float) -> None:
    drone = follower(replace(ARDUPILOT, attitude_lag_s=attitude_lag_s), 8.0)
    for model, deviation in starts(12):
        rates_m_s = np.abs(rolled_out(model, deviation, drone, lasts_s=9.0)[:, 1])
        third = len(rates_m_s) // 3
        assert rates_m_s[-third:].max() < rates_m_s[:third].max()


@pytest.mark.parametrize(("cascade", "jerk_max_m_s3"), [(ARDUPILOT, 8.0), (PX4, 20.0)], ids=["ardupilot", "px4"])
def test_a_drone_beside_the_pad_comes_over_it_without_swinging_past_it(cascade: Cascade, jerk_max_m_s3: float) -> None:
    beside = np.array([0.3, 0.0, 0.0])
    places_m = rolled_out(beside, np.zeros(STATES), follower(cascade, jerk_max_m_s3), lasts_s=3.0)[:, 0]
    assert places_m.min() > -0.1 * beside[0]  # the planner's own overshoot of a small step (planning/test_mpc.py)
    assert abs(places_m[-1]) < 0.03
