import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from scenarios.falsify.space import Z_MAX, normal, plausible, radius_max, searched, uniforms


def test_radius_is_that_which_99_of_100_drawn_worlds_keep_within() -> None:
    worlds = np.random.default_rng(4).standard_normal((20_000, 37))
    inside = np.linalg.norm(worlds, axis=1) <= radius_max(37)
    assert inside.mean() == pytest.approx(0.99, abs=0.003)


@given(arrays(float, 11, elements=st.floats(-20.0, 20.0)))
def test_plausible_world_keeps_every_bound(z: np.ndarray[tuple[int], np.dtype[np.float64]]) -> None:
    near = plausible(z)
    assert np.abs(near).max() <= Z_MAX
    assert np.linalg.norm(near) <= radius_max(11) * (1.0 + 1e-12)
    assert (near * z >= 0.0).all()


def test_plausible_world_stays_as_it_is() -> None:
    z = np.array([2.9, -1.0, 0.3])
    assert plausible(z) is not z
    assert plausible(z).tolist() == z.tolist()


def test_uniform_numbers_are_those_of_the_normal_table() -> None:
    # Abramowitz and Stegun, table 26.1
    chosen = uniforms(("a", "b", "c"), np.array([0.0, 1.0, -1.64]))
    assert chosen["a"] == 0.5
    assert chosen["b"] == pytest.approx(0.841344746)
    assert chosen["c"] == pytest.approx(0.050502583)
    assert normal(0.841344746) == pytest.approx(1.0)


def test_search_chooses_what_is_drawn_once_and_the_first_of_what_recurs() -> None:
    names = ("wind.mean_m_s", "road.radius_m.0", "road.radius_m.3", "road.radius_m.4", "driver.event.12")
    assert searched(names) == ("wind.mean_m_s", "road.radius_m.0", "road.radius_m.3")
    assert searched(names, ["wind", "driver"]) == ("wind.mean_m_s",)
