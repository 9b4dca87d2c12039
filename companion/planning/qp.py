"""The one interface to quadratic programmes, and its two solvers: OSQP and DAQP.

Minimise `x'Hx/2 + f'x` subject to `lower <= Ax <= upper`. Solving is a pure function of its arguments: no
solver state survives a call, so the same problem gives the same bits in any order.
"""

import importlib
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from companion.data import Array
from companion.planning.config import SolverKind
from companion.planning.guidance import PlanStatus
from companion.planning.requests import are_finite


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class QpSolution:
    """A solver's answer; `x` (n,) is None unless the status is SOLVED."""

    status: PlanStatus
    x: Array | None
    iterations: int


class QpSolver(Protocol):
    """What the planners ask of a solver."""

    def solve(self, H: Array, f: Array, A: Array, lower: Array, upper: Array, warm_start: Array | None) -> QpSolution:
        """Return the minimiser of one problem.

        Args:
            H: (n, n) symmetric positive definite.
            f: (n,).
            A: (m, n).
            lower: (m,), -inf where there is no bound.
            upper: (m,), +inf where there is no bound.
            warm_start: (n,) guess of the minimiser, or None.
        """


DAQP_STATUS = {
    2: PlanStatus.SOLVED_INACCURATE,  # soft optimal: a constraint was relaxed
    1: PlanStatus.SOLVED,
    -1: PlanStatus.INFEASIBLE,
    -2: PlanStatus.FAILED,  # cycling
    -3: PlanStatus.FAILED,  # unbounded
    -4: PlanStatus.FAILED,  # iteration limit
    -5: PlanStatus.FAILED,  # not convex
    -6: PlanStatus.FAILED,  # overdetermined initial working set
    -7: PlanStatus.FAILED,  # time limit
}
"""DAQP's exit flags, see its documentation's page "parameters"; unknown ones count as FAILED."""

OSQP_STATUS = {
    "OSQP_SOLVED": PlanStatus.SOLVED,
    "OSQP_SOLVED_INACCURATE": PlanStatus.SOLVED_INACCURATE,
    "OSQP_PRIMAL_INFEASIBLE": PlanStatus.INFEASIBLE,
    "OSQP_PRIMAL_INFEASIBLE_INACCURATE": PlanStatus.INFEASIBLE,
    "OSQP_DUAL_INFEASIBLE": PlanStatus.FAILED,
    "OSQP_DUAL_INFEASIBLE_INACCURATE": PlanStatus.FAILED,
    "OSQP_MAX_ITER_REACHED": PlanStatus.FAILED,
    "OSQP_TIME_LIMIT_REACHED": PlanStatus.FAILED,
    "OSQP_NON_CVX": PlanStatus.FAILED,
    "OSQP_SIGINT": PlanStatus.FAILED,
    "OSQP_UNSOLVED": PlanStatus.FAILED,
}
"""All of OSQP's statuses; unknown ones count as FAILED."""


def refusal(H: Array, f: Array, A: Array, lower: Array, upper: Array) -> QpSolution | None:
    """Return the answer to a problem that no solver may see, or None.

    DAQP calls problems with NaN or with crossed bounds solved.
    """
    if not are_finite(f, H, A):
        return QpSolution(status=PlanStatus.FAILED, x=None, iterations=0)
    if np.count_nonzero(lower <= upper) == len(lower):
        return None
    has_nan = bool(np.isnan(lower).any() or np.isnan(upper).any())
    return QpSolution(status=PlanStatus.FAILED if has_nan else PlanStatus.INFEASIBLE, x=None, iterations=0)


class DaqpSolver:
    """DAQP, a dual active-set method (Arnstrom, Bemporad, Axehill 2022)."""

    def __init__(self) -> None:
        self._daqp: Any = importlib.import_module("daqp")

    def solve(self, H: Array, f: Array, A: Array, lower: Array, upper: Array, warm_start: Array | None) -> QpSolution:
        """Return the minimiser; the meaning of the arguments is the interface's."""
        refused = refusal(H, f, A, lower, upper)
        if refused is not None:
            return refused
        x, flag, iterations = self.call(H, f, A, lower, upper, warm_start)
        return _solution(DAQP_STATUS.get(flag, PlanStatus.FAILED), x, iterations)

    def call(
        self, H: Array, f: Array, A: Array, lower: Array, upper: Array, warm_start: Array | None
    ) -> tuple[Array, int, int]:
        """Return what the library makes of a problem, and nothing else: `x`, its exit flag, its iterations."""
        sense = np.zeros(len(lower), dtype=np.int32)
        x, _, flag, info = self._daqp.solve(H, f, A, upper, lower, sense, primal_start=warm_start)
        return x, flag, int(info["iterations"])


class OsqpSolver:
    """OSQP, an operator-splitting method (Stellato et al. 2020), with its polishing step.

    It is given the problem in `y = L'x`, `H = LL'`, with rows of length 1: there its convergence does not suffer from
    the conditioning of H.
    """

    TOLERANCE = 1e-6
    ITERATIONS_MAX = 20000

    def __init__(self) -> None:
        self._osqp: Any = importlib.import_module("osqp")
        self._sparse: Any = importlib.import_module("scipy.sparse")

    def solve(self, H: Array, f: Array, A: Array, lower: Array, upper: Array, warm_start: Array | None) -> QpSolution:
        """Return the minimiser; the meaning of the arguments is the interface's."""
        refused = refusal(H, f, A, lower, upper)
        if refused is not None:
            return refused
        try:
            L = np.linalg.cholesky(H)
        except np.linalg.LinAlgError:
            return QpSolution(status=PlanStatus.FAILED, x=None, iterations=0)
        rows = np.linalg.solve(L, A.T).T
        length = np.maximum(np.linalg.norm(rows, axis=1), 1e-12)
        problem = self._osqp.OSQP()
        problem.setup(
            self._sparse.eye(len(f), format="csc"),
            np.linalg.solve(L, f),
            self._sparse.csc_matrix(rows / length[:, None]),
            lower / length,
            upper / length,
            verbose=False,
            eps_abs=self.TOLERANCE,
            eps_rel=self.TOLERANCE,
            max_iter=self.ITERATIONS_MAX,
            polishing=True,
            scaling=0,
        )
        if warm_start is not None:
            problem.warm_start(x=L.T @ warm_start)
        result = problem.solve(raise_error=False)
        status = OSQP_STATUS.get(self._osqp.SolverStatus(result.info.status_val).name, PlanStatus.FAILED)
        x = np.linalg.solve(L.T, result.x) if status is PlanStatus.SOLVED else None
        return _solution(status, x, int(result.info.iter))


def _solution(status: PlanStatus, x: Array | None, iterations: int) -> QpSolution:
    """Return a solution whose `x` is there only if it may be used."""
    if status is not PlanStatus.SOLVED or x is None:
        return QpSolution(status=status, x=None, iterations=iterations)
    if not are_finite(x):
        return QpSolution(status=PlanStatus.FAILED, x=None, iterations=iterations)
    return QpSolution(status=status, x=np.asarray(x, dtype=np.float64), iterations=iterations)


def make_solver(kind: SolverKind) -> QpSolver:
    """Return a solver; its library is imported only now."""
    match kind:
        case SolverKind.DAQP:
            return DaqpSolver()
        case SolverKind.OSQP:
            return OsqpSolver()
