import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from companion.config.planning import SolverKind
from companion.core.data import Array
from companion.planning.guidance import PlanStatus
from companion.planning.qp import DAQP_STATUS, DaqpSolver, OsqpSolver, Programme, QpSolution, QpSolver, make_solver

SOLVERS = [pytest.param(DaqpSolver(), id="daqp"), pytest.param(OsqpSolver(), id="osqp")]
Problem = tuple[Array, Array, Array, Array, Array]


def random_problem(seed: int, n: int = 8, m: int = 20) -> Problem:
    """A feasible problem: the bounds are laid around a random point."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(n, n))
    A = rng.normal(size=(m, n))
    middle = A @ rng.normal(size=n)
    lower, upper = middle - rng.uniform(0.05, 1.0, m), middle + rng.uniform(0.05, 1.0, m)
    lower[::5], upper[1::5] = -np.inf, np.inf
    return root @ root.T + np.eye(n), 4.0 * rng.normal(size=n), A, lower, upper


def solved(solver: QpSolver, *problem: Array) -> QpSolution:
    """The answer to one problem: H, f, A, lower, upper."""
    H, f, A, *bounds = problem
    lower, upper = bounds
    return Programme(solver, H, A).solve((f, lower, upper))


@settings(max_examples=40, deadline=None, derandomize=True)
@given(st.integers(0, 10**6))
def test_both_solvers_agree_on_random_problems(seed: int) -> None:
    problem = random_problem(seed)
    exact, split = (solved(make_solver(kind), *problem)[1] for kind in (SolverKind.DAQP, SolverKind.OSQP))
    assert exact is not None
    assert split is not None
    np.testing.assert_allclose(split, exact, atol=1e-5)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("seed", range(5))
def test_the_solution_satisfies_the_optimality_conditions(solver: QpSolver, seed: int) -> None:
    H, f, A, lower, upper = random_problem(seed)
    _, x, _ = solved(solver, H, f, A, lower, upper)
    assert x is not None
    rows = A @ x
    assert (rows > lower - 1e-6).all()
    assert (rows < upper + 1e-6).all()
    active = np.vstack((A[rows > upper - 1e-5], -A[rows < lower + 1e-5]))
    _, residual = nnls(active.T, -(H @ x + f))
    assert residual < 1e-5


@pytest.mark.parametrize("solver", SOLVERS)
def test_contradicting_rows_are_infeasible_and_give_no_x(solver: QpSolver) -> None:
    rows = np.array([[1.0], [1.0]])
    solution = solved(solver, np.eye(1), np.zeros(1), rows, np.array([0.0, 3.0]), np.array([1.0, 5.0]))
    assert solution[:2] == (PlanStatus.INFEASIBLE, None)


@pytest.mark.parametrize("solver", SOLVERS)
def test_crossed_bounds_are_infeasible_and_give_no_x(solver: QpSolver) -> None:
    solution = solved(solver, np.eye(1), np.zeros(1), np.eye(1), np.array([1.0]), np.array([-1.0]))
    assert solution[:2] == (PlanStatus.INFEASIBLE, None)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("broken", range(5))
def test_nan_anywhere_fails_and_gives_no_x(solver: QpSolver, broken: int) -> None:
    H, f, A, lower, upper = problem = random_problem(7)
    problem[broken].flat[3] = np.nan
    solution = solved(solver, H, f, A, lower, upper)
    assert solution[:2] == (PlanStatus.FAILED, None)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_hessian_that_is_not_convex_fails(solver: QpSolver) -> None:
    solution = solved(solver, -np.eye(1), np.zeros(1), np.eye(1), -np.ones(1), np.ones(1))
    assert solution[:2] == (PlanStatus.FAILED, None)


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_solve_does_not_depend_on_earlier_ones(solver: QpSolver) -> None:
    first = solved(solver, *random_problem(11))[1]
    solved(solver, *random_problem(12))
    again = solved(solver, *random_problem(11))[1]
    assert first is not None
    assert again is not None
    assert np.array_equal(first, again)


def test_only_the_optimal_exit_flag_of_daqp_is_solved() -> None:
    assert [flag for flag, status in DAQP_STATUS.items() if status is PlanStatus.SOLVED] == [1]
