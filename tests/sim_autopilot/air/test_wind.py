import numpy as np
import pytest
from scipy import signal

from sim_autopilot.air.wind import Gust, Turbulence, WindModel, dryden
from sim_autopilot.core.data import Array

AIRSPEED_M_S = 10.0
DT_S = 0.02


def blown(turbulence: Turbulence, seconds: float, *, seed: int = 5, direction_rad: float = 0.0) -> Array:
    model = WindModel(seed, 0.0, direction_rad, turbulence)
    return np.array([model.advance(DT_S, AIRSPEED_M_S) for _ in range(round(seconds / DT_S))])


# sigma_u = sigma_v, sigma_w of MIL-F-8785C at 5 m, as the benchmark prints them
@pytest.mark.parametrize(
    ("turbulence", "sigma_u", "sigma_w"),
    [(Turbulence.LIGHT, 1.50, 0.77), (Turbulence.MODERATE, 3.00, 1.54), (Turbulence.SEVERE, 4.49, 2.31)],
)
def test_dryden_has_the_deviations_of_the_standard(turbulence: Turbulence, sigma_u: float, sigma_w: float) -> None:
    parameters = dryden(turbulence, 5.0)
    assert parameters.sigma_u_m_s == pytest.approx(sigma_u, abs=0.006)
    assert parameters.sigma_v_m_s == pytest.approx(sigma_u, abs=0.006)
    assert parameters.sigma_w_m_s == pytest.approx(sigma_w, abs=0.006)


def test_dryden_has_the_lengths_of_the_standard() -> None:
    parameters = dryden(Turbulence.LIGHT, 5.0)
    assert parameters.length_u_m == pytest.approx(36.6, abs=0.1)
    assert parameters.length_w_m == 5.0


@pytest.mark.parametrize("height_m", [0.0, 305.0])
def test_dryden_refuses_heights_outside_the_model(height_m: float) -> None:
    with pytest.raises(ValueError, match=str(height_m)):
        dryden(Turbulence.LIGHT, height_m)


@pytest.mark.slow
def test_turbulence_has_the_spectra_of_the_standard() -> None:
    wind = blown(Turbulence.MODERATE, 8000.0)
    p = dryden(Turbulence.MODERATE)
    frequency_hz, power = signal.welch(wind, fs=1.0 / DT_S, nperseg=8192, axis=0)
    # one-sided per rad/m in the standard, per Hz from welch: V / 2 pi waves per metre
    W = 2.0 * np.pi * frequency_hz / AIRSPEED_M_S
    spectra = np.empty((frequency_hz.size, 3))
    for i, (sigma, length) in enumerate(
        [(p.sigma_u_m_s, p.length_u_m), (p.sigma_v_m_s, p.length_v_m), (p.sigma_w_m_s, p.length_w_m)]
    ):
        x = (length * W) ** 2
        if i == 0:
            spectra[:, i] = sigma**2 * 2.0 * length / np.pi / (1.0 + x)
        else:
            spectra[:, i] = sigma**2 * length / np.pi * (1.0 + 3.0 * x) / (1.0 + x) ** 2
    spectra *= 2.0 * np.pi / AIRSPEED_M_S
    for low_hz, high_hz in [(0.01, 0.03), (0.03, 0.1), (0.1, 0.3), (0.3, 1.0), (1.0, 3.0)]:
        band = (frequency_hz >= low_hz) & (frequency_hz < high_hz)
        ratio = power[band].mean(axis=0) / spectra[band].mean(axis=0)
        np.testing.assert_allclose(ratio, 1.0, atol=0.15)


@pytest.mark.slow
def test_turbulence_has_its_variance_from_the_first_sample_on() -> None:
    p = dryden(Turbulence.LIGHT)
    first = np.array([WindModel(seed, 0.0, 0.0, Turbulence.LIGHT).advance(DT_S, 10.0) for seed in range(4000)])
    np.testing.assert_allclose(first.std(axis=0), [p.sigma_u_m_s, p.sigma_v_m_s, p.sigma_w_m_s], rtol=0.05)


def test_same_seed_gives_the_same_wind() -> None:
    np.testing.assert_array_equal(blown(Turbulence.SEVERE, 3.0), blown(Turbulence.SEVERE, 3.0))
    assert not np.array_equal(blown(Turbulence.SEVERE, 3.0), blown(Turbulence.SEVERE, 3.0, seed=6))


def test_turbulence_turns_with_the_mean_wind() -> None:
    ahead = blown(Turbulence.LIGHT, 2.0)
    left = blown(Turbulence.LIGHT, 2.0, direction_rad=np.pi / 2)
    np.testing.assert_allclose(left, np.column_stack([-ahead[:, 1], ahead[:, 0], ahead[:, 2]]), atol=1e-12)


def test_calm_air_is_the_mean_alone() -> None:
    model = WindModel(1, 5.0, 0.6, Turbulence.NONE)
    np.testing.assert_allclose(model.advance(0.01, 3.0), [5.0 * np.cos(0.6), 5.0 * np.sin(0.6), 0.0])


def test_gust_rises_to_its_peak_and_ends() -> None:
    gust = Gust(peak_m_s=5.0, direction_rad=0.0, start_s=1.0, duration_s=2.0)
    model = WindModel(1, 0.0, 2.0, Turbulence.NONE, gust=gust)
    speeds = np.array([model.advance(0.01, 0.0)[0] for _ in range(400)])
    assert speeds[:100].max() == 0.0
    assert speeds.max() == pytest.approx(5.0, abs=1e-3)
    assert speeds[149] == pytest.approx(2.5, abs=0.01)
    assert speeds[300:].max() == 0.0
