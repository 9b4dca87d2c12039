"""A plan for a drone that leans late: its moves are those that bring the drone itself over the target."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.autopilots.px4 import Px4Driver
from companion.autopilots.response import STATES, Cascade, ResponseModel
from companion.config.planning import MpcConfig
from companion.core.data import Array
from companion.landing.steering.ahead import make_up
from companion.landing.steering.targets import HORIZON_OFFSETS_S
from companion.landing.steering.virtual_model import Tracking, response_to
from companion.planning.following import deviations
from companion.planning.guidance import PlanRequest, ReferenceState, Target
from companion.planning.mpc import Mpc
from link.records import replace
from tests.companion.planning.cases import LIMITS

MPC = Mpc(MpcConfig())
PERIOD_S = 0.02
ARDUPILOT = ArduPilotDriver().cascade({})
JERK_MAX_M_S3 = 10.0  # PSC_JERK_XY as advised
BRAKE_M_S2, BRAKES_S, KNOWN_LATE_S = -2.0, (1.0, 3.0), 0.2


@pytest.mark.parametrize("cascade", [ARDUPILOT, Px4Driver().cascade({})], ids=["ardupilot", "px4"])
def test_deviations_solve_the_differential_equation(cascade: Cascade) -> None:
    following = response_to(cascade).following
    move_s, node_s = np.array([0.1, 0.24, 0.4]), np.array([0.1, 0.22, 0.34, 0.54, 0.74])
    ends_s, moves = np.cumsum(move_s), np.array([3.0, -7.0, 2.0])

    def rate(t_s: float, x: Array) -> Array:
        jerk = moves[min(int(np.searchsorted(ends_s, t_s, side="right")), 2)]
        return np.append(following.motion @ x[:-1] + following.asked * x[-1], jerk)

    start = np.zeros(STATES + 1)
    solved = solve_ivp(rate, (0.0, 0.75), start, t_eval=node_s, rtol=1e-9, atol=1e-11, max_step=0.005).y
    off, faster = deviations(following, node_s, move_s)
    np.testing.assert_allclose(off @ moves, solved[0], atol=1e-4)
    np.testing.assert_allclose(faster @ moves, solved[1], atol=1e-3)


def acceleration_m_s2(t_s: float) -> float:
    return BRAKE_M_S2 if BRAKES_S[0] <= t_s < BRAKES_S[1] else 0.0


def forecast(place_m: float, rate_m_s: float, accelerates_m_s2: float) -> Target:
    """A car that goes on as it moves."""
    position, velocity, acceleration = (np.zeros((len(HORIZON_OFFSETS_S), 3)) for _ in range(3))
    position[:, 0] = place_m + rate_m_s * HORIZON_OFFSETS_S + 0.5 * accelerates_m_s2 * HORIZON_OFFSETS_S**2
    velocity[:, 0], acceleration[:, 0] = rate_m_s + accelerates_m_s2 * HORIZON_OFFSETS_S, accelerates_m_s2
    moves = {"velocity_enu_m_s": velocity, "acceleration_enu_m_s2": acceleration}
    return Target(offset_s=HORIZON_OFFSETS_S, position_enu_m=position, **moves)


def flown(response: ResponseModel | None, duration_s: float = 8.0) -> Array:
    """Times, places and rates (n, 3) against a car that brakes for 2 s, which is known late, of a drone over it."""
    moves = None if response is None else ResponseModel(response.cascade, np.array([0.0, PERIOD_S]))
    state = ReferenceState(
        position_enu_m=np.zeros(3), velocity_enu_m_s=np.array([8.0, 0.0, 0.0]), acceleration_enu_m_s2=np.zeros(3)
    )
    off, place_m, rate_m_s, found = np.zeros((STATES, 2)), 0.0, 8.0, []
    for step in range(round(duration_s / PERIOD_S)):
        t_s = step * PERIOD_S
        drone = state.position_enu_m[0] + off[0, 0], state.velocity_enu_m_s[0] + off[1, 0]
        found.append((t_s, drone[0] - place_m, drone[1] - rate_m_s))
        request = PlanRequest(
            state=state,
            target=forecast(place_m, rate_m_s, acceleration_m_s2(t_s - KNOWN_LATE_S)),
            limits=replace(LIMITS, jerk_max_m_s3=JERK_MAX_M_S3),
            floor_enu_m=np.full(len(HORIZON_OFFSETS_S), -1e3),
            dt_s=PERIOD_S,
        )
        if response is not None:
            tracking = Tracking(deviation=off, compared_ns=0)
            led = make_up(request.target, state, tracking, response, late_s=0.0, ahead_s=0.0)
            request = replace(request, target=led, following=response.following)
        _, plan = MPC.plan(None, request)
        mean = 0.5 * (state.acceleration_enu_m_s2 + plan.next_state.acceleration_enu_m_s2)[:2]
        if moves is not None:
            off = moves.predict(off, np.tile(mean, (2, 1)))[1]
        state, now_m_s2 = plan.next_state, acceleration_m_s2(t_s)
        place_m += (rate_m_s + 0.5 * now_m_s2 * PERIOD_S) * PERIOD_S
        rate_m_s += now_m_s2 * PERIOD_S
    return np.array(found)


def test_drone_that_leans_late_is_hardly_farther_off_than_one_that_follows_at_once() -> None:
    """It swung twice as far over the car before its lag on the plan's own moves was in the programme."""
    late, at_once = (np.abs(flown(response)[:, 1:]) for response in (response_to(ARDUPILOT), None))
    assert (late.max(axis=0) < 1.5 * at_once.max(axis=0)).all()
    assert (np.sqrt(np.mean(late**2, axis=0)) < 1.5 * np.sqrt(np.mean(at_once**2, axis=0))).all()
