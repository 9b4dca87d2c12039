"""The rows and the bounds of the programmes, against the predictions that they bound and against their Python."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from companion.config.planning import MpcConfig
from companion.core.data import Array
from companion.planning.axis_qp import make_axis_cost, make_axis_model, slopes_of
from companion.planning.constraints import LEVEL_SLACKS, VERTICAL_SLACKS, level_rows, vertical_rows
from companion.planning.envelope import (
    DIRECTIONS,
    INSCRIBED,
    LEFT_MIN_SHARE,
    braked,
    level_bounds,
    push_along,
    pushes_left,
    vertical_bounds,
)

CONFIG = MpcConfig()
MODEL = make_axis_model(np.array(CONFIG.moves_s), CONFIG.node_spacing_max_s)
NODES, MOVES, ENDS = len(MODEL.node_s), len(MODEL.move_s), MODEL.end_node[1:] - 1
LEVEL, NORMS, ANY = level_rows(MODEL), (3.0, 2.0, 4.0), (np.inf, 0.0, 0.0)
LEAD_S = 0.8


def written(kernel: Callable[..., None], count: int, *arguments: Any) -> tuple[Array, Array]:
    """The bounds that a kernel writes for these arguments."""
    rows = np.full(count, np.nan), np.full(count, np.nan)
    kernel(*arguments, rows)
    return rows


def within(rows: Array, bounds: tuple[Array, Array]) -> bool:
    return bool(((rows >= bounds[0]) & (rows <= bounds[1])).all())


def norms_of(state: Array, jerk: Array) -> list[Array]:
    """Horizontal norms of speed and acceleration at the ends of the blocks, and of jerk, of a plan (2, m)."""
    speed = (MODEL.free_v @ state[:, :2] + MODEL.forced_v @ jerk.T)[ENDS]
    push = (MODEL.free_a @ state[:, :2] + MODEL.forced_a @ jerk.T)[ENDS]
    return [np.hypot(*rows.T) for rows in (speed, push, jerk.T)]


def test_level_rows_keep_the_norms_and_forbid_nothing_well_inside_them() -> None:
    """The speed's polygon is about its circle, 2 % larger at its corners; the others are inscribed, 2 % smaller."""
    rng = np.random.default_rng(5)
    verdicts = []
    for _ in range(400):
        state = np.vstack([rng.uniform(-5.0, 5.0, 3), rng.uniform(-1.5, 1.5, 3), rng.uniform(-1.0, 1.0, 3)])
        jerk = rng.uniform(-2.6, 2.6, (2, MOVES))
        bounds = written(level_bounds, len(LEVEL), state, NORMS, ANY, MODEL.end_s)
        kept = within(LEVEL @ np.append(jerk, np.zeros(LEVEL_SLACKS)), bounds)
        shares = [norm.max() / limit for norm, limit in zip(norms_of(state, jerk), NORMS, strict=True)]
        verdicts.append(kept)
        if kept:
            assert shares[0] <= 1.0 / INSCRIBED
            assert max(shares[1:]) <= 1.0
        else:
            assert max(shares) > INSCRIBED
    assert 40 < sum(verdicts) < 360


@pytest.mark.parametrize("holds_rad", np.linspace(0.0, 2.0 * np.pi, 7))
def test_acceleration_and_what_holds_against_the_air_are_within_the_thrust_in_each_direction(holds_rad: float) -> None:
    """Up to the polygon's corners, and to the least that is left in any direction."""
    holds, most = 1.4 * np.array([np.cos(holds_rad), np.sin(holds_rad)]), 2.3
    left = pushes_left(2.0, (most, *holds.tolist()))
    for way in np.linspace(0.0, 2.0 * np.pi, 60):
        along = np.array([np.cos(way), np.sin(way)])
        push = push_along(left, *along.tolist())
        thrust = float(np.hypot(*(push * along + holds)))
        assert thrust <= most + 1e-9
        assert push > INSCRIBED * 2.0 - 1e-9 or thrust > INSCRIBED * most - 0.05 * most
        assert push <= 2.0 + 1e-9
    still = push_along(pushes_left(2.0, (1.0, *(5.0 * holds).tolist())), *(holds / 1.4).tolist())
    assert still == pytest.approx(LEFT_MIN_SHARE, rel=0.02)


@pytest.mark.parametrize("turn", range(4))
def test_an_axis_may_use_the_whole_of_each_norm(turn: int) -> None:
    direction = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][turn])
    state, jerk = np.zeros((3, 3)), np.zeros((2, MOVES))
    state[1, :2], state[2, :2], jerk[:, 0] = 0.99 * NORMS[0] * direction, 0.0, 0.999 * NORMS[2] * direction
    bounds = written(level_bounds, len(LEVEL), state, NORMS, ANY, MODEL.end_s)
    jerk[:, 1] = -jerk[:, 0] * MODEL.move_s[0] / MODEL.move_s[1]
    assert within(LEVEL @ np.append(jerk, np.zeros(LEVEL_SLACKS)), bounds)


@pytest.mark.parametrize("seed", range(6))
def test_a_state_that_breaks_its_norms_can_keep_the_widened_bounds(seed: int) -> None:
    """By braking as `braked` does, acceleration first turned against the velocity, then held."""
    rng = np.random.default_rng(seed)
    way = np.exp(1j * rng.uniform(0.0, 2.0 * np.pi))
    state = np.zeros((3, 3))
    state[1, :2] = rng.uniform(1.1, 2.0) * NORMS[0] * np.array([way.real, way.imag])
    bounds = written(level_bounds, len(LEVEL), state, NORMS, ANY, MODEL.end_s)
    left = braked(state, 0.98 * INSCRIBED * NORMS[1], 0.98 * INSCRIBED * NORMS[2], MODEL.end_s)
    gained = left - state[1, :2]
    normals = np.array([(np.cos(k * np.pi / DIRECTIONS), np.sin(k * np.pi / DIRECTIONS)) for k in range(DIRECTIONS)])
    rows = np.vstack((normals, -normals)) @ gained.T
    first = DIRECTIONS * MOVES
    assert (rows.ravel() <= bounds[1][first : first + rows.size] + 1e-9).all()
    assert (np.diff(np.hypot(*left.T)) <= 0.0).all()


@pytest.mark.slow
@pytest.mark.parametrize("lead_s", [0.0, LEAD_S])
def test_vertical_rows_hold_exactly_where_the_plan_keeps_to_its_limits(lead_s: float) -> None:
    rng = np.random.default_rng(5)
    A = vertical_rows(MODEL, lead_s)
    verdicts = []
    for _ in range(200):
        x = np.array([rng.uniform(1.0, 2.0), *rng.uniform(-0.4, 0.4, 2)])  # keeps all limits by itself
        limits, floor = tuple(rng.uniform(0.9, 3.0, 4).tolist()), rng.uniform(-4.0, -3.0, NODES)
        jerk = rng.uniform(-0.8, 0.8, MOVES)
        bounds = written(vertical_bounds, len(A), x, floor, lead_s, limits, MODEL.node_s, MODEL.end_s)
        speed = MODEL.free_v @ x + MODEL.forced_v @ jerk
        push = (MODEL.free_a @ x + MODEL.forced_a @ jerk)[ENDS]
        height = MODEL.free_p @ x + MODEL.forced_p @ jerk + lead_s * speed
        down, climb, pull, most = limits
        inside = (speed >= -down, speed <= climb, np.abs(push) <= pull, np.abs(jerk) <= most, height >= floor)
        verdicts.append(all(bool(rows.all()) for rows in inside))
        assert within(A @ np.append(jerk, np.zeros(VERTICAL_SLACKS)), bounds) == verdicts[-1]
    assert {True, False} == set(verdicts)


def test_kernels_are_their_python() -> None:
    rng = np.random.default_rng(11)
    weights = make_axis_cost(MODEL, CONFIG).weights
    term = (weights, 0.5 * weights, *(rng.standard_normal((3, *rest)) for rest in ((3,), (3, NODES), (MOVES,))))
    np.testing.assert_allclose(slopes_of(*term), slopes_of.py_func(*term), rtol=1e-12, atol=1e-12)
    for size in (0.1, 1.0, 10.0):
        state = size * rng.standard_normal((3, 3))
        floor = (rng.standard_normal(NODES), LEAD_S, (1.5, 3.0, 4.0, 9.0), MODEL.node_s, MODEL.end_s)
        for kernel, count, arguments in (
            (level_bounds, len(LEVEL), (state, NORMS, ANY, MODEL.end_s)),
            (level_bounds, len(LEVEL), (state, NORMS, (2.2, -0.9, 0.6), MODEL.end_s)),
            (vertical_bounds, len(vertical_rows(MODEL, LEAD_S)), (np.ascontiguousarray(state[:, 2]), *floor)),
        ):
            compiled, plain = written(kernel, count, *arguments), written(kernel.py_func, count, *arguments)
            np.testing.assert_allclose(compiled, plain, rtol=1e-12, atol=1e-12)
