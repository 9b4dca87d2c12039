"""The compiled calls of a plan: their Python, what they are given, and what is not a plan."""

from typing import Any

import numpy as np
import pytest

from companion.config.planning import MpcConfig
from companion.core.data import Array, FlightLimits
from companion.planning import horizon, qp, resample
from companion.planning.guidance import PlanRequest, PlanResult, PlanStatus, Target
from companion.planning.mpc import Mpc
from companion.planning.programmes import plan_of, pose, total_of
from companion.planning.resample import make_resampler
from link.records import replace
from tests.companion.planning.cases import LIMITS, circle, request_of, state_at, target_of

MPC = Mpc(MpcConfig())
START = state_at((3.0, -8.0, 5.0), (1.0, 2.0, -0.5), (0.3, -0.2, 0.1))
REQUEST = request_of(START, target_of(circle(16.5, 7.0)))
TOUCHED_ENU_M = np.linspace(1.0, 2.0, len(REQUEST.floor_enu_m))


def planned(request: PlanRequest) -> PlanResult:
    return MPC.plan(None, request)[1]


def flat(value: Any) -> Array:
    """All numbers of nested tuples and arrays, one after the other."""
    if isinstance(value, tuple):
        return np.concatenate([flat(one) for one in value])
    return np.ravel(np.asarray(value, dtype=np.float64))


def blank_like(posed: Any) -> Any:
    """Nested arrays of the same shapes, in which nothing has been written."""
    return tuple(blank_like(one) for one in posed) if isinstance(posed, tuple) else np.full_like(posed, np.nan)


def arguments_of_pose(request: PlanRequest, monkeypatch: pytest.MonkeyPatch) -> tuple[Any, ...]:
    """What a plan gives to `pose`."""
    seen: list[tuple[Any, ...]] = []

    def noted(*arguments: Any) -> Any:
        seen.append(arguments)
        return pose(*arguments)

    monkeypatch.setattr("companion.planning.mpc.pose", noted)
    planned(request)
    return seen[0]


@pytest.mark.parametrize("wanted", [REQUEST, replace(REQUEST, touched_enu_m=TOUCHED_ENU_M)], ids=["above", "onto"])
def test_compiled_calls_of_a_plan_are_their_python(wanted: PlanRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    *given, statics, blank = arguments_of_pose(wanted, monkeypatch)
    posed, plain = blank_like(blank), blank_like(blank)
    for kernel, written in ((pose, posed), (pose.py_func, plain)):
        all_given = (*given, statics, written)
        assert kernel(*all_given)
    rng, moves = np.random.default_rng(3), len(statics[0][1])
    np.testing.assert_allclose(flat(posed), flat(plain), rtol=1e-9, atol=1e-9)
    maps, path, plain_path = rng.normal(size=(3 + moves, 15)), np.empty((3, 5, 3)), np.empty((3, 5, 3))
    plan = (posed[0], rng.normal(size=2 * moves + 2), rng.normal(size=moves + 3), maps)
    assert plan_of(*plan, path) == pytest.approx(plan_of.py_func(*plan, plain_path))
    np.testing.assert_allclose(path, plain_path, rtol=1e-9, atol=1e-9)


def test_kernels_within_are_their_python() -> None:
    rng = np.random.default_rng(4)
    sampler = make_resampler(np.linspace(0.0, 3.0, 9), np.linspace(0.0, 3.5, 14))
    rows = tuple(rng.normal(size=(9, 3)) for _ in range(3))
    line, x, path = rng.normal(size=9), rng.normal(size=(3, 3)), rng.normal(size=(3, 14, 3))
    term, bounds = rng.normal(size=4), (rng.normal(size=6) - 5.0, rng.normal(size=6) + 5.0)
    for kernel, arguments in (
        (resample.resampled_path, (rows, sampler.left, sampler.weights)),
        (resample.resampled_line, (line, sampler.left, sampler.weights)),
        (horizon.major_direction, (x, path[1, 0], 1.3)),
        (horizon.turned_horizon, (tuple(x), path, 1.0)),
        (total_of, (tuple(x), (*rows, line))),
        (qp.is_finite, (term,)),
        (qp.is_finite, (np.full(3, np.inf),)),
        (qp.fault_of, (term, *bounds)),
        (qp.fault_of, (term, bounds[1], bounds[0])),
        (qp.fault_of, (term, np.full(6, np.nan), bounds[1])),
    ):
        np.testing.assert_allclose(flat(kernel(*arguments)), flat(kernel.py_func(*arguments)), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("field", [*Target.__struct_fields__, "floor_enu_m"])
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


@pytest.mark.parametrize("field", Target.__struct_fields__[1:])
def test_rows_that_are_not_one_for_each_offset_are_refused(field: str) -> None:
    short = getattr(REQUEST.target, field)[:-1]
    with pytest.raises(ValueError, match="offsets has rows of shape"):
        planned(replace(REQUEST, target=replace(REQUEST.target, **{field: short})))


@pytest.mark.parametrize("rows", [5, 500])
def test_a_floor_that_is_not_one_for_each_offset_is_refused(rows: int) -> None:
    with pytest.raises(ValueError, match="offsets has samples of shape"):
        planned(replace(REQUEST, floor_enu_m=np.zeros(rows)))
    with pytest.raises(ValueError, match="offsets has samples of shape"):
        planned(replace(REQUEST, touched_enu_m=np.zeros(rows)))


@pytest.mark.parametrize("limit", sorted(set(FlightLimits.__struct_fields__) - {"tilt_acceleration_m_s2"}))
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_limits_that_are_no_positive_numbers_are_refused(limit: str, value: float) -> None:
    with pytest.raises(ValueError, match="limits must be positive"):
        planned(replace(REQUEST, limits=replace(LIMITS, **{limit: value})))


def test_limits_that_are_whole_numbers_compile_nothing() -> None:
    planned(REQUEST)
    known = len(pose.signatures), len(plan_of.signatures)
    planned(replace(REQUEST, limits=replace(LIMITS, speed_max_m_s=20, jerk_max_m_s3=20)))
    planned(replace(REQUEST, touched_enu_m=TOUCHED_ENU_M))
    assert (len(pose.signatures), len(plan_of.signatures)) == known


def test_arrays_laid_out_otherwise_give_the_same_plan_and_compile_nothing() -> None:
    first, known = planned(REQUEST), len(pose.signatures)
    strided = {name: np.asfortranarray(getattr(REQUEST.target, name)) for name in Target.__struct_fields__[1:]}
    floor = np.repeat(REQUEST.floor_enu_m, 2)[::2]
    second = planned(replace(REQUEST, target=replace(REQUEST.target, **strided), floor_enu_m=floor))
    np.testing.assert_array_equal(first.trajectory.position_enu_m, second.trajectory.position_enu_m)
    assert len(pose.signatures) == known
