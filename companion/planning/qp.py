"""The one interface to quadratic programmes, and its two solvers: OSQP and DAQP.

Minimise `x'Hx/2 + f'x` subject to `lower <= Ax <= upper`. Solving is a pure function of its arguments: no
solver state survives a call, so the same problem gives the same bits in any order.
"""

import importlib
import math
from typing import Any, NamedTuple, Protocol

import numpy as np

from companion.data import Array
from companion.planning.config import SolverKind
from companion.planning.guidance import PlanStatus
from companion.planning.kept import kept
from companion.planning.requests import are_finite


class QpSolution(NamedTuple):
    """A solver's answer; `x` (n,) is None unless the status is SOLVED."""

    status: PlanStatus
    x: Array | None
    iterations: int


class QpSolver(Protocol):
    """What a programme asks of a solver."""

    def call(self, H: Array, f: Array, A: Array, lower: Array, upper: Array) -> tuple[PlanStatus, Array | None, int]:
        """Return the status, the minimiser of one problem if there is one, and the iterations.

        Args:
            H: (n, n) symmetric positive definite.
            f: (n,).
            A: (m, n).
            lower: (m,), -inf where there is no bound.
            upper: (m,), +inf where there is no bound.
        """


class Programme:
    """Minimise `x'Hx / 2 + f'x` with `lower <= Ax <= upper`, for one (n, n) H and one (m, n) A.

    It shows no solver what none may see: DAQP calls problems with NaN or with crossed bounds solved.
    """

    def __init__(self, solver: QpSolver, H: Array, A: Array) -> None:
        self._solver, self._H, self._A = solver, H, A
        self._is_sound = are_finite(H, A)

    def solve(self, f: Array, lower: Array, upper: Array) -> QpSolution:
        """Return the minimiser for `f` (n,) and bounds (m,), where -inf and +inf mean none."""
        fault = fault_of(f, lower, upper) if self._is_sound else _NOT_FINITE
        if fault != _NO_FAULT:
            status = PlanStatus.INFEASIBLE if fault == _CROSSED else PlanStatus.FAILED
            return QpSolution(status, None, 0)
        status, x, iterations = self._solver.call(self._H, f, self._A, lower, upper)
        if status is not PlanStatus.SOLVED or x is None:
            return QpSolution(status, None, iterations)
        if not are_finite(x):
            return QpSolution(PlanStatus.FAILED, None, iterations)
        return QpSolution(status, x, iterations)


_NO_FAULT, _NOT_FINITE, _CROSSED = range(3)


@kept
def fault_of(f: Array, lower: Array, upper: Array) -> int:
    """Return what is wrong with a linear term and bounds: nothing, a number that is not finite, or crossed bounds."""
    total, crossed = 0.0, False
    for i in range(len(f)):
        total += f[i] * f[i]
    for i in range(len(lower)):
        if math.isnan(lower[i]) or math.isnan(upper[i]):
            return _NOT_FINITE
        crossed = crossed or lower[i] > upper[i]
    if not math.isfinite(total):
        return _NOT_FINITE
    return _CROSSED if crossed else _NO_FAULT


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


class DaqpSolver:
    """DAQP, a dual active-set method (Arnstrom, Bemporad, Axehill 2022)."""

    def __init__(self) -> None:
        self._daqp: Any = importlib.import_module("daqp")

    def call(self, H: Array, f: Array, A: Array, lower: Array, upper: Array) -> tuple[PlanStatus, Array | None, int]:
        """Return the status, the minimiser and the iterations; the meaning of the arguments is the interface's."""
        sense = np.zeros(len(lower), dtype=np.int32)
        x, _, flag, info = self._daqp.solve(H, f, A, upper, lower, sense)
        return DAQP_STATUS.get(flag, PlanStatus.FAILED), x, int(info["iterations"])


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

    def call(self, H: Array, f: Array, A: Array, lower: Array, upper: Array) -> tuple[PlanStatus, Array | None, int]:
        """Return the status, the minimiser and the iterations; the meaning of the arguments is the interface's."""
        try:
            L = np.linalg.cholesky(H)
        except np.linalg.LinAlgError:
            return PlanStatus.FAILED, None, 0
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
        result = problem.solve(raise_error=False)
        status = OSQP_STATUS.get(self._osqp.SolverStatus(result.info.status_val).name, PlanStatus.FAILED)
        x = np.linalg.solve(L.T, result.x) if status is PlanStatus.SOLVED else None
        return status, x, int(result.info.iter)


def make_solver(kind: SolverKind) -> QpSolver:
    """Return a solver; its library is imported only now."""
    match kind:
        case SolverKind.DAQP:
            return DaqpSolver()
        case SolverKind.OSQP:
            return OsqpSolver()
