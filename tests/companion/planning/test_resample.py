import numpy as np
import pytest

from companion.planning.guidance import Target
from companion.planning.resample import make_resampler
from tests.companion.planning.cases import circle


def test_a_cubic_is_resampled_exactly() -> None:
    offsets, nodes = np.array((0.0, 0.3, 0.7, 1.1)), np.array((0.0, 0.11, 0.35, 0.9, 1.1))
    t, s = offsets[:, None], nodes[:, None]
    c = np.array([[1.0, -2.0, 0.5]])
    target = Target(
        offset_s=t[:, 0],
        position_enu_m=c * t**3 + t,
        velocity_enu_m_s=3.0 * c * t**2 + 1.0,
        acceleration_enu_m_s2=6.0 * c * t,
    )
    position, velocity, acceleration = make_resampler(offsets, nodes).apply(target)
    np.testing.assert_allclose(position, c * s**3 + s, atol=1e-12)
    np.testing.assert_allclose(velocity, 3.0 * c * s**2 + 1.0, atol=1e-12)
    np.testing.assert_allclose(acceleration, 6.0 * c * s, atol=1e-12)


def test_after_the_last_sample_the_target_goes_on_at_its_last_velocity() -> None:
    motion, offsets = circle(16.5, 7.0), np.array((0.0, 0.5, 1.0))
    position, velocity, acceleration = motion(offsets)
    target = Target(
        offset_s=offsets,
        position_enu_m=position,
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=acceleration,
    )
    later = make_resampler(offsets, np.array((1.0, 2.5))).apply(target)
    np.testing.assert_allclose(later[0][1], position[-1] + 1.5 * velocity[-1], atol=1e-12)
    np.testing.assert_allclose(later[1][1], velocity[-1], atol=1e-12)
    np.testing.assert_array_equal(later[2][1], np.zeros(3))


def test_a_circle_sampled_at_5_hz_is_resampled_to_a_tenth_of_a_millimetre() -> None:
    motion, offsets = circle(16.5, 7.0), np.linspace(0.0, 3.0, 16)
    nodes = np.linspace(0.0, 3.0, 101)
    position, velocity, acceleration = motion(offsets)
    target = Target(
        offset_s=offsets,
        position_enu_m=position,
        velocity_enu_m_s=velocity,
        acceleration_enu_m_s2=acceleration,
    )
    resampled = make_resampler(offsets, nodes).apply(target)
    assert np.abs(resampled[0] - motion(nodes)[0]).max() < 1e-4


@pytest.mark.parametrize("offsets", [(), (0.0, 0.0), (0.0, 0.2, 0.1)])
def test_offsets_that_do_not_rise_are_refused(offsets: tuple[float, ...]) -> None:
    with pytest.raises(ValueError, match="must rise"):
        make_resampler(np.array(offsets), np.array((0.0, 1.0)))
