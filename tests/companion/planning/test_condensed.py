import numpy as np
import pytest
from scipy.integrate import trapezoid

from companion.autopilots.ardupilot import ArduPilotDriver
from companion.config.planning import MpcConfig
from companion.core.data import Array
from companion.landing.steering.virtual_model import response_to
from companion.planning.axis_qp import AxisModel, make_axis_cost, make_axis_model, slopes_of, terminal_cost
from companion.planning.following import Following, deviations

LAGS = response_to(ArduPilotDriver().cascade({})).following
MOVES_S: Array = np.array([0.02, 0.05, 0.13, 0.37, 0.61])


def rolled_out(model: AxisModel, x: Array, u: Array) -> Array:
    """States (n, 3) at the nodes, stepped exactly through every node and block in turn."""
    states, t = [], 0.0
    for node in model.node_s:
        block = int(np.searchsorted(np.cumsum(model.move_s), t + 1e-9))
        h, t = node - t, node
        step = np.array([[1.0, h, h * h / 2.0], [0.0, 1.0, h], [0.0, 0.0, 1.0]])
        x = step @ x + u[block] * np.array([h**3 / 6.0, h**2 / 2.0, h])
        states.append(x)
    return np.array(states)


@pytest.mark.parametrize("spacing_s", [0.05, 0.16, 1.0])
def test_the_prediction_matrices_equal_a_step_by_step_rollout(spacing_s: float) -> None:
    model = make_axis_model(MOVES_S, spacing_s)
    rng = np.random.default_rng(4)
    x, u = rng.normal(size=3), 10.0 * rng.normal(size=5)
    stacked = [
        model.free_p @ x + model.forced_p @ u,
        model.free_v @ x + model.forced_v @ u,
        model.free_a @ x + model.forced_a @ u,
    ]
    np.testing.assert_allclose(np.array(stacked).T, rolled_out(model, x, u), atol=1e-12)


def test_the_nodes_hold_all_ends_of_blocks_and_no_wide_gap() -> None:
    model = make_axis_model(MOVES_S, 0.16)
    np.testing.assert_allclose(np.append(0.0, model.node_s)[model.end_node[1:]], np.cumsum(MOVES_S))
    assert np.diff(model.node_s, prepend=0.0).max() <= 0.16 + 1e-12


@pytest.mark.parametrize("following", [None, LAGS], ids=["follows at once", "lags"])
@pytest.mark.parametrize("axis", range(3))
def test_the_programme_costs_what_a_rollout_costs(axis: int, following: Following | None) -> None:
    config = MpcConfig()
    model = make_axis_model(np.array(config.moves_s), config.node_spacing_max_s)
    constant = make_axis_cost(model, config, following)
    rng = np.random.default_rng(5)
    u = 5.0 * rng.normal(size=len(config.moves_s))
    states, references, jerks = (rng.normal(size=(3, 3, *rest)) for rest in ((), (len(model.node_s),), (len(u),)))
    x, reference, jerk = states[:, axis], references[:, axis], jerks[0, axis]

    def cost(moves: Array) -> float:
        error = rolled_out(model, x, moves) - reference.T
        if following is not None:
            off, faster = deviations(following, model.node_s, model.move_s)
            error += np.stack((off @ moves, faster @ moves, np.zeros(len(error))), axis=1)
        weights = np.array([config.position_weight, config.velocity_weight, config.acceleration_weight])
        running = (error**2) @ weights
        integral = trapezoid(running, model.node_s) + running[0] * model.node_s[0] / 2.0  # the part from now is fixed
        effort = config.jerk_weight * ((moves - jerk) ** 2) @ model.move_s
        return float(0.5 * (integral + effort + error[-1] @ terminal_cost(config) @ error[-1]))

    slopes = slopes_of(constant.weights, constant.weights, states, references, jerks[0])[axis]
    quadratic = 0.5 * u @ constant.H @ u + slopes @ u
    assert quadratic == pytest.approx(cost(u) - cost(np.zeros_like(u)), rel=1e-9)


def test_the_terminal_cost_solves_the_riccati_equation() -> None:
    config = MpcConfig()
    P, A, B = terminal_cost(config), np.diag([1.0, 1.0], k=1), np.array([[0.0], [0.0], [1.0]])
    Q = np.diag([config.position_weight, config.velocity_weight, config.acceleration_weight])
    residual = A.T @ P + P @ A - P @ B @ B.T @ P / config.jerk_weight + Q
    np.testing.assert_allclose(residual, 0.0, atol=1e-9)
    assert np.linalg.eigvalsh(P).min() > 0.0
