"""The compiled bounds of the axes' programmes, against the predictions that they bound and against their Python."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from companion.config.planning import MpcConfig
from companion.core.data import Array
from companion.planning.axis_qp import make_axis_model, make_axis_problem, slopes_of
from companion.planning.envelope import (
    MINOR_SHARE_MIN,
    bound_rows,
    major_bounds,
    major_share,
    minor_bounds,
    minor_share,
    reachable_floor,
    vertical_bounds,
)

CONFIG = MpcConfig()
MODEL = make_axis_model(np.array(CONFIG.moves_s), CONFIG.node_spacing_max_s)
NODES, MOVES = len(MODEL.node_s), len(MODEL.move_s)
NORMS = (20.0, 5.0, 12.0)
NO_FLOOR = np.empty(0)
LEAD_S = 0.8


def written(kernel: Callable[..., None], *arguments: Any, floor_lead_s: float | None = None) -> tuple[Array, Array]:
    """The bounds that a kernel writes for these arguments."""
    count = len(make_axis_problem(MODEL, CONFIG, floor_lead_s=floor_lead_s).A)
    rows = np.full(count, np.nan), np.full(count, np.nan)
    kernel(*arguments, rows)
    return rows


def kept(x: Array, jerk: Array, limits: tuple[Array, ...], floor: Array, lead_s: float) -> bool:
    """Whether a plan keeps to its limits by the predictions themselves, without any slack."""
    down, up, push, jerk_max = limits
    velocity = MODEL.free_v @ x + MODEL.forced_v @ jerk
    ends = (MODEL.free_a @ x + MODEL.forced_a @ jerk)[MODEL.end_node[1:] - 1]
    inside = [velocity >= -down, velocity <= up, np.abs(ends) <= push, np.abs(jerk) <= jerk_max]
    if len(floor):
        inside.append(MODEL.free_p @ x + MODEL.forced_p @ jerk + lead_s * velocity >= floor)
    return all(bool(rows.all()) for rows in inside)


@pytest.mark.slow
@pytest.mark.parametrize("floor_lead_s", [None, 0.0, LEAD_S])
def test_rows_hold_exactly_where_the_plan_keeps_to_its_limits(floor_lead_s: float | None) -> None:
    rng = np.random.default_rng(5)
    problem = make_axis_problem(MODEL, CONFIG, floor_lead_s=floor_lead_s)
    verdicts = []
    for _ in range(100):
        x = np.array([rng.uniform(1.0, 2.0), *rng.uniform(-0.4, 0.4, 2)])  # keeps all limits by itself
        down, up, push, most = (rng.uniform(0.9, 3.0, n) for n in (NODES, NODES, MOVES, MOVES))
        floor, lead_s = NO_FLOOR if floor_lead_s is None else rng.uniform(-4.0, -3.0, NODES), floor_lead_s or 0.0
        jerk = rng.uniform(-0.8, 0.8, MOVES)
        limits = (down, up, push, most)
        lower, upper = written(
            bound_rows, x, *limits, floor, lead_s, MODEL.node_s, MODEL.end_s, floor_lead_s=floor_lead_s
        )
        rows = problem.A @ np.append(jerk, np.zeros(len(problem.H) - MOVES))
        verdicts.append(kept(x, jerk, limits, floor, lead_s))
        assert bool(((rows >= lower) & (rows <= upper)).all()) == verdicts[-1]
    assert {True, False} == set(verdicts)


@pytest.mark.slow
def test_major_axis_gets_the_whole_norm_where_the_minor_one_needs_nothing() -> None:
    none, way = np.zeros(3), (0.0, 0.0, 0.0)
    speed, push, jerk = major_share(
        none, np.zeros(NODES + 1), np.zeros(MOVES + 1), way, NORMS, MODEL.node_s, MODEL.end_s
    )
    assert (speed.min(), push.min(), jerk.min()) == pytest.approx(NORMS)


@pytest.mark.slow
def test_both_axes_together_keep_the_norms() -> None:
    rng = np.random.default_rng(8)
    x, plan = np.array([3.0, 9.0, -1.5]), rng.uniform(-2.0, 2.0, MOVES)
    speed, push, jerk = minor_share(x, plan, MODEL.forced_v, NORMS, MODEL.node_s, MODEL.move_s)
    velocity = MODEL.free_v @ x + MODEL.forced_v @ plan
    ends = (MODEL.free_a @ x + MODEL.forced_a @ plan)[MODEL.end_node[1:] - 1]
    for norm, own, rest in zip(NORMS, (velocity, ends, plan), (speed, push, jerk), strict=True):
        assert np.hypot(own, rest) == pytest.approx(norm)


def test_minor_axis_keeps_a_share_of_a_norm_that_is_used_up() -> None:
    x = np.array([0.0, 25.0, 0.0])
    speed, _, _ = minor_share(x, np.zeros(MOVES), MODEL.forced_v, NORMS, MODEL.node_s, MODEL.move_s)
    assert speed == pytest.approx(MINOR_SHARE_MIN * NORMS[0])


def test_kernels_are_their_python() -> None:
    rng = np.random.default_rng(11)
    x, plan = rng.standard_normal(3), rng.standard_normal(MOVES)
    target_v, target_a, way = rng.standard_normal(NODES + 1), rng.standard_normal(MOVES + 1), (0.3, 1.1, 0.7)
    major = (x, target_v, target_a, way, NORMS, MODEL.node_s, MODEL.end_s)
    minor = (x, plan, MODEL.forced_v, NORMS, MODEL.node_s, MODEL.move_s)
    share = major_share(*major)
    rows = (x, share[0], share[0], *share[1:], NO_FLOOR, 0.0, MODEL.node_s, MODEL.end_s)
    weights = make_axis_problem(MODEL, CONFIG, floor_lead_s=None).weights
    term = (weights, *(rng.standard_normal((3, *rest)) for rest in ((3,), (3, NODES), (MOVES,))))
    for kernel, arguments in ((major_share, major), (minor_share, minor), (slopes_of, term)):
        compiled, plain = np.hstack([*kernel(*arguments)]), np.hstack([*kernel.py_func(*arguments)])
        np.testing.assert_allclose(compiled, plain, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(written(bound_rows, *rows), written(bound_rows.py_func, *rows), rtol=1e-12, atol=1e-12)


@pytest.mark.slow
def test_bounds_in_one_call_are_those_of_their_parts() -> None:
    rng = np.random.default_rng(13)
    state, plan, floor = rng.standard_normal((3, 3)), rng.standard_normal(MOVES), rng.uniform(-4.0, -3.0, NODES)
    target_v, target_a, way = rng.standard_normal(NODES + 1), rng.standard_normal(MOVES + 1), (0.3, 1.1, 0.7)
    major, minor, up = (np.ascontiguousarray(state[:, axis]) for axis in range(3))
    times = (MODEL.node_s, MODEL.end_s)
    speed, push, jerk = major_share(minor, target_v, target_a, way, NORMS, *times)
    expected = written(bound_rows, major, speed, speed, push, jerk, NO_FLOOR, 0.0, *times)
    np.testing.assert_array_equal(written(major_bounds, state, target_v, target_a, way, NORMS, *times), expected)
    speed, push, jerk = minor_share(major, plan, MODEL.forced_v, NORMS, MODEL.node_s, MODEL.move_s)
    expected = written(bound_rows, minor, speed, speed, push, jerk, NO_FLOOR, 0.0, *times)
    bounds = written(minor_bounds, state, plan, MODEL.forced_v, NORMS, MODEL.node_s, MODEL.move_s, MODEL.end_s)
    np.testing.assert_array_equal(bounds, expected)
    down, climb, pull, most = np.full(NODES, 1.5), np.full(NODES, 3.0), np.full(MOVES, 4.0), np.full(MOVES, 9.0)
    kept_floor = reachable_floor(floor, up, 4.0, 3.0, 9.0, LEAD_S, MODEL.node_s)
    expected = written(bound_rows, up, down, climb, pull, most, kept_floor, LEAD_S, *times, floor_lead_s=LEAD_S)
    bounds = written(vertical_bounds, state[:, 2], floor, LEAD_S, (1.5, 3.0, 4.0, 9.0), *times, floor_lead_s=LEAD_S)
    np.testing.assert_array_equal(bounds, expected)
