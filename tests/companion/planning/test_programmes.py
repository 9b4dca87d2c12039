"""The compiled calls of a plan: their Python, what they are given, and what is not a plan."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from companion.data import Array, FlightLimits
from companion.planning import horizon, qp, resample
from companion.planning.config import MpcConfig
from companion.planning.guidance import PlanRequest, PlanResult, PlanStatus, Target
from companion.planning.mpc import Mpc
from companion.planning.programmes import bound_minor, path_of, pose, total_of
from companion.planning.requests import limits_of
from companion.planning.resample import make_resampler
from tests.companion.planning.cases import LIMITS, circle, request_of, state_at, target_of

MPC = Mpc(MpcConfig())
START = state_at((3.0, -8.0, 5.0), (1.0, 2.0, -0.5), (0.3, -0.2, 0.1))
REQUEST = request_of(START, target_of(circle(16.5, 7.0)))


def planned(request: PlanRequest) -> PlanResult:
    return MPC.plan(None, request)[1]


def flat(value: Any) -> Array:
    """All numbers of nested tuples and arrays, one after the other."""
    if isinstance(value, tuple):
        return np.concatenate([flat(one) for one in value])
    return np.ravel(np.asarray(value, dtype=np.float64))


def arguments_of_pose(monkeypatch: pytest.MonkeyPatch) -> tuple[Any, ...]:
    """What a plan gives to `pose`."""
    seen: list[tuple[Any, ...]] = []

    def noted(*arguments: Any) -> Any:
        seen.append(arguments)
        return pose(*arguments)

    monkeypatch.setattr("companion.planning.mpc.pose", noted)
    planned(REQUEST)
    return seen[0]


def test_compiled_calls_of_a_plan_are_their_python(monkeypatch: pytest.MonkeyPatch) -> None:
    arguments = arguments_of_pose(monkeypatch)
    posed, plain = pose(*arguments), pose.py_func(*arguments)
    np.testing.assert_allclose(flat(posed), flat(plain), rtol=1e-9, atol=1e-9)
    rng = np.random.default_rng(3)
    grid, limits = arguments[4][0], limits_of(LIMITS)
    move = rng.normal(size=len(grid[1]) + 2)
    bounds, plain_bounds = (one(posed.state, move, limits, grid) for one in (bound_minor, bound_minor.py_func))
    np.testing.assert_allclose(flat(bounds), flat(plain_bounds), rtol=1e-9, atol=1e-9)
    maps = (rng.normal(size=(3, 5, 3)), rng.normal(size=(3, 5, len(grid[1]))))
    path = (posed.origin_enu_m, posed.direction, posed.state, (move, 2.0 * move, -move), maps)
    np.testing.assert_allclose(flat(path_of(*path)), flat(path_of.py_func(*path)), rtol=1e-9, atol=1e-9)


def test_kernels_within_are_their_python() -> None:
    rng = np.random.default_rng(4)
    sampler = make_resampler(np.linspace(0.0, 3.0, 9), np.linspace(0.0, 3.5, 14))
    rows = tuple(rng.normal(size=(9, 3)) for _ in range(3))
    line, x, path = rng.normal(size=9), rng.normal(size=(3, 3)), rng.normal(size=(3, 14, 3))
    term, bounds = rng.normal(size=4), (rng.normal(size=6) - 5.0, rng.normal(size=6) + 5.0)
    for kernel, arguments in (
        (resample.resampled_path, (rows, sampler.left, sampler.weights)),
        (resample.resampled_line, (line, sampler.left, sampler.weights)),
        (horizon.needs, (x, path[1, 0], 4.0, 2.0, 1.0)),
        (horizon.major_direction, (rng.normal(size=(4, 2)),)),
        (horizon.turned_horizon, (tuple(x), path, 4.0, 2.0, 1.0)),
        (total_of, ((*rows, line),)),
        (qp.fault_of, (term, *bounds)),
        (qp.fault_of, (term, bounds[1], bounds[0])),
        (qp.fault_of, (term, np.full(6, np.nan), bounds[1])),
    ):
        np.testing.assert_allclose(flat(kernel(*arguments)), flat(kernel.py_func(*arguments)), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("field", [*Target.__slots__, "floor_enu_m"])
def test_what_is_not_finite_is_answered_by_braking(field: str, bad: float) -> None:
    broken = getattr(REQUEST if field == "floor_enu_m" else REQUEST.target, field).copy()
    broken.flat[-1] = bad
    if field == "floor_enu_m":
        request = replace(REQUEST, floor_enu_m=broken)
    else:
        request = replace(REQUEST, target=replace(REQUEST.target, **{field: broken}))
    result = planned(request)
    assert result.status is PlanStatus.FAILED
    assert np.isfinite(result.next_state.position_enu_m).all()


@pytest.mark.parametrize("field", Target.__slots__[1:])
def test_rows_that_are_not_one_for_each_offset_are_refused(field: str) -> None:
    short = getattr(REQUEST.target, field)[:-1]
    with pytest.raises(ValueError, match="offsets has rows of shape"):
        planned(replace(REQUEST, target=replace(REQUEST.target, **{field: short})))


@pytest.mark.parametrize("rows", [5, 500])
def test_a_floor_that_is_not_one_for_each_offset_is_refused(rows: int) -> None:
    with pytest.raises(ValueError, match="offsets has samples of shape"):
        planned(replace(REQUEST, floor_enu_m=np.zeros(rows)))


@pytest.mark.parametrize("limit", FlightLimits.__slots__)
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_limits_that_are_no_positive_numbers_are_refused(limit: str, value: float) -> None:
    with pytest.raises(ValueError, match="limits must be positive"):
        planned(replace(REQUEST, limits=replace(LIMITS, **{limit: value})))


def test_limits_that_are_whole_numbers_compile_nothing() -> None:
    planned(REQUEST)
    known = len(pose.signatures), len(bound_minor.signatures)
    planned(replace(REQUEST, limits=replace(LIMITS, speed_max_m_s=20, jerk_max_m_s3=20)))
    assert (len(pose.signatures), len(bound_minor.signatures)) == known


def test_arrays_laid_out_otherwise_give_the_same_plan_and_compile_nothing() -> None:
    first, known = planned(REQUEST), len(pose.signatures)
    strided = {name: np.asfortranarray(getattr(REQUEST.target, name)) for name in Target.__slots__[1:]}
    floor = np.repeat(REQUEST.floor_enu_m, 2)[::2]
    second = planned(replace(REQUEST, target=replace(REQUEST.target, **strided), floor_enu_m=floor))
    np.testing.assert_array_equal(first.trajectory.position_enu_m, second.trajectory.position_enu_m)
    assert len(pose.signatures) == known
