"""The one interface to quadratic programmes, and its two solvers: OSQP and DAQP.

Minimise `x'Hx/2 + f'x` subject to `lower <= Ax <= upper`. A solver is given it in `y = L'x`, `H = LL'`: DAQP then
transforms nothing at each call, and the convergence of OSQP does not suffer from the conditioning of H. Solving is a
pure function of its arguments: no solver state survives a call, so the same problem gives the same bits in any order.
"""

import importlib
import math
from collections.abc import Mapping
from types import ModuleType
from typing import Protocol, cast

import numpy as np
from numpy.typing import NDArray

from companion.config.planning import SolverKind
from companion.core.data import Array
from companion.planning.compiled import compiled_kernel
from companion.planning.guidance import PlanStatus, are_finite

QpSolution = tuple[PlanStatus, Array | None, int]
"""A solver's answer: the status, the minimiser (n,), None unless the status is SOLVED, and the iterations."""


class QpSolver(Protocol):
    """What a programme asks of a solver."""

    def call(self, f: Array, A: Array, lower: Array, upper: Array) -> QpSolution:
        """Return the answer to one problem: minimise `y'y / 2 + f'y`.

        Args:
            f: (n,).
            A: (m, n).
            lower: (m,), -inf where there is no bound.
            upper: (m,), +inf where there is no bound.
        """


Problem = tuple[Array, Array, Array]
"""What varies of a problem: its linear term (n,), lower and upper bounds (m,), where -inf and +inf mean none."""


class Programme:
    """Minimise `x'Hx / 2 + f'x` with `lower <= Ax <= upper`, for one (n, n) H and one (m, n) A.

    It shows no solver what none may see: DAQP calls problems with NaN or with crossed bounds solved.
    """

    def __init__(self, solver: QpSolver, H: Array, A: Array) -> None:
        self._solver, self._back = solver, _inverse_root(H) if are_finite(H, A) else None
        self._A = A if self._back is None else np.ascontiguousarray(A @ self._back)

    def blank(self) -> Problem:
        """Return new arrays to write a problem into."""
        rows, unknowns = self._A.shape
        return np.empty(unknowns), np.empty(rows), np.empty(rows)

    def solve(self, problem: Problem) -> QpSolution:
        """Return the answer to one problem."""
        f, lower, upper = problem
        if self._back is None:
            return PlanStatus.FAILED, None, 0
        fault = fault_of(f, lower, upper)
        if fault != _NO_FAULT:
            status = PlanStatus.INFEASIBLE if fault == _CROSSED else PlanStatus.FAILED
            return status, None, 0
        status, y, iterations = self._solver.call(f @ self._back, self._A, lower, upper)
        if status is not PlanStatus.SOLVED or y is None:
            return status, None, iterations
        if not is_finite(y):
            return PlanStatus.FAILED, None, iterations
        return status, self._back @ y, iterations


def _inverse_root(H: Array) -> Array | None:
    """Return the inverse of L' (n, n), `H = LL'`; None for an H that is not positive definite."""
    try:
        return np.linalg.inv(np.linalg.cholesky(H).T)
    except np.linalg.LinAlgError:
        return None


_NO_FAULT, _NOT_FINITE, _CROSSED = range(3)


@compiled_kernel
def is_finite(x: Array) -> bool:
    """Return whether all numbers of `x` (n,) are finite, none so large that the sum of their squares is not."""
    total = 0.0
    for i in range(len(x)):
        total += x[i] * x[i]
    return math.isfinite(total)


@compiled_kernel
def fault_of(f: Array, lower: Array, upper: Array) -> int:
    """Return what is wrong with a linear term and bounds: nothing, a number that is not finite, or crossed bounds."""
    crossed = False
    for i in range(len(lower)):
        if math.isnan(lower[i]) or math.isnan(upper[i]):
            return _NOT_FINITE
        crossed = crossed or lower[i] > upper[i]
    if not is_finite(f):
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


class _Daqp(Protocol):
    """What is used of the library."""

    def solve(
        self, H: Array, f: Array, A: Array, upper: Array, lower: Array, sense: NDArray[np.int32], /
    ) -> tuple[Array, float, int, Mapping[str, float]]:
        """Return the minimiser, its cost, the exit flag and figures of the way there."""


class DaqpSolver:
    """DAQP, a dual active-set method (Arnstrom, Bemporad, Axehill 2022)."""

    def __init__(self) -> None:
        self._daqp = cast("_Daqp", importlib.import_module("daqp"))

    def call(self, f: Array, A: Array, lower: Array, upper: Array) -> QpSolution:
        """Return the answer; the meaning of the arguments is the interface's."""
        sense = np.zeros(len(lower), dtype=np.int32)
        x, _, flag, info = self._daqp.solve(np.eye(len(f)), f, A, upper, lower, sense)
        return DAQP_STATUS.get(flag, PlanStatus.FAILED), x, int(info["iterations"])


class OsqpSolver:
    """OSQP, an operator-splitting method (Stellato et al. 2020), with its polishing step and rows of length 1."""

    TOLERANCE = 1e-6
    ITERATIONS_MAX = 20000

    def __init__(self) -> None:
        self._osqp: ModuleType = importlib.import_module("osqp")
        self._sparse: ModuleType = importlib.import_module("scipy.sparse")

    def call(self, f: Array, A: Array, lower: Array, upper: Array) -> QpSolution:
        """Return the answer; the meaning of the arguments is the interface's."""
        length = np.maximum(np.linalg.norm(A, axis=1), 1e-12)
        problem = self._osqp.OSQP()
        problem.setup(
            self._sparse.eye(len(f), format="csc"),
            f,
            self._sparse.csc_matrix(A / length[:, None]),
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
        return status, result.x if status is PlanStatus.SOLVED else None, int(result.info.iter)


def make_solver(kind: SolverKind) -> QpSolver:
    """Return a solver; its library is imported only now."""
    match kind:
        case SolverKind.DAQP:
            return DaqpSolver()
        case SolverKind.OSQP:
            return OsqpSolver()
